/** A file of points in CSV: read by the service, again where the user says what the file does not. */

import type { Request } from "../documents";
import { byId, h } from "../dom";
import { Refusal, readPoints } from "../service";

const CHOICES = ["units", "angles", "interpolation", "columns"] as const;
type Choice = (typeof CHOICES)[number];

export class PointsPanel {
  private readonly panel = byId("points");
  private readonly notes = byId("points-notes");
  private file: File | null = null;
  private readings = 0;
  private failed = false;

  /** `use` hears of every request that a file is read as; `robot` is the one chosen. */
  constructor(private readonly use: (request: Request) => void, private readonly robot: () => string) {
    for (const choice of CHOICES) this.input(choice).addEventListener("change", () => void this.read());
  }

  async open(file: File): Promise<void> {
    this.file = file;
    byId("points-name").textContent = file.name;
    for (const choice of CHOICES) this.input(choice).value = "";
    this.panel.hidden = false;
    await this.read();
  }

  /** Reads again what could not be read, for another robot: joints have other names there. */
  retry(): void {
    if (this.failed) void this.read();
  }

  close(): void {
    this.failed = false;
    this.file = null;
    this.panel.hidden = true;
  }

  private input(choice: Choice): HTMLInputElement | HTMLSelectElement {
    return byId<HTMLInputElement | HTMLSelectElement>(`points-${choice}`);
  }

  private async read(): Promise<void> {
    if (this.file === null) return;
    const reading = ++this.readings;
    const query = Object.fromEntries(CHOICES.map((choice) => [choice, this.input(choice).value.trim()]));
    try {
      const { request, notes } = await readPoints(this.file, { robot: this.robot(), ...query });
      if (reading !== this.readings) return; // a later one is under way
      this.failed = false;
      this.say(notes.map(({ text }) => text));
      this.use(request);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (reading !== this.readings) return;
      this.failed = true;
      this.say([error.problem.detail], error.problem.field);
    }
  }

  private say(texts: string[], field?: string): void {
    this.notes.replaceChildren(...texts.map((text) => h("li", { class: field === undefined ? "" : "fault" }, text)));
    for (const choice of CHOICES) this.input(choice).setAttribute("aria-invalid", String(choice === field));
  }
}
