/** The convex hull of an STL file, as the service wants it of a mesh. */

import { Vector3 } from "three";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import { ConvexHull } from "three/examples/jsm/math/ConvexHull.js";

/** A mesh that is larger than this many units is in millimetres. */
const LARGEST_M = 10;
const DIGITS = 6;

/**
 * The corners of the hull [m], and the scale they were read with.
 *
 * @throws RangeError where the mesh has no volume.
 */
export function hullOf(stl: ArrayBuffer): { points: number[][]; scale: number } {
  const positions = new STLLoader().parse(stl).getAttribute("position");
  const corners = new Map<string, Vector3>();
  for (let i = 0; i < positions.count; i += 1) {
    const corner = new Vector3().fromBufferAttribute(positions, i);
    corners.set(corner.toArray().join(), corner);
  }
  const all = [...corners.values()];
  if (all.length < 4) throw new RangeError("this is not an STL file of a body: it has fewer than four corners");
  const largest = Math.max(...all.map((p) => Math.max(Math.abs(p.x), Math.abs(p.y), Math.abs(p.z))));
  const scale = largest > LARGEST_M ? 0.001 : 1;
  const hull = new Map<string, number[]>();
  for (const { edge: first } of new ConvexHull().setFromPoints(all).faces) {
    let edge = first;
    do {
      const point = edge.head().point.toArray().map((c) => Number((c * scale).toFixed(DIGITS)) + 0);
      hull.set(point.join(), point);
      edge = edge.next;
    } while (edge !== first);
  }
  if (hull.size < 4) throw new RangeError("the mesh has no volume");
  return { points: [...hull.values()], scale };
}
