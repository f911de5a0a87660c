/** Why there is no plan, and what would help. */

import { failedWaypoints, type Problem, type Repair } from "../documents";
import { h } from "../dom";

export function verdictPanel(
  problem: Problem, retryAfter: string | null, apply: (repair: Repair) => void,
): HTMLElement {
  const card = h(
    "section", { class: "card verdict", "aria-labelledby": "verdict-title" },
    h("h2", { id: "verdict-title" }, problem.title, h("span", { class: "badge bad" }, "no plan")),
    h("p", { class: "detail" }, sentence(problem.detail)),
  );
  if (retryAfter !== null) card.append(h("p", {}, `Ask again in ${retryAfter} s.`));
  const others = problem.errors?.slice(1) ?? [];
  if (others.length > 0) {
    card.append(h("ul", {}, ...others.map(({ field, detail }) =>
      h("li", {}, h("code", {}, field), ` ${detail}`))));
  }
  if (failedWaypoints(problem).length > 0) {
    card.append(h("p", { class: "hint" }, `Shown: ${shown(problem)} Waypoints count from 0.`));
  }
  if (problem.repairs !== undefined && problem.repairs.length > 0) {
    card.append(h("h3", {}, "What would make it feasible"), h("ul", { class: "repairs" },
      ...problem.repairs.map((repair) => h("li", {},
        h("span", {}, sentence(repair.detail)),
        h("button", { type: "button", onclick: () => apply(repair) }, "Apply and plan")))));
  } else if (problem.repairs !== undefined) {
    card.append(h("p", { class: "hint" }, "No repair was found."));
  }
  return card;
}

/** What is drawn of a failure. */
function shown(problem: Problem): string {
  if (!problem.q?.length) return "in red the poses asked for that failed.";
  return problem.waypoint === undefined
    ? "the arm where it gets no further, in red its tool and the poses that no motion joins."
    : "the closest configuration found, and in red the poses asked for that failed.";
}

/** Asks for the key that the service wants. */
export function keyPanel(problem: Problem, use: (key: string) => void): HTMLElement {
  const input = h("input", { type: "password", id: "key", autocomplete: "off", required: true });
  return h(
    "section", { class: "card verdict", "aria-labelledby": "key-title" },
    h("h2", { id: "key-title" }, "A key is needed"),
    h("p", { class: "detail" }, sentence(problem.detail)),
    h("form", { onsubmit: (event) => { event.preventDefault(); use(input.value); } },
      h("label", { for: "key" }, "API key"), input, h("button", { class: "primary" }, "Use")),
  );
}

function sentence(text: string): string {
  const first = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
