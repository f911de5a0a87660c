/** The plan to take home: every format that the service has for the robot, a figure, a report. */

import { h, saveBlob, saveFile } from "../dom";
import type { Planned } from "../results";
import { figureOf } from "../see/figure";
import { reportOf } from "../see/report";
import type { Quantity } from "../see/signals";
import { Refusal, fetchFormats, fetchPlanAs } from "../service";

export interface Taken {
  quantities: () => Quantity[];
  /** The view of the arm; null: there is none. */
  picture: () => string | null;
  keep: () => void;
}

export function downloadPanel(planned: Planned, taken: Taken): HTMLElement {
  const { plan, text } = planned;
  const name = `plan-${plan.robot}-${plan.id.slice(0, 8)}`;
  const fault = h("p", { class: "fault", role: "status" });
  const formats = h("div", { class: "actions", "aria-busy": true },
    h("button", { type: "button", onclick: () => saveFile(`${name}.json`, text, "application/json") }, "JSON"));
  void offer();
  return h(
    "section", { class: "card downloads", "aria-labelledby": "downloads-title" },
    h("h2", { id: "downloads-title" }, "Take home"),
    formats,
    h("div", { class: "actions" },
      h("button", { type: "button", onclick: () =>
        saveFile(`${name}.svg`, figureOf(planned, taken.quantities()), "image/svg+xml") }, "Figure"),
      h("button", { type: "button", onclick: () =>
        saveFile(`${name}.html`, reportOf(planned, taken.quantities(), taken.picture()), "text/html") }, "Report"),
      h("button", { type: "button", onclick: taken.keep }, "Keep to compare")),
    fault,
    h("p", { class: "hint" }, "Plan ", h("code", {}, plan.id.slice(0, 16)),
      ` of ikplan ${plan.version}; the same request gives the same plan.`),
  );

  async function offer(): Promise<void> {
    try {
      for (const { name: short, title, suffix, media_type: type } of await fetchFormats(plan.robot)) {
        if (short === "json") continue;
        formats.append(h("button", {
          type: "button", title, onclick: () => void take(type, suffix),
        }, short.length <= 4 ? short.toUpperCase() : short));
      }
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      fault.textContent = error.problem.detail;
    }
    formats.setAttribute("aria-busy", "false");
  }

  async function take(type: string, suffix: string): Promise<void> {
    try {
      fault.textContent = "";
      saveBlob(`${name}${suffix}`, await fetchPlanAs(plan.id, type));
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      fault.textContent = error.problem.detail;
    }
  }
}
