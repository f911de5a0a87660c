/** The arm and what is around it: the one place that puts joint values into the scene. */

import { Object3D, Vector3 } from "three";

import type { Clearance, Request, RobotInfo } from "./documents";
import { byId, h } from "./dom";
import { Arm } from "./scene/arm";
import { Marks, triad } from "./scene/marks";
import { onPaletteChange } from "./scene/palette";
import { Surroundings } from "./scene/surroundings";
import { Stage, type View } from "./scene/stage";
import { fetchVisual } from "./service";
import type { Target } from "./targets";
import { fixed } from "./units";

export class ArmView {
  private readonly marks = new Marks();
  private readonly around = new Surroundings();
  private readonly stage: Stage | null;
  private readonly note = byId("stage-note");
  private readonly readout = byId("tool");
  private arm: Arm | null = null;
  private wanted = "";

  constructor(repaint: () => void) {
    this.stage = this.makeStage();
    this.stage?.scene.add(this.marks.group, this.around.obstacles);
    onPaletteChange(repaint);
    for (const button of document.querySelectorAll<HTMLElement>("[data-view]")) {
      button.addEventListener("click", () => this.look(button.dataset["view"] as View));
    }
    for (const axis of "xyz") {
      this.readout.append(h("dt", {}, axis), h("dd", { "data-axis": axis }, "–"));
    }
  }

  private makeStage(): Stage | null {
    try {
      return new Stage(byId("stage"));
    } catch {
      // The rest of the page is of use without it.
      this.note.textContent = "This browser cannot draw in 3D (WebGL is off).";
      return null;
    }
  }

  /** Shows another robot; resolves when it can be moved. */
  async showRobot(info: RobotInfo): Promise<Arm | null> {
    if (this.arm?.info === info) return this.arm;
    this.wanted = info.name;
    const urdf = await fetchVisual(info.name);
    if (this.wanted !== info.name) return null; // another was chosen in the meantime
    this.arm?.root.removeFromParent();
    const arm = new Arm(info, urdf);
    arm.tool.add(triad(0.08), this.around.carried);
    arm.tip.add(this.around.held);
    this.arm = arm;
    arm.setJoints(info.joints.map((joint) => joint.home));
    this.stage?.scene.add(arm.root);
    this.look("fit");
    const host = byId("stage");
    host.dataset["robot"] = info.name;
    host.dataset["meshes"] = "loading";
    this.say("Loading meshes");
    void arm.complete.then((missing) => {
      if (this.arm !== arm) return;
      host.dataset["meshes"] = "ready";
      this.say(missing > 0 ? `${missing} meshes could not be loaded` : "");
      this.follow();
    });
    return arm;
  }

  setTool(tool: Target | null): void {
    this.arm?.setTool(tool);
  }

  setJoints(q: number[]): void {
    if (this.arm === null) return;
    this.arm.setJoints(q);
    const at = this.arm.toolPosition();
    for (const cell of this.readout.querySelectorAll<HTMLElement>("dd")) {
      const value = at[cell.dataset["axis"] as "x" | "y" | "z"];
      cell.textContent = fixed(value, 4);
      cell.dataset["value"] = String(value);
    }
    this.stage?.draw();
  }

  /** Where the tool is at each of several configurations. */
  toolPositions(rows: number[][]): Vector3[] {
    const arm = this.arm;
    if (arm === null) return [];
    return rows.map((q) => {
      arm.setJoints(q);
      return arm.toolPosition();
    });
  }

  /** Shows obstacles, the shape of the tool and what it carries. */
  showSurroundings(request: Request): void {
    this.around.show(request);
    byId("stage").dataset["obstacles"] = String(Math.max(this.around.obstacles.children.length - 1, 0));
    this.stage?.draw();
  }

  /** Draws the nearest bodies of a plan at their times. */
  markNearest(clearance: Clearance | null): void {
    this.around.showNearest(clearance);
  }

  /** Shows what is carried and how near bodies are at a time. */
  setTime(time: number): void {
    this.around.setTime(time);
    this.stage?.draw();
  }

  clearMarks(): void {
    this.marks.clear();
    this.stage?.draw();
  }

  markWaypoints(positions: Vector3[]): void {
    this.marks.showWaypoints(positions, 0.007);
    this.stage?.draw();
  }

  markTrace(points: Vector3[]): void {
    this.marks.showTrace(points);
  }

  /** Marks poses that could not be had; `q` comes closest to the first, null where none is told. */
  markFailures(targets: Target[], q: number[] | null): void {
    const [tool] = q === null ? [] : this.toolPositions([q]);
    const size = Math.max(0.01, 0.007 * (this.arm?.size() ?? 0));
    for (const [i, target] of targets.entries()) {
      this.marks.showFailure(target, i === 0 ? tool ?? null : null, size);
    }
    this.stage?.draw();
  }

  setPassed(pieces: number): void {
    this.marks.setPassed(pieces);
  }

  look(view: View): void {
    this.stage?.look(view, this.content());
  }

  /** Looks at all there is now, unless the user has chosen how to look. */
  follow(): void {
    this.stage?.follow(this.content());
  }

  private content(): Object3D[] {
    return this.arm === null ? [] : [this.arm.root, this.marks.group, this.around.obstacles];
  }

  private say(text: string): void {
    this.note.textContent = text;
  }
}
