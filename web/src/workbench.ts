/** The document in the scene: the arm at its start, points, bodies, and the handles of what is selected. */

import { Vector3 } from "three";

import { holdingOf } from "./arm/holding";
import { LiveArm } from "./arm/live";
import { isNumbers, type Request, type RobotInfo } from "./documents";
import { bodiesOf } from "./path/bodies";
import { pathFrame, toBase } from "./path/frames";
import { itemsOf, type Pose } from "./path/items";
import { same } from "./results";
import type { HandleMode } from "./scene/handles";
import type { Selection } from "./state/selection";
import type { DocumentStore } from "./state/store";
import type { ArmView } from "./view";

export class Workbench {
  readonly live: LiveArm;
  robots: RobotInfo[] = [];
  private robot: RobotInfo | null = null;
  private start: unknown = null;

  /** `changed` hears of another robot. */
  constructor(
    private readonly view: ArmView, private readonly store: DocumentStore,
    private readonly selection: Selection, private readonly changed: (robot: RobotInfo) => void,
  ) {
    this.live = new LiveArm(view, () => store.request);
    store.onChange(() => this.prune());
    selection.onChange(() => this.hold());
    view.onPick((selected) => {
      selection.set(selected);
    });
    for (const button of document.querySelectorAll<HTMLElement>("[data-handle-mode]")) {
      button.addEventListener("click", () => this.setMode(button.dataset["handleMode"] as HandleMode));
    }
    const axes = document.getElementById("handle-axes") as HTMLSelectElement;
    axes.addEventListener("change", () => view.handles?.setSpace(axes.value as "world" | "local"));
  }

  robotOf(request: Request): RobotInfo | undefined {
    return this.robots.find(({ name }) => name === request["robot"]);
  }

  /** Puts a robot into the scene, at the start of the document if it is another one; says whether it is there. */
  async place(request: Request, anew = false): Promise<boolean> {
    const robot = this.robotOf(request);
    if (robot === undefined || (await this.view.showRobot(robot)) === null) return false;
    this.view.showDocument(request);
    const start = request["start"] ?? null;
    if (anew || robot !== this.robot || !same(start, this.start)) {
      const q = isNumbers(start, robot.joints.length) ? start : robot.joints.map((joint) => joint.home);
      this.view.setJoints(q);
      if (robot !== this.robot) this.changed(robot);
      this.live.take(robot, q);
    } else {
      this.view.setJoints(this.live.q);
    }
    this.robot = robot;
    this.start = start;
    return true;
  }

  /** Marks the points of the document. */
  markPoints(request: Request): void {
    const frame = pathFrame(request);
    const dof = this.robot?.joints.length ?? 0;
    this.view.markWaypoints(itemsOf(request).map(({ pose, rest }) => {
      if (pose !== null) return new Vector3().fromArray(toBase(frame, pose).position);
      const { q } = rest;
      return isNumbers(q, dof) ? this.view.toolPositions([q])[0] ?? null : null;
    }));
  }

  /** Puts the handles at what is selected. */
  hold(): void {
    const info = this.robot;
    const own: Pose = { position: info?.tool_position ?? [0, 0, 0], quaternion: info?.tool_quaternion_xyzw ?? null };
    this.view.hold(holdingOf(this.selection.now, this.store, own, (pose) => this.live.follow(pose)));
    document.getElementById("handles")!.hidden = this.selection.now === null;
  }

  /** Nothing is selected that is no longer there. */
  private prune(): void {
    const { request } = this.store;
    const { now } = this.selection;
    if (request === null || now === null || !("index" in now)) return;
    const count = now.kind === "point" ? itemsOf(request).length
      : bodiesOf(request, now.kind === "obstacle" ? "obstacles" : "attached").length;
    if (now.index >= count) this.selection.set(null);
  }

  private setMode(mode: HandleMode): void {
    this.view.handles?.setMode(mode);
    for (const button of document.querySelectorAll<HTMLElement>("[data-handle-mode]")) {
      button.setAttribute("aria-pressed", String(button.dataset["handleMode"] === mode));
    }
  }
}
