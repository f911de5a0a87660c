/** Two plans side by side: what each takes, moves and promises. */

import type { Plan } from "../documents";
import { h } from "../dom";
import type { Planned } from "../results";
import { angleText, fixed, lengthText, shareText, shown, timeText } from "../units";

interface Row {
  name: string;
  of: (plan: Plan) => string;
  /** A figure of which less is better; null: not known. */
  size?: (plan: Plan) => number | null;
}

const duration = (plan: Plan): number => plan.trajectory.time.at(-1) ?? 0;
const length = (value: number | null): string => (value === null ? "–" : lengthText(value));
const share = (value: number | null): string => (value === null ? "–" : shareText(value));

const ROWS: Row[] = [
  { name: "Duration", of: (plan) => timeText(duration(plan)), size: duration },
  {
    name: "Joint motion", size: (plan) => plan.certificate.elongation_sum,
    of: (plan) => (plan.joint_units.every((unit) => unit === "rad")
      ? `${fixed(shown(plan.certificate.elongation_sum, "rad"), 1)}` : fixed(plan.certificate.elongation_sum, 3)),
  },
  { name: "Every promise kept", of: (plan) => (plan.certificate.valid ? "yes" : "no") },
  { name: "Position on the path", of: ({ certificate: c }) => length(c.max_path_deviation ?? c.max_position_error) },
  {
    name: "Orientation on the path",
    of: ({ certificate: c }) => {
      const value = c.max_orientation_deviation ?? c.max_orientation_error;
      return value === null ? "–" : angleText(value);
    },
  },
  { name: "Joint velocities", of: ({ certificate: c }) => share(c.velocity_limit_ratio) },
  { name: "Joint accelerations", of: ({ certificate: c }) => share(c.acceleration_limit_ratio) },
  { name: "Joint jerks", of: ({ certificate: c }) => share(c.jerk_limit_ratio) },
  { name: "Joint torques", of: ({ certificate: c }) => share(c.torque_limit_ratio) },
  { name: "Tool speed", of: ({ certificate: c }) => share(c.tool_speed_ratio) },
  { name: "Arm from itself", of: ({ certificate: c }) => length(c.clearance?.self.least ?? null) },
  { name: "Arm from obstacles", of: ({ certificate: c }) => length(c.clearance?.scene.least ?? null) },
  { name: "Least singular value", of: ({ certificate: c }) => c.min_singular_value.toPrecision(3) },
];

export function comparePanel(now: Planned, kept: Planned, drop: () => void): HTMLElement {
  const row = ({ name, of, size }: Row): HTMLElement => {
    const [a, b] = [size?.(now.plan) ?? null, size?.(kept.plan) ?? null];
    const change = a === null || b === null || b === 0 ? "" : ` (${a > b ? "+" : ""}${fixed(((a - b) / b) * 100, 1)} %)`;
    return h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, of(now.plan) + change), h("td", {}, of(kept.plan)));
  };
  const title = ({ plan }: Planned): string => `${plan.robot} ${plan.id.slice(0, 8)}`;
  return h("section", { class: "card compare", "aria-labelledby": "compare-title" },
    h("h2", { id: "compare-title" }, "Compared"),
    h("table", {}, h("thead", {}, h("tr", {}, h("td", {}), h("th", { scope: "col" }, `This: ${title(now)}`),
      h("th", { scope: "col", class: "other" }, `Kept: ${title(kept)}`))),
    h("tbody", {}, ...ROWS.map(row))),
    kept.robot === now.robot ? h("p", { class: "hint" }, "The kept plan is drawn in orange, at the same time.") : "",
    h("div", { class: "actions" }, h("button", { type: "button", onclick: drop }, "End the comparison")));
}
