/** Why the motion takes as long as it does. */

import type { Timing } from "../documents";
import { h } from "../dom";
import { timeText } from "../units";

const words = (limit: string): string => limit.replaceAll("_", " ");

export function bindingPanel(timing: Timing): HTMLElement {
  const bars = timing.binding.slice(0, 6).map(({ limit, joint, share }) => {
    const name = joint === null ? words(limit) : `${joint} ${words(limit)}`;
    const bar = h("span", { class: "bar", "aria-hidden": "true" }, h("span", {}));
    (bar.firstChild as HTMLElement).style.width = `${share * 100}%`;
    return h("li", {}, h("span", { class: "share" }, `${Math.round(share * 100)} %`), bar, name);
  });
  const card = h(
    "section", { class: "card binding", "aria-labelledby": "binding-title" },
    h("h2", { id: "binding-title" }, `What ${timeText(timing.duration)} are spent on`),
    h("ul", {}, ...bars),
  );
  const best = timing.what_if[0];
  if (best !== undefined) {
    const name = best.joint === null ? words(best.limit) : `${best.joint} ${words(best.limit)}`;
    const wider = Math.round((best.factor - 1) * 100);
    card.append(h("p", { class: "hint" },
      `With a ${wider} % wider limit of ${name}: ${timeText(best.duration)}.`));
  }
  return card;
}
