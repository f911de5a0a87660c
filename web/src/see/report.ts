/** A report of a plan as one file of HTML: certificate, picture, figure and the request itself. */

import { h } from "../dom";
import { written } from "../merge";
import { certificatePanel } from "../panels/certificate";
import type { Planned } from "../results";
import { timeText } from "../units";
import { figureOf } from "./figure";
import type { Quantity } from "./signals";

const STYLE = `body{font:14px/1.45 system-ui,sans-serif;max-width:760px;margin:24px auto;padding:0 12px;color:#1b2126}
table{border-collapse:collapse;width:100%}th,td{text-align:left;border-top:1px solid #d8dde2;padding:4px 8px 4px 0;font-weight:400}
h1{font-size:20px}h2{font-size:15px;margin-top:24px}pre{background:#f4f5f7;padding:10px;overflow:auto;font-size:11px}
img,svg{max-width:100%;height:auto}.where{color:#56626d;margin-left:6px}.bar{display:none}`;

/** `picture` is the view of the arm as a data address; null: there is none. */
export function reportOf(planned: Planned, quantities: Quantity[], picture: string | null): string {
  const { plan, request, robot } = planned;
  const certificate = certificatePanel(plan, request, () => undefined);
  // On paper nothing can be pressed.
  for (const button of certificate.querySelectorAll("button")) button.replaceWith(button.textContent ?? "");
  const body = h("body", {},
    h("h1", {}, `Plan for ${robot.title}`),
    h("p", {}, `Plan ${plan.id}, ikplan ${plan.version}, ${timeText(plan.trajectory.time.at(-1) ?? 0)}, `
      + `${plan.trajectory.time.length} samples.`),
    plan.timing === null ? "" : h("p", {}, plan.timing.summary),
    certificate);
  if (picture !== null) body.append(h("h2", {}, "The arm"), h("img", { src: picture, alt: "The arm and the path of its tool" }));
  const figure = h("div", {});
  figure.innerHTML = figureOf(planned, quantities);
  body.append(h("h2", {}, "Over time"), figure, h("h2", {}, "Request"), h("pre", {}, written(request)));
  const page = h("html", { lang: "en" },
    h("head", {}, h("meta", { charset: "utf-8" }), h("title", {}, `Plan ${plan.id}`), h("style", {}, STYLE)), body);
  return `<!doctype html>\n${page.outerHTML}\n`;
}
