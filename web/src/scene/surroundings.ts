/** What is checked for contact besides the arm, and the nearest two points at their time. */

import { Group, Object3D, Raycaster, Vector3 } from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

import { isObject, type Clearance, type NearestPlace, type Request } from "../documents";
import { bodyOf, dispose } from "./bodies";
import { palette } from "./palette";

interface Carried {
  object: Object3D;
  first: number;
  last: number;
}

/** How near to its time the nearest pair is shown [s]. */
const SHOWN_S = 0.15;

export class Surroundings {
  /** In the base. */
  readonly obstacles = new Group();
  /** In the tip frame. */
  readonly held = new Group();
  /** In the tool frame. */
  readonly carried = new Group();
  private readonly lines = new Group();
  private nearest: { line: Line2; time: number }[] = [];
  private parts: Carried[] = [];
  private readonly numbered = new Map<Object3D, number>();
  private clearance: Clearance | null = null;

  constructor() {
    this.obstacles.add(this.lines);
  }

  /** Shows the scene of a request; one that is named by an id is known to the service only. */
  show(request: Request): void {
    this.clear();
    const colours = palette();
    const scene = isObject(request["scene"]) ? request["scene"] : {};
    const tool = isObject(request["tool"]) ? request["tool"] : {};
    for (const [k, document] of listOf(scene["obstacles"]).entries()) {
      const object = bodyOf(document, colours.obstacle);
      if (object === null) continue;
      this.obstacles.add(object);
      this.numbered.set(object, k);
    }
    for (const document of listOf(tool["geometry"])) {
      const object = bodyOf(document, colours.carried);
      if (object !== null) this.held.add(object);
    }
    for (const document of listOf(scene["attached"])) {
      const object = bodyOf(document, colours.carried);
      if (object === null || !isObject(document)) continue;
      this.carried.add(object);
      const { first_segment: first, last_segment: last } = document;
      this.parts.push({
        object,
        first: typeof first === "number" ? first : 0,
        last: typeof last === "number" ? last : Infinity,
      });
    }
  }

  /** The number of the obstacle that a ray hits first; null: none. */
  pick(ray: Raycaster): number | null {
    const hit = ray.intersectObjects([...this.numbered.keys()], false)[0];
    return hit === undefined ? null : this.numbered.get(hit.object) ?? null;
  }

  /** Draws lines between the nearest bodies of a plan, each at its time. */
  showNearest(clearance: Clearance | null): void {
    this.clearance = clearance;
    const places = clearance === null ? [] : [clearance.self, clearance.scene];
    for (const place of places) this.addNearest(place);
  }

  /** Shows what is there at a time. */
  setTime(time: number): void {
    for (const { line, time: at } of this.nearest) line.visible = Math.abs(time - at) <= SHOWN_S;
    const segments = this.clearance?.segments ?? [];
    const now = segments.flatMap(({ begin, end }, k) => (begin <= time && time <= end ? [k] : []));
    for (const { object, first, last } of this.parts) {
      object.visible = now.length === 0 || now.some((k) => first <= k && k <= last);
    }
  }

  private addNearest({ points, time }: NearestPlace): void {
    if (points === null || time === null || points.length !== 2) return;
    const ends = points.map((p) => new Vector3(...(p as [number, number, number])));
    const material = new LineMaterial({ color: palette().fault, linewidth: 4, depthTest: false });
    const line = new Line2(new LineGeometry().setPositions(ends.flatMap((p) => p.toArray())), material);
    line.renderOrder = 2;
    line.visible = false;
    this.lines.add(line);
    this.nearest.push({ line, time });
  }

  private clear(): void {
    for (const { line } of this.nearest) line.geometry.dispose();
    this.lines.clear();
    this.nearest = [];
    this.parts = [];
    this.numbered.clear();
    this.clearance = null;
    for (const group of [this.obstacles, this.held, this.carried]) dispose(group);
    this.obstacles.add(this.lines);
  }
}

const listOf = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
