/** The request as a whole: robot, example, file, undo, link. */

import type { Request, RobotInfo } from "../documents";
import { byId, h, saveFile } from "../dom";
import { EXAMPLES } from "../examples";
import { merged } from "../merge";
import { linkTo } from "../state/link";
import type { DocumentStore } from "../state/store";
import { PointsPanel } from "./points";

export class Editor {
  private readonly robot = byId<HTMLSelectElement>("robot");
  private readonly example = byId<HTMLSelectElement>("example");
  private readonly undo = byId<HTMLButtonElement>("undo");
  private readonly redo = byId<HTMLButtonElement>("redo");
  private readonly fault = byId("fault");
  readonly points = new PointsPanel((request) => this.store.set(request), () => this.robot.value);

  /** `open` takes files; `say` tells the user that something has been done. */
  constructor(
    private readonly store: DocumentStore, open: (files: File[]) => void, private readonly say: (text: string) => void,
  ) {
    this.example.append(h("option", { value: "" }, "your own"),
      ...EXAMPLES.map(({ name, title }) => h("option", { value: name }, title)));
    this.example.addEventListener("change", () => this.useExample(this.example.value));
    this.robot.addEventListener("change", () => {
      if (Array.isArray(store.request?.["start"])) say("The joint values of the start are left out: they are another robot's.");
      store.edit((request) => forRobot(request, this.robot.value));
      this.points.retry();
    });
    const file = byId<HTMLInputElement>("file");
    byId("open").addEventListener("click", () => file.click());
    file.addEventListener("change", () => {
      const files = [...(file.files ?? [])];
      file.value = "";
      open(files);
    });
    byId("store").addEventListener("click", () => saveFile("request.json", store.text, "application/json"));
    byId("link").addEventListener("click", () => void this.link());
    this.undo.addEventListener("click", () => store.undo());
    this.redo.addEventListener("click", () => store.redo());
    document.addEventListener("keydown", (event) => this.hear(event));
    store.onChange(() => this.read());
  }

  showRobots(robots: RobotInfo[]): void {
    this.robot.replaceChildren(...robots.map(({ name, title }) =>
      h("option", { value: name }, `${name} – ${title}`)));
    this.read();
  }

  useExample(name: string): boolean {
    const found = EXAMPLES.find((example) => example.name === name);
    if (found === undefined) return false;
    this.points.close();
    this.store.set(found.request);
    return true;
  }

  apply(change: Record<string, unknown>): void {
    this.store.edit((request) => merged(request, change));
  }

  private read(): void {
    const { request, fault, canUndo, canRedo } = this.store;
    this.fault.textContent = fault;
    this.undo.disabled = !canUndo;
    this.redo.disabled = !canRedo;
    if (request === null) return;
    const name = String(request["robot"]);
    if ([...this.robot.options].some((option) => option.value === name)) this.robot.value = name;
    const now = JSON.stringify(request);
    const same = EXAMPLES.find((example) => example.request["robot"] === name
      && JSON.stringify({ robot: name, ...example.request }) === JSON.stringify({ robot: name, ...JSON.parse(now) }));
    this.example.value = same?.name ?? "";
  }

  private async link(): Promise<void> {
    const address = await linkTo(this.store.text);
    history.replaceState(null, "", address);
    try {
      await navigator.clipboard.writeText(address);
      this.say("The link to this request is in the clipboard and in the address bar.");
    } catch {
      // Without a safe connection there is no clipboard.
      this.say("The link to this request is in the address bar.");
    }
  }

  /** Undo and redo from anywhere but fields that have their own. */
  private hear(event: KeyboardEvent): void {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const target = event.target as HTMLElement;
    if (target.matches("textarea, input[type=text], input[type=password], input[type=number], input:not([type])")) return;
    const key = event.key.toLowerCase();
    if (event.defaultPrevented || (key !== "z" && key !== "y")) return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) this.store.redo();
    else this.store.undo();
  }
}

/** The request for another robot: the joint values of one say nothing to another. */
export function forRobot(request: Request, robot: string): Request {
  const { start, ...rest } = request;
  const kept = start === undefined || Array.isArray(start) ? rest : { start, ...rest };
  return { ...kept, robot };
}
