/** Obstacles, parts of the tool and what it carries, as the request gives them. */

import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, CylinderGeometry, Group, InstancedMesh, Matrix4, Mesh,
  MeshStandardMaterial, Object3D, Quaternion, SphereGeometry, Vector3, type Color,
} from "three";
import { ConvexGeometry } from "three/examples/jsm/geometries/ConvexGeometry.js";

import { isNumbers, isObject } from "../documents";

/** A body at its place; null: the document does not say one that can be drawn. */
export function bodyOf(document: unknown, colour: Color): Object3D | null {
  if (!isObject(document) || !isObject(document["shape"])) return null;
  const padding = typeof document["padding"] === "number" ? document["padding"] : 0;
  const object = shapeOf(document["shape"], padding, finish(colour));
  if (object === null) return null;
  const { position, quaternion_xyzw: turn } = document;
  if (isNumbers(position, 3)) object.position.set(...(position as [number, number, number]));
  if (isNumbers(turn, 4)) object.quaternion.copy(new Quaternion(...(turn as [number, number, number, number])).normalize());
  object.name = String(document["name"]);
  return object;
}

/** Frees what was made for bodies. */
export function dispose(bodies: Group): void {
  bodies.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    part.geometry.dispose();
    (part.material as MeshStandardMaterial).dispose();
  });
  bodies.clear();
}

function finish(colour: Color): MeshStandardMaterial {
  return new MeshStandardMaterial({ color: colour, roughness: 0.9, transparent: true, opacity: 0.45, depthWrite: false });
}

function shapeOf(shape: Record<string, unknown>, padding: number, material: MeshStandardMaterial): Object3D | null {
  const { size, radius, length, points } = shape;
  const r = typeof radius === "number" ? radius + padding : null;
  let geometry: BufferGeometry | null = null;
  if (shape["type"] === "box" && isNumbers(size, 3)) {
    geometry = new BoxGeometry(...(size.map((edge) => edge + 2 * padding) as [number, number, number]));
  } else if (shape["type"] === "sphere" && r !== null) {
    geometry = new SphereGeometry(r, 32, 20);
  } else if (shape["type"] === "cylinder" && r !== null && typeof length === "number") {
    // Theirs stand along y, ours along z.
    geometry = new CylinderGeometry(r, r, length + 2 * padding, 32).rotateX(Math.PI / 2);
  } else if (shape["type"] === "capsule" && r !== null && typeof length === "number") {
    geometry = new CapsuleGeometry(r, length, 10, 24).rotateX(Math.PI / 2);
  } else if (shape["type"] === "convex") {
    const corners = vectors(points);
    if (corners.length >= 4) geometry = new ConvexGeometry(corners);
  } else if (shape["type"] === "points" && r !== null) {
    return cloud(vectors(points), r, material);
  }
  return geometry === null ? null : new Mesh(geometry, material);
}

function cloud(centres: Vector3[], radius: number, material: MeshStandardMaterial): Object3D | null {
  if (centres.length === 0) return null;
  const balls = new InstancedMesh(new SphereGeometry(radius, 10, 8), material, centres.length);
  for (const [i, centre] of centres.entries()) balls.setMatrixAt(i, new Matrix4().setPosition(centre));
  return balls;
}

function vectors(points: unknown): Vector3[] {
  if (!Array.isArray(points) || !points.every((p) => isNumbers(p, 3))) return [];
  return points.map((p: number[]) => new Vector3(p[0], p[1], p[2]));
}
