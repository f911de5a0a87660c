/** Files dropped on the page, or chosen: requests, points, robots, shapes and scenes. */

import { isObject, type Request, type RobotInfo } from "../documents";
import { byId } from "../dom";
import { addBody } from "../path/bodies";
import { hullOf } from "../path/hull";
import { Refusal, uploadRobot } from "../service";
import type { DocumentStore } from "../state/store";
import { forRobot, type Editor } from "./editor";

export class FileDrop {
  private readonly veil = byId("drop");
  private depth = 0;

  /** `known` hears of an uploaded robot, `say` of what has been done. */
  constructor(
    private readonly store: DocumentStore, private readonly editor: () => Editor,
    private readonly known: (robot: RobotInfo) => void, private readonly say: (text: string, fault?: boolean) => void,
  ) {
    const files = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    addEventListener("dragenter", (event) => { if (files(event)) this.show(1); });
    addEventListener("dragleave", (event) => { if (files(event)) this.show(-1); });
    addEventListener("dragover", (event) => { if (files(event)) event.preventDefault(); });
    addEventListener("drop", (event) => {
      if (!files(event)) return;
      event.preventDefault();
      this.depth = 0;
      this.show(0);
      void this.open([...(event.dataTransfer?.files ?? [])]);
    });
  }

  /** Takes files, each for what it is. */
  async open(files: File[]): Promise<void> {
    for (const file of files) {
      try {
        await this.take(file);
      } catch (error) {
        if (error instanceof Refusal) this.say(`${file.name}: ${error.problem.detail}`, true);
        else if (error instanceof SyntaxError || error instanceof RangeError) this.say(`${file.name}: ${error.message}`, true);
        else throw error;
      }
    }
  }

  private show(change: number): void {
    this.depth += change;
    this.veil.hidden = this.depth <= 0;
  }

  private async take(file: File): Promise<void> {
    const name = file.name.toLowerCase();
    if (name.endsWith(".stl")) {
      this.shape(file.name.replace(/\.stl$/i, ""), await file.arrayBuffer());
      return;
    }
    const text = await file.text();
    const start = text.trimStart();
    if (start.startsWith("<")) {
      await this.robot(file.name, text, "application/xml");
    } else if (start.startsWith("{") || name.endsWith(".json")) {
      await this.json(file.name, text);
    } else {
      await this.editor().points.open(file);
    }
  }

  private async json(name: string, text: string): Promise<void> {
    let document: unknown = null;
    try {
      document = JSON.parse(text);
    } catch (error) {
      if (!(error instanceof SyntaxError)) throw error;
      // The editor shows where it is no JSON.
    }
    if (isObject(document) && typeof document["urdf"] === "string") {
      await this.robot(name, text, "application/json");
    } else if (isObject(document) && !("robot" in document) && Array.isArray(document["obstacles"])) {
      const { name: _, id: __, ...scene } = document;
      this.store.edit((request) => ({ ...request, scene }));
      this.say(`The scene of ${name} is around the arm.`);
    } else {
      this.editor().points.close();
      this.store.write(text);
      this.say(`${name} is open.`);
    }
  }

  private async robot(file: string, text: string, type: string): Promise<void> {
    const info = await uploadRobot(text, type);
    this.known(info);
    this.store.edit((request: Request) => forRobot(request, info.name));
    this.say(`${file} is uploaded: ${info.title}, ${info.joints.length} joints.`);
  }

  private shape(name: string, bytes: ArrayBuffer): void {
    const { points, scale } = hullOf(bytes);
    this.store.edit((request) => addBody(request, "obstacles", { name, shape: { type: "convex", points }, position: [0, 0, 0] }));
    this.say(`${name} stands as an obstacle: the convex hull of its mesh, ${points.length} points, `
      + `read in ${scale === 1 ? "metres" : "millimetres"}.`);
  }
}
