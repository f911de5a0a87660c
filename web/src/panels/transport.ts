/** The time slider, and what runs it. */

import type { Clock } from "../clock";
import { byId } from "../dom";
import type { Motion } from "../playback";
import { timeText } from "../units";

export class Transport {
  private readonly play = byId<HTMLButtonElement>("play");
  private readonly slider = byId<HTMLInputElement>("time");
  private readonly readout = byId<HTMLOutputElement>("clock");
  private motion: Motion | null = null;

  constructor(private readonly clock: Clock) {
    this.play.addEventListener("click", () => clock.toggle());
    // One step of the slider is one sample, so that the arrow keys go from sample to sample.
    this.slider.addEventListener("input", () => {
      clock.seek(this.motion?.samples.time[Number(this.slider.value)] ?? 0);
    });
    byId<HTMLSelectElement>("speed").addEventListener("change", (event) => {
      clock.speed = Number((event.target as HTMLSelectElement).value);
    });
    byId<HTMLInputElement>("loop").addEventListener("change", (event) => {
      clock.repeat = (event.target as HTMLInputElement).checked;
    });
    document.addEventListener("keydown", (event) => {
      const target = event.target as HTMLElement;
      if (event.key !== " " || target.closest("button, input:not([type=range]), textarea, select, a, summary")) return;
      event.preventDefault();
      if (this.motion !== null) clock.toggle();
    });
  }

  /** Takes a motion; null: there is none. */
  show(motion: Motion | null): void {
    this.motion = motion;
    this.play.disabled = this.slider.disabled = motion === null;
    this.slider.max = String((motion?.samples.time.length ?? 1) - 1);
    this.update();
  }

  update(): void {
    this.play.textContent = this.clock.running ? "Pause" : "Play";
    const text = timeText(this.clock.time);
    this.readout.textContent = `${text} of ${timeText(this.clock.duration)}`;
    this.readout.dataset["value"] = String(this.clock.time);
    this.slider.value = String(this.motion?.index(this.clock.time) ?? 0);
    this.slider.setAttribute("aria-valuetext", text);
  }
}
