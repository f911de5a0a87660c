/** Where the tool is: position and orientation, in the base or in the path frame. */

import { Matrix4 } from "three";

import { byId, h } from "../dom";
import { rpyOf, toPath } from "../path/frames";
import type { Pose } from "../path/items";
import { angleUnit, fixed, lengthUnit, metresText, shown } from "../units";

export class Readout {
  private readonly frame = byId<HTMLSelectElement>("tool-frame");
  private readonly unit = byId("tool-unit");
  private readonly cells: HTMLElement[];
  private readonly turns: HTMLElement[];
  private path = new Matrix4();
  private last: Pose | null = null;

  constructor() {
    const cell = (host: HTMLElement, name: string): HTMLElement => {
      const value = h("dd", { "data-axis": name }, "–");
      host.append(h("dt", {}, name), value);
      return value;
    };
    this.cells = ["x", "y", "z"].map((axis) => cell(byId("tool"), axis));
    this.turns = ["roll", "pitch", "yaw"].map((axis) => cell(byId("tool-turn"), axis));
    this.frame.addEventListener("change", () => this.write());
  }

  /** Takes the path frame in the base. */
  setPath(frame: Matrix4): void {
    this.path = frame;
    this.write();
  }

  /** Takes the pose of the tool in the base. */
  show(pose: Pose): void {
    this.last = pose;
    this.write();
  }

  write(): void {
    this.unit.textContent = `${lengthUnit()}, ${angleUnit()}; tool in`;
    if (this.last === null) return;
    const { position, quaternion } = this.frame.value === "path" ? toPath(this.path, this.last) : this.last;
    const angles = rpyOf(quaternion ?? [0, 0, 0, 1]);
    for (const [i, cell] of this.cells.entries()) {
      cell.textContent = metresText(position[i]!);
      cell.dataset["value"] = String(position[i]!);
    }
    for (const [i, cell] of this.turns.entries()) {
      cell.textContent = fixed(shown(angles[i]!, "rad"), angleUnit() === "deg" ? 2 : 4);
      cell.dataset["value"] = String(angles[i]!);
    }
  }
}
