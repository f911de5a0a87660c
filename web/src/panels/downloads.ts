/** The plan as files. */

import type { Plan } from "../documents";
import { h, saveFile } from "../dom";

export function downloadPanel(plan: Plan, text: string): HTMLElement {
  const name = `plan-${plan.robot}-${plan.id.slice(0, 8)}`;
  const button = (label: string, suffix: string, type: string, content: () => string): HTMLElement =>
    h("button", { type: "button", onclick: () => saveFile(`${name}.${suffix}`, content(), type) }, label);
  return h(
    "section", { class: "card downloads", "aria-labelledby": "downloads-title" },
    h("h2", { id: "downloads-title" }, "Download"),
    h("div", { class: "actions" },
      button("JSON", "json", "application/json", () => text),
      button("CSV", "csv", "text/csv", () => csv(plan))),
    h("p", { class: "hint" }, "Plan ", h("code", {}, plan.id.slice(0, 16)),
      ` of ikplan ${plan.version}; the same request gives the same plan.`),
  );
}

/** The samples with the column titles of the library's own CSV. */
export function csv(plan: Plan): string {
  const { time, q, dq, ddq } = plan.trajectory;
  const titles = ["time [s]"];
  for (const [symbol, per] of [["q", ""], ["dq", "/s"], ["ddq", "/s^2"]]) {
    plan.joint_names.forEach((name, j) =>
      titles.push(`${symbol} ${name} [${plan.joint_units[j]}${per}]`));
  }
  const rows = time.map((t, k) => [t, ...q[k]!, ...dq[k]!, ...ddq[k]!].join(","));
  return `${[titles.map(quoted).join(","), ...rows].join("\n")}\n`;
}

const quoted = (text: string): string =>
  /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
