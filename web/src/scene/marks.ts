/** What is drawn around the arm: the path of the tool, its waypoints, and where planning failed. */

import {
  ArrowHelper, Group, InstancedMesh, Material, Matrix4, Mesh, MeshBasicMaterial, Raycaster, SphereGeometry,
  TorusGeometry, Vector3, type Object3D,
} from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

import type { Target } from "../targets";
import { palette } from "./palette";

const AXIS_COLOURS = ["#d3493f", "#3f9a4d", "#3b78d8"];

/** Three arrows, red, green and blue for x, y and z, seen through whatever is before them. */
export function triad(length: number): Group {
  const group = new Group();
  for (const [i, colour] of AXIS_COLOURS.entries()) {
    const direction = new Vector3().setComponent(i, 1);
    const arrow = new ArrowHelper(direction, new Vector3(), length, colour, length * 0.28, length * 0.16);
    for (const part of [arrow.line, arrow.cone]) {
      (part.material as Material).depthTest = false;
      part.renderOrder = 1;
    }
    group.add(arrow);
  }
  return group;
}

export class Marks {
  readonly group = new Group();
  private done: Line2 | null = null;
  private balls: InstancedMesh | null = null;
  private listed: number[] = [];

  clear(): void {
    this.group.traverse((part) => {
      if (part instanceof Mesh) part.geometry.dispose();
    });
    this.group.clear();
    this.done = null;
    this.balls = null;
  }

  /** Marks waypoints with small balls; null: not known where. */
  showWaypoints(positions: (Vector3 | null)[], size: number): void {
    this.listed = positions.flatMap((p, i) => (p === null ? [] : [i]));
    if (this.listed.length === 0) return;
    const material = new MeshBasicMaterial({ color: palette().waypoint });
    this.balls = new InstancedMesh(new SphereGeometry(size, 16, 12), material, this.listed.length);
    for (const [k, i] of this.listed.entries()) this.balls.setMatrixAt(k, new Matrix4().setPosition(positions[i]!));
    this.group.add(this.balls);
  }

  /** The number of the waypoint that a ray hits; null: none. */
  pick(ray: Raycaster): number | null {
    const hit = this.balls === null ? undefined : ray.intersectObject(this.balls)[0];
    return hit?.instanceId === undefined ? null : this.listed[hit.instanceId] ?? null;
  }

  /** Draws the tool's way through the points, in `colours` (three numbers a point) if there are any. */
  showTrace(points: Vector3[], colours: number[] | null): void {
    if (points.length < 2) return;
    const geometry = (): LineGeometry => new LineGeometry().setPositions(points.flatMap((p) => p.toArray()));
    const { ahead, done } = palette();
    if (colours !== null) {
      const coloured = geometry().setColors(colours);
      this.group.add(new Line2(coloured, new LineMaterial({ vertexColors: true, linewidth: 4 })));
      return;
    }
    this.group.add(new Line2(geometry(), new LineMaterial({ color: ahead, linewidth: 1.6 })));
    this.done = new Line2(geometry(), new LineMaterial({ color: done, linewidth: 3.2 }));
    this.group.add(this.done);
  }

  /** Draws the way of the tool of another plan. */
  showOther(points: Vector3[]): void {
    if (points.length < 2) return;
    const geometry = new LineGeometry().setPositions(points.flatMap((p) => p.toArray()));
    this.group.add(new Line2(geometry, new LineMaterial({ color: palette().other, linewidth: 1.6 })));
  }

  /** Says how many pieces of the trace have been passed. */
  setPassed(pieces: number): void {
    if (this.done === null) return;
    this.done.visible = pieces > 0;
    this.done.geometry.instanceCount = Math.max(pieces, 1);
  }

  /** Marks a waypoint that failed, and how far from it the tool stays; null: that is not known. */
  showFailure(target: Target, tool: Vector3 | null, size: number): void {
    // What went wrong has to be seen, whatever is before it.
    const material = new MeshBasicMaterial({ color: palette().fault, depthTest: false, transparent: true });
    const mark: Object3D[] = [new Mesh(new SphereGeometry(size * 1.5, 20, 14), material)];
    for (const turn of [0, Math.PI / 2]) {
      const ring = new Mesh(new TorusGeometry(size * 4, size * 0.35, 10, 48), material);
      ring.rotation.x = turn;
      mark.push(ring);
    }
    if (target.quaternion !== null) {
      const frame = triad(size * 9);
      frame.quaternion.copy(target.quaternion);
      mark.push(frame);
    }
    for (const part of mark) {
      part.position.copy(target.position);
      part.renderOrder = 1;
    }
    this.group.add(...mark);
    if (tool === null) return;
    const gap = new LineGeometry().setPositions([...tool.toArray(), ...target.position.toArray()]);
    const line = new LineMaterial({
      color: palette().fault, linewidth: 3, dashed: true, dashSize: size * 2, gapSize: size * 1.4,
    });
    this.group.add(new Line2(gap, line).computeLineDistances());
  }
}
