/** The request: chosen, written, opened from a file. */

import type { Request, RobotInfo } from "../documents";
import { isObject } from "../documents";
import { byId, h, saveFile } from "../dom";
import { EXAMPLES } from "../examples";
import { merged, written } from "../merge";
import { PointsPanel } from "./points";

export class Editor {
  private readonly text = byId<HTMLTextAreaElement>("editor");
  private readonly fault = byId("fault");
  private readonly robot = byId<HTMLSelectElement>("robot");
  private readonly example = byId<HTMLSelectElement>("example");
  private readonly file = byId<HTMLInputElement>("file");
  private readonly points = new PointsPanel((request) => this.set(request), () => this.robot.value);

  /** `changed` hears of every document that can be read. */
  constructor(private readonly changed: (request: Request) => void, submit: () => void) {
    this.text.addEventListener("input", () => {
      this.example.value = "";
      this.read();
    });
    this.text.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) submit();
    });
    this.example.append(h("option", { value: "" }, "your own"),
      ...EXAMPLES.map(({ name, title }) => h("option", { value: name }, title)));
    this.example.addEventListener("change", () => this.useExample(this.example.value));
    this.robot.addEventListener("change", () => {
      const { start, ...rest } = this.request() ?? {};
      // The joint values of one robot say nothing to another.
      const kept = start === undefined || Array.isArray(start) ? rest : { start, ...rest };
      this.set({ ...kept, robot: this.robot.value });
      this.points.retry();
    });
    byId("open").addEventListener("click", () => this.file.click());
    this.file.addEventListener("change", () => void this.openFile());
    byId("store").addEventListener("click", () =>
      saveFile("request.json", this.text.value, "application/json"));
  }

  showRobots(robots: RobotInfo[]): void {
    this.robot.replaceChildren(...robots.map(({ name, title }) =>
      h("option", { value: name }, `${name} – ${title}`)));
  }

  useExample(name: string): boolean {
    const found = EXAMPLES.find((example) => example.name === name);
    if (found === undefined) return false;
    this.points.close();
    this.set(found.request);
    this.example.value = name;
    return true;
  }

  set(request: Request): void {
    const { robot, ...rest } = request;
    this.text.value = written({ robot, ...rest });
    this.text.scrollTop = 0;
    this.example.value = "";
    this.read();
  }

  apply(change: Record<string, unknown>): void {
    this.set(merged(this.request() ?? {}, change));
  }

  get document(): string {
    return this.text.value;
  }

  /** The document, or null where it is not an object in JSON. */
  request(): Request | null {
    try {
      const value: unknown = JSON.parse(this.text.value);
      this.say(isObject(value) ? "" : "The document must be a JSON object.");
      return isObject(value) ? value : null;
    } catch (error) {
      this.say(`Not JSON: ${(error as Error).message}`);
      return null;
    }
  }

  private read(): void {
    const request = this.request();
    if (request === null) return;
    const name = String(request["robot"]);
    if ([...this.robot.options].some((option) => option.value === name)) this.robot.value = name;
    this.changed(request);
  }

  private say(fault: string): void {
    this.fault.textContent = fault;
    this.text.setAttribute("aria-invalid", String(fault !== ""));
  }

  private async openFile(): Promise<void> {
    const file = this.file.files?.[0];
    if (file === undefined) return;
    this.file.value = "";
    const text = await file.text();
    if (!text.trimStart().startsWith("{") && !file.name.toLowerCase().endsWith(".json")) {
      await this.points.open(file);
      return;
    }
    this.points.close();
    this.text.value = text;
    this.example.value = "";
    this.read();
  }
}
