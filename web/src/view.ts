/** The arm and what is around it: the one place that puts joint values into the scene. */

import { Object3D, Raycaster, Vector3 } from "three";

import type { Clearance, Request, RobotInfo } from "./documents";
import { byId } from "./dom";
import { Readout } from "./panels/readout";
import { pathFrame } from "./path/frames";
import type { Pose } from "./path/items";
import { Arm } from "./scene/arm";
import { Ghosts } from "./scene/ghosts";
import { Handles, type Held } from "./scene/handles";
import { Marks, triad } from "./scene/marks";
import { onPaletteChange, palette } from "./scene/palette";
import { Surroundings } from "./scene/surroundings";
import { Stage, type View } from "./scene/stage";
import { fetchVisual } from "./service";
import type { Selected } from "./state/selection";
import { toolOf, type Target } from "./targets";

/** The frame that something held is in. */
export type Carrier = "base" | "tip" | "tool";

export class ArmView {
  readonly readout = new Readout();
  readonly handles: Handles | null;
  private readonly marks = new Marks();
  private readonly around = new Surroundings();
  private readonly ghosts = new Ghosts();
  private readonly stage: Stage | null;
  private readonly note = byId("stage-note");
  private readonly host = byId("stage");
  private arm: Arm | null = null;
  private wanted = "";

  constructor(repaint: () => void) {
    this.stage = this.makeStage();
    this.stage?.scene.add(this.marks.group, this.around.obstacles, this.ghosts.group);
    this.handles = this.stage === null ? null : new Handles(this.stage);
    onPaletteChange(repaint);
    for (const button of document.querySelectorAll<HTMLElement>("[data-view]")) {
      button.addEventListener("click", () => this.look(button.dataset["view"] as View));
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
    this.handles?.hold(null);
    this.arm?.root.removeFromParent();
    const arm = new Arm(info, urdf);
    arm.tool.add(triad(0.08), this.around.carried);
    arm.tip.add(this.around.held);
    this.arm = arm;
    this.ghosts.setRobot(info, urdf);
    arm.setJoints(info.joints.map((joint) => joint.home));
    this.stage?.scene.add(arm.root);
    this.look("fit");
    this.host.dataset["robot"] = info.name;
    this.host.dataset["meshes"] = "loading";
    this.say("Loading meshes");
    void arm.complete.then((missing) => {
      if (this.arm !== arm) return;
      this.host.dataset["meshes"] = "ready";
      this.say(missing > 0 ? `${missing} meshes could not be loaded` : "");
      this.follow();
    });
    return arm;
  }

  /** Shows everything of a document that stands still. */
  showDocument(request: Request): void {
    const tool = toolOf(request);
    this.arm?.setTool(tool);
    this.ghosts.setTool(tool);
    this.readout.setPath(pathFrame(request));
    this.around.show(request);
    this.host.dataset["obstacles"] = String(Math.max(this.around.obstacles.children.length - 1, 0));
    this.stage?.draw();
  }

  setJoints(q: number[]): void {
    if (this.arm === null) return;
    this.arm.setJoints(q);
    this.readout.show(this.arm.toolPose());
    this.stage?.draw();
  }

  /** The pose of the tool in the base. */
  toolPose(): Pose {
    return this.arm?.toolPose() ?? { position: [0, 0, 0], quaternion: null };
  }

  /** Where the tool is at each of several configurations; the arm stays where it was. */
  toolPositions(rows: number[][]): Vector3[] {
    const arm = this.arm;
    if (arm === null) return [];
    const now = arm.joints;
    const found = rows.map((q) => {
      arm.setJoints(q);
      return arm.toolPosition();
    });
    if (now.length > 0) arm.setJoints(now);
    return found;
  }

  /** How the tool is turned at each of several configurations, as quaternions. */
  toolTurns(rows: number[][]): number[][] {
    const arm = this.arm;
    if (arm === null) return [];
    const now = arm.joints;
    const found = rows.map((q) => {
      arm.setJoints(q);
      return arm.toolPose().quaternion!;
    });
    if (now.length > 0) arm.setJoints(now);
    return found;
  }

  /** Makes the arm red and says why; an empty reason makes it as it was. */
  setFault(reason: string): void {
    if (this.host.dataset["fault"] === reason) return;
    this.host.dataset["fault"] = reason;
    this.note.classList.toggle("fault", reason !== "");
    this.say(reason);
    this.arm?.setFault(reason !== "");
    this.stage?.draw();
  }

  /** Whether the arm is on its way to where it is to follow. */
  setBusy(busy: boolean): void {
    this.host.dataset["following"] = String(busy);
  }

  /** Puts the handles at something; null: at nothing. */
  hold(held: (Omit<Held, "parent"> & { carrier: Carrier }) | null): void {
    if (this.stage === null || this.arm === null || this.handles === null) return;
    if (held === null) {
      this.handles.hold(null);
      return;
    }
    const parents = { base: this.stage.scene, tip: this.arm.tip, tool: this.arm.tool };
    this.handles.hold({ ...held, parent: parents[held.carrier] });
  }

  /** Hears of clicks on points and bodies; null: of a click on neither. */
  onPick(listener: (selected: Selected | null) => void): void {
    this.stage?.onClick((ray) => {
      if (this.handles?.hovered) return;
      listener(this.picked(ray));
    });
  }

  private picked(ray: Raycaster): Selected | null {
    const point = this.marks.pick(ray);
    if (point !== null) return { kind: "point", index: point };
    const obstacle = this.around.pick(ray);
    return obstacle === null ? null : { kind: "obstacle", index: obstacle };
  }

  /** Shows the arm also at other joint values; null: no longer. */
  ghost(name: string, q: number[] | null): void {
    const colour = name === "other" ? palette().other : palette().ghost;
    this.ghosts.show(name, q, colour, () => this.stage?.draw());
    this.host.dataset["ghosts"] = this.ghosts.names.join(" ");
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

  markWaypoints(positions: (Vector3 | null)[]): void {
    this.marks.showWaypoints(positions, 0.007);
    this.stage?.draw();
  }

  /** Draws the way of the tool; each point in a colour of its own where there are `colours`. */
  markTrace(points: Vector3[], colours: number[] | null = null): void {
    this.marks.showTrace(points, colours);
    this.stage?.draw();
  }

  /** Draws the way of the tool of a plan to compare with. */
  markOther(points: Vector3[]): void {
    this.marks.showOther(points);
    this.stage?.draw();
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

  /** The view of now as PNG in a data address; null where nothing can be drawn. */
  picture(): string | null {
    return this.stage?.picture() ?? null;
  }

  private content(): Object3D[] {
    return this.arm === null ? [] : [this.arm.root, this.marks.group, this.around.obstacles];
  }

  private say(text: string): void {
    this.note.textContent = text;
  }
}
