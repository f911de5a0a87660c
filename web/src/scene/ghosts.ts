/** Ghosts: the same arm at other configurations, seen through. */

import { Color, Group, Material, Mesh, MeshBasicMaterial } from "three";

import type { RobotInfo } from "../documents";
import type { Target } from "../targets";
import { Arm } from "./arm";

export class Ghosts {
  readonly group = new Group();
  private readonly arms = new Map<string, Arm>();
  private robot: { info: RobotInfo; urdf: string } | null = null;
  private tool: Target | null = null;

  /** Forgets all ghosts; those to come are of another robot. */
  setRobot(info: RobotInfo, urdf: string): void {
    this.clear();
    this.robot = { info, urdf };
  }

  setTool(tool: Target | null): void {
    this.tool = tool;
    for (const arm of this.arms.values()) arm.setTool(tool);
  }

  clear(): void {
    this.group.clear();
    this.arms.clear();
  }

  /** Shows a ghost at joint values; null: takes it away. */
  show(name: string, q: number[] | null, colour: Color, changed: () => void): void {
    let arm = this.arms.get(name);
    if (q === null || this.robot === null) {
      arm?.root.removeFromParent();
      this.arms.delete(name);
      return;
    }
    if (arm === undefined) {
      arm = new Arm(this.robot.info, this.robot.urdf);
      arm.setTool(this.tool);
      this.arms.set(name, arm);
      this.group.add(arm.root);
      const made = arm;
      made.root.visible = false; // until it is all seen through
      void made.complete.then(() => { fade(made, colour); made.root.visible = true; changed(); });
    }
    arm.setJoints(q);
  }

  get names(): string[] {
    return [...this.arms.keys()];
  }
}

function fade(arm: Arm, colour: Color): void {
  const glass: Material = new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.16, depthWrite: false });
  arm.root.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    part.material = glass;
    part.castShadow = part.receiveShadow = false;
  });
}
