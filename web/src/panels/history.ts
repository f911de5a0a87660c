/** The plans that this service keeps, the newest first, with search; each can be shown and compared. */

import { byId, h } from "../dom";
import { Refusal, fetchPlans, type PlanSummary } from "../service";
import { redraw } from "./fields";

export class History {
  private readonly panel = byId<HTMLDetailsElement>("history");
  private readonly host = byId("history-list");
  private readonly search = byId<HTMLInputElement>("history-search");
  private readonly outcome = byId<HTMLSelectElement>("history-outcome");
  private plans: PlanSummary[] = [];
  private next: string | null = null;
  private fault = "";
  private readings = 0;

  /** `open` shows a plan by its id. */
  constructor(private readonly open: (id: string) => void) {
    this.panel.addEventListener("toggle", () => { if (this.panel.open) void this.read(null); });
    this.search.addEventListener("input", () => this.draw());
    this.outcome.addEventListener("change", () => void this.read(null));
  }

  /** Reads the list again, if it is seen: something has been planned. */
  renew(): void {
    if (this.panel.open) void this.read(null);
  }

  private async read(after: string | null): Promise<void> {
    const reading = ++this.readings;
    try {
      const { plans, next } = await fetchPlans(this.outcome.value, after);
      if (reading !== this.readings) return; // a later one is under way
      this.plans = after === null ? plans : [...this.plans, ...plans];
      this.next = next;
      this.fault = "";
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.fault = error.problem.detail;
    }
    this.draw();
  }

  private draw(): void {
    const words = this.search.value.toLowerCase().split(/\s+/).filter((word) => word !== "");
    const found = this.plans.filter((plan) => {
      const said = `${plan.robot ?? ""} ${plan.id} ${plan.outcome} ${plan.kind} ${plan.time} ${plan.problem ?? ""}`.toLowerCase();
      return words.every((word) => said.includes(word));
    });
    redraw(this.host,
      this.fault === "" ? "" : h("p", { class: "fault" }, this.fault),
      h("p", { class: "hint", role: "status" }, `${found.length} of ${this.plans.length} plans`),
      h("ul", { class: "rows", "aria-label": "Plans of this service" }, ...found.map((plan) => this.row(plan))),
      this.next === null ? "" : h("button", {
        type: "button", "data-key": "more", onclick: () => void this.read(this.next),
      }, "Older plans"));
  }

  private row({ id, outcome, kind, robot, time, problem }: PlanSummary): HTMLElement {
    const when = new Date(time).toLocaleString();
    const told = outcome === "failed" ? (problem ?? "failed").replace(/^urn:ikplan:/, "") : outcome;
    return h("li", {},
      h("button", {
        type: "button", class: "name", "data-key": id, disabled: outcome !== "finished", onclick: () => this.open(id),
      }, h("span", { class: "where" }, `${robot ?? "unknown"} ${id.slice(0, 8)}`)),
      h("span", { class: "kind" }, `${kind === "time" ? "timing, " : ""}${told}, ${when}`));
  }
}
