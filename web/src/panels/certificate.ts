/** Every promise of the certificate, with what is left of it. */

import { isObject, type Certificate, type Clearance, type Place, type Plan, type Request } from "../documents";
import { h } from "../dom";
import { angleText, angleUnit, fixed, lengthText, shareText, shown, timeText } from "../units";

interface Row {
  promise: string;
  measured: string;
  /** Part of what is allowed that is used; null: a figure without a limit. */
  used: number | null;
  where?: Place | { time: number } | null;
}

type Seek = (time: number) => void;

export function certificatePanel(plan: Plan, request: Request, seek: Seek): HTMLElement {
  const body = rows(plan, request).map((row) => line(row, seek));
  return h(
    "section", { class: "card certificate", "aria-labelledby": "certificate-title" },
    h("h2", { id: "certificate-title" }, "Certificate",
      h("span", { class: plan.certificate.valid ? "badge good" : "badge bad" },
        plan.certificate.valid ? "every promise kept" : "a promise is broken")),
    h("p", { class: "hint" }, "Measured by Pinocchio on the finished samples."),
    h("table", {},
      h("thead", {}, h("tr", {},
        ...["Promise", "Measured", "Margin"].map((t) => h("th", { scope: "col" }, t)))),
      h("tbody", {}, ...body)),
  );
}

function line(row: Row, seek: Seek): HTMLElement {
  const measured = h("td", {}, row.measured);
  if (row.where) {
    const { time } = row.where;
    const joint = "joint" in row.where ? `${row.where.joint} ` : "";
    measured.append(h("span", { class: "where" }, `${joint}at `, h("button", {
      type: "button", class: "link", title: "Show this moment", onclick: () => seek(time),
    }, `${time.toFixed(2)} s`)));
  }
  const margin = h("td", { class: "margin" });
  if (row.used !== null) {
    const left = 1 - row.used;
    const bar = h("span", { class: left < 0 ? "bar bad" : "bar", "aria-hidden": "true" }, h("span", {}));
    (bar.firstChild as HTMLElement).style.width = `${Math.min(Math.max(row.used, 0), 1) * 100}%`;
    margin.append(bar, `${fixed(Math.floor(left * 1000 + 1e-6) / 10, 1)} %`);
  } else {
    margin.append("–");
  }
  return h("tr", {}, h("th", { scope: "row" }, row.promise), measured, margin);
}

function rows(plan: Plan, request: Request): Row[] {
  const c = plan.certificate;
  const allowed = tolerances(request);
  const found: Row[] = [];
  const error = (
    promise: string, value: number | null, text: (v: number) => string, most: number,
    time: number | null = null,
  ): void => {
    if (value === null) return;
    const where = time === null ? null : { time };
    found.push({ promise, measured: text(value), used: value / most, where });
  };
  if (allowed.rounded && c.max_position_error !== null) {
    // A rounded corner is passed at a distance: what is promised there is the path.
    found.push({
      promise: "Position at waypoints", measured: `${lengthText(c.max_position_error)}, corners are rounded`, used: null,
    });
  } else {
    error("Position at waypoints", c.max_position_error, lengthText, allowed.position);
    error("Orientation at waypoints", c.max_orientation_error, angleText, allowed.orientation);
  }
  error("Position on the path", c.max_path_deviation, lengthText, allowed.position,
    c.max_path_deviation_time);
  error("Orientation on the path", c.max_orientation_deviation, angleText, allowed.orientation,
    c.max_orientation_deviation_time);
  const share = (promise: string, ratio: number | null, where: Row["where"]): void => {
    if (ratio !== null) {
      found.push({ promise, measured: shareText(ratio), used: ratio, where: where ?? null });
    }
  };
  share("Joint positions", c.position_limit_ratio, c.position_limit_at);
  share("Joint velocities", c.velocity_limit_ratio, c.velocity_limit_at);
  share("Joint accelerations", c.acceleration_limit_ratio, c.acceleration_limit_at);
  share("Joint jerks", c.jerk_limit_ratio, c.jerk_limit_at);
  share("Joint torques", c.torque_limit_ratio, c.torque_limit_at);
  share("Tool speed", c.tool_speed_ratio, { time: c.tool_speed_time ?? 0 });
  share("Tool acceleration", c.tool_acceleration_ratio, { time: c.tool_acceleration_time ?? 0 });
  for (const segment of c.segments) {
    const ratios = [
      segment.velocity_limit_ratio, segment.acceleration_limit_ratio, segment.torque_limit_ratio,
      segment.tool_speed_ratio, segment.tool_acceleration_ratio,
    ].filter((ratio) => ratio !== null);
    const name = segment.field.slice(segment.field.lastIndexOf(".") + 1);
    if (ratios.length > 0) share(`Own limits of ${name}`, Math.max(...ratios), { time: segment.begin });
  }
  found.push(...clearanceRows(c.clearance));
  found.push(
    {
      promise: "Least singular value",
      measured: c.min_singular_value.toPrecision(3),
      used: null,
      where: { time: c.min_singular_value_time },
    },
    { promise: "Joint motion", measured: motion(plan, c), used: null },
    { promise: "Duration", measured: timeText(plan.trajectory.time.at(-1) ?? 0), used: null },
  );
  return found;
}

/** How near bodies come, as proven between the samples too; nothing where nothing was checked. */
function clearanceRows(clearance: Clearance | null): Row[] {
  if (clearance === null) return [];
  const found: Row[] = [];
  for (const [promise, place] of [
    ["Arm from itself", clearance.self], ["Arm from obstacles", clearance.scene],
  ] as const) {
    if (place.least === null || place.time === null) continue;
    const said = place.proven ? "at least" : "not proven: at least";
    const pair = place.pair === null ? "" : `, ${place.pair.join(" and ")}`;
    found.push({
      promise,
      measured: `${said} ${lengthText(place.least)}${pair}`,
      used: clearance.clearance > 0 ? clearance.clearance / Math.max(place.least, clearance.clearance) : null,
      where: { time: place.time },
    });
  }
  if (found.length === 0) found.push({ promise: "Clearance", measured: "nothing checked: no shapes known", used: null });
  if (clearance.unchecked.length > 0) {
    found.push({ promise: "Not checked for contact", measured: clearance.unchecked.join(", "), used: null });
  }
  return found;
}

function motion(plan: Plan, c: Certificate): string {
  const turning = plan.joint_units.every((unit) => unit === "rad");
  const text = (v: number): string =>
    turning ? `${fixed(shown(v, "rad"), angleUnit() === "deg" ? 1 : 3)} ${angleUnit()}` : fixed(v, 3);
  return `${text(c.elongation_sum)}, at least ${text(c.elongation_lower_bound)} needed`;
}

/** What a request allows; the certificate's errors are what is beyond boxes and freedoms. */
function tolerances(request: Request): { position: number; orientation: number; rounded: boolean } {
  const path = isObject(request["path"]) ? request["path"] : {};
  const given = isObject(path["tolerance"]) ? path["tolerance"] : {};
  const number = (key: string, otherwise: number): number =>
    typeof given[key] === "number" ? given[key] : otherwise;
  const segments = Array.isArray(path["segments"]) ? path["segments"] : [];
  return {
    position: number("position", 1e-4),
    orientation: number("orientation", 1e-3),
    rounded: [path, ...segments].some((part) => isObject(part) && Number(part["blend"]) > 0),
  };
}
