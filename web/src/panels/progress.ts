/** How far a plan is, while it is made. */

import type { PlanStatus } from "../documents";
import { byId } from "../dom";

const STAGES: Record<string, string> = {
  ik: "Joint solutions", planning: "Joint path", timing: "Timing", certificate: "Checking",
};

export class ProgressPanel {
  private readonly panel = byId("progress");
  private readonly bar = byId<HTMLProgressElement>("progress-bar");
  private readonly text = byId("progress-text");
  private readonly clock = byId("progress-time");
  private begun = 0;
  private ticking = 0;

  /** `announce` hears of every new stage. */
  constructor(private readonly announce: (stage: string) => void) {}

  begin(): void {
    this.begun = performance.now();
    this.panel.hidden = false;
    this.say("Asking the service");
    this.tick();
    this.ticking = window.setInterval(() => this.tick(), 500);
  }

  end(): void {
    clearInterval(this.ticking);
    this.panel.hidden = true;
  }

  show(status: PlanStatus): void {
    const stage = status.state === "queued" ? "Waiting for a worker" : STAGES[status.stage ?? ""] ?? "Planning";
    if (status.total > 0) {
      this.bar.max = status.total;
      this.bar.value = status.done;
      this.say(stage, `: ${status.done} of ${status.total} waypoints`);
    } else {
      this.bar.removeAttribute("value");
      this.say(stage);
    }
  }

  private say(stage: string, count = ""): void {
    if (this.panel.dataset["stage"] !== stage) {
      this.panel.dataset["stage"] = stage;
      this.announce(stage);
    }
    this.text.textContent = stage + count;
  }

  private tick(): void {
    this.clock.textContent = `${Math.floor((performance.now() - this.begun) / 1000)} s`;
  }
}
