/** Handles in the scene, by which what is selected is moved and turned with the mouse. */

import { Object3D, Vector3 } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";

import { matrixOf, poseOfMatrix } from "../path/frames";
import type { Pose } from "../path/items";
import type { Stage } from "./stage";

/** What can be held: where it is, and who hears of its motion. */
export interface Held {
  /** Names it; while it is dragged, holding it again changes nothing. */
  id: string;
  /** The frame that the pose is in. */
  parent: Object3D;
  pose: Pose;
  /** Hears of every new pose; `key` is the same throughout one drag. */
  moved: (pose: Pose, key: string) => void;
  /** Hears that the drag has ended. */
  ended?: () => void;
}

export type HandleMode = "translate" | "rotate";

export class Handles {
  private readonly controls: TransformControls;
  private readonly place = new Object3D();
  private held: Held | null = null;
  private drags = 0;

  constructor(private readonly stage: Stage) {
    this.controls = new TransformControls(stage.camera, stage.canvas);
    this.controls.size = 0.75;
    stage.scene.add(this.controls.getHelper());
    this.controls.addEventListener("change", stage.draw);
    this.controls.addEventListener("dragging-changed", ({ value }) => {
      stage.orbit.enabled = value !== true;
      stage.host.dataset["dragging"] = String(value);
      if (value === true) this.drags += 1;
      else this.held?.ended?.();
    });
    this.controls.addEventListener("objectChange", () => {
      this.place.updateMatrix();
      this.held?.moved(this.pose(), `drag-${this.held.id}-${this.drags}`);
      this.tell();
    });
    stage.onDrawn(() => this.tell());
  }

  get dragging(): boolean {
    return this.controls.dragging;
  }

  /** Whether the mouse is on a handle. */
  get hovered(): boolean {
    return this.held !== null && this.controls.axis !== null;
  }

  /** Takes up something; null: nothing. */
  hold(held: Held | null): void {
    if (this.controls.dragging && held !== null && held.id === this.held?.id) {
      this.held = held;
      return;
    }
    this.held = held;
    if (held === null) {
      this.controls.detach();
      this.place.removeFromParent();
    } else {
      matrixOf(held.pose).decompose(this.place.position, this.place.quaternion, new Vector3());
      held.parent.add(this.place);
      this.place.updateMatrixWorld(true);
      this.controls.attach(this.place);
    }
    this.tell();
    this.stage.draw();
  }

  setMode(mode: HandleMode): void {
    this.controls.setMode(mode);
  }

  /** Along the axes of what is held, or of the base. */
  setSpace(space: "local" | "world"): void {
    this.controls.setSpace(space);
  }

  private pose(): Pose {
    return poseOfMatrix(this.place.matrix);
  }

  /** Writes where the handle is in the view [px], for those who cannot see it. */
  private tell(): void {
    const { host } = this.stage;
    if (this.held === null) {
      delete host.dataset["handle"];
      return;
    }
    const at = this.place.getWorldPosition(new Vector3()).project(this.stage.camera);
    const { clientWidth: width, clientHeight: height } = host;
    host.dataset["handle"] = `${(((at.x + 1) / 2) * width).toFixed(1)},${(((1 - at.y) / 2) * height).toFixed(1)}`;
    host.dataset["held"] = this.held.id;
  }
}
