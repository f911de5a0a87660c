/** A plan in the scene and in the plots: the moment shown, colours of the path, ghosts. */

import type { Vector3 } from "three";

import type { Clock } from "../clock";
import type { LiveArm } from "../arm/live";
import { byId } from "../dom";
import type { Plots } from "../panels/plots";
import type { Results, Planned } from "../results";
import type { ArmView } from "../view";
import { Refusal, fetchSeries } from "../service";
import { coloursOf } from "./colours";
import { seriesQuantities } from "./series";
import { bindingOf, quantitiesOf, type Quantity } from "./signals";

type Ghost = "start" | "goal" | "instant";

export class MotionView {
  quantities: Quantity[] = [];
  private seen: Planned | null = null;
  private way: Vector3[] = [];
  private readonly colour = byId<HTMLSelectElement>("path-colour");
  private readonly ghosts = new Set<Ghost>();

  /** `redraw` draws the path anew. */
  constructor(
    private readonly view: ArmView, private readonly live: LiveArm, private readonly plots: Plots,
    private readonly clock: Clock, private readonly results: Results, redraw: () => void,
  ) {
    this.colour.addEventListener("change", redraw);
    for (const button of document.querySelectorAll<HTMLButtonElement>("[data-ghost]")) {
      button.addEventListener("click", () => this.toggle(button.dataset["ghost"] as Ghost, button));
    }
  }

  /** Computes and plots what a plan does. */
  plot(planned: Planned): void {
    this.measure(planned);
    this.plots.show(planned, this.quantities, bindingOf(this.quantities, planned.motion.samples.time.length));
  }

  /** Nothing is planned any more. */
  clear(): void {
    this.plots.clear();
    this.seen = null;
    this.haunt();
  }

  /** Computes what a plan does, once: the arm has the tool of its request then. */
  private measure(planned: Planned): void {
    if (this.seen === planned) return;
    delete byId("plots").dataset["series"];
    this.quantities = quantitiesOf(planned, {
      positions: (rows) => this.view.toolPositions(rows),
      turns: (rows) => this.view.toolTurns(rows),
    });
    this.way = this.view.toolPositions(planned.motion.samples.q);
    this.seen = planned;
    void this.ask(planned);
  }

  /** Adds what only the service can tell; without it the rest is shown all the same. */
  private async ask(planned: Planned): Promise<void> {
    try {
      const told = seriesQuantities(planned, await fetchSeries(planned.request));
      if (this.seen !== planned) return;
      this.quantities = [...this.quantities, ...told];
      this.plot(planned);
      this.moment();
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
    }
    byId("plots").dataset["series"] = "ready";
  }

  /** Draws the way of the tool, in the colours chosen. */
  trace(planned: Planned): void {
    this.measure(planned);
    const { time } = planned.motion.samples;
    const chosen = this.quantities.find(({ key }) => key === this.colour.value);
    this.view.markTrace(this.way, chosen === undefined ? null : coloursOf(chosen, time.length));
    this.view.setPassed(planned.motion.index(this.clock.time));
    const { kept } = this.results;
    if (kept !== null && kept.robot === planned.robot) this.view.markOther(this.view.toolPositions(kept.motion.samples.q));
  }

  /** Shows the arm, the ghosts and the plots at the time of now. */
  moment(): void {
    const { planned, kept } = this.results;
    if (planned === null) return;
    const moment = planned.motion.at(this.clock.time);
    this.view.setJoints(moment.q);
    this.live.take(planned.robot, moment.q);
    this.view.setPassed(planned.motion.index(this.clock.time));
    this.view.setTime(this.clock.time);
    this.plots.update(this.clock.time, moment);
    if (kept !== null && kept.robot === planned.robot) this.view.ghost("other", kept.motion.at(this.clock.time).q);
  }

  /** Takes the ghosts away that a plan has, and shows those of another. */
  haunt(): void {
    const { planned, kept } = this.results;
    const { q } = planned?.motion.samples ?? { q: [] };
    this.view.ghost("start", this.ghosts.has("start") ? q[0] ?? null : null);
    this.view.ghost("goal", this.ghosts.has("goal") ? q.at(-1) ?? null : null);
    if (planned === null) this.view.ghost("instant", null);
    if (planned === null || kept === null || kept.robot !== planned.robot) this.view.ghost("other", null);
    for (const button of document.querySelectorAll<HTMLButtonElement>("[data-ghost]")) button.disabled = planned === null;
    this.colour.disabled = planned === null;
  }

  private toggle(ghost: Ghost, button: HTMLButtonElement): void {
    if (this.ghosts.has(ghost)) this.ghosts.delete(ghost);
    else this.ghosts.add(ghost);
    button.setAttribute("aria-pressed", String(this.ghosts.has(ghost)));
    if (ghost === "instant") {
      const { planned } = this.results;
      this.view.ghost(ghost, this.ghosts.has(ghost) && planned !== null ? planned.motion.at(this.clock.time).q : null);
    } else {
      this.haunt();
    }
  }
}
