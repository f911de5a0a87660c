/** Reading the three kinds of meshes that robots come with. */

import {
  Color, DoubleSide, Group, Material, Mesh, MeshBasicMaterial, MeshStandardMaterial, Object3D,
} from "three";
import { ColladaLoader } from "three/examples/jsm/loaders/ColladaLoader.js";
import { OBJLoader } from "three/examples/jsm/loaders/OBJLoader.js";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";

import { fetchMesh } from "../service";

/** Stands for the colour that the URDF gives. */
const BARE = new MeshBasicMaterial();

/** Gives the bytes of the mesh at an address. */
export type MeshSource = (address: string) => Promise<ArrayBuffer>;

let source: MeshSource = fetchMesh;

/** Reads meshes elsewhere than from the service. */
export function readMeshesBy(other: MeshSource): void {
  source = other;
}

const kept = new Map<string, Promise<Object3D>>();

/** The mesh at an address of the service, without any rotation; a copy of its own. */
export async function loadMesh(address: string, colour: Color, opacity: number): Promise<Object3D> {
  let read = kept.get(address);
  if (read === undefined) {
    read = source(address).then((bytes) => parse(address, bytes));
    kept.set(address, read);
    read.catch(() => kept.delete(address));
  }
  const object = (await read).clone();
  object.traverse((part) => {
    if (part instanceof Mesh) part.material = finish(part.material, colour, opacity);
  });
  return object;
}

function parse(address: string, bytes: ArrayBuffer): Object3D {
  const suffix = address.slice(address.lastIndexOf(".")).toLowerCase();
  if (suffix === ".stl") return new Mesh(new STLLoader().parse(bytes), BARE);
  const text = new TextDecoder().decode(bytes);
  if (suffix === ".obj") return uncoloured(new OBJLoader().parse(text));
  // URDFs place the vertices as they are, whatever the file says is up.
  const upright = text.replace(/<up_axis>\s*\w+\s*<\/up_axis>/, "<up_axis>Y_UP</up_axis>");
  const parsed = new ColladaLoader().parse(upright, "");
  if (parsed === null) throw new Error(`${address} is not a Collada file`);
  const lamps: Object3D[] = [];
  parsed.scene.traverse((part) => {
    if ("isLight" in part || "isCamera" in part) lamps.push(part);
  });
  for (const lamp of lamps) lamp.removeFromParent();
  return parsed.scene;
}

function uncoloured(group: Group): Group {
  group.traverse((part) => {
    if (part instanceof Mesh) part.material = BARE;
  });
  return group;
}

/** The file's own colour, if it has one, in a finish that all robots share. */
function finish(own: Material | Material[], colour: Color, opacity: number): Material | Material[] {
  if (Array.isArray(own)) return own.map((m) => finish(m, colour, opacity) as Material);
  if (own === BARE) return plain(colour, opacity);
  return plain("color" in own ? (own.color as Color) : colour);
}

/** A matt surface. */
export function plain(colour: Color, opacity = 1): MeshStandardMaterial {
  return new MeshStandardMaterial({
    color: colour, roughness: 0.62, metalness: 0.05, side: DoubleSide,
    transparent: opacity < 1, opacity,
  });
}
