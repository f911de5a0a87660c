/** A robot without shapes: its links as rods from joint to joint, its joints as drums. */

import { CapsuleGeometry, CylinderGeometry, Group, Mesh, Object3D, Quaternion, Vector3 } from "three";
import type { URDFJoint } from "urdf-loader";

import { plain } from "./meshes";
import { palette } from "./palette";

const Y = new Vector3(0, 1, 0);
const SHORTEST = 1e-4;

/** Draws a chain; what is drawn moves with it. Returns what was added. */
export function drawSkeleton(chain: URDFJoint[], tool: Object3D): Object3D[] {
  const offsets = chain.map((joint) => ({ parent: joint.parent, to: joint.position.clone() }));
  offsets.push({ parent: tool.parent, to: tool.position.clone() });
  const reach = offsets.reduce((sum, { to }) => sum + to.length(), 0);
  const radius = Math.min(Math.max(0.042 * reach, 0.008), 0.06);
  const link = plain(palette().link);
  const housing = plain(palette().housing);
  const added: Object3D[] = [];
  const add = (parent: Object3D | null, mesh: Mesh): void => {
    mesh.castShadow = mesh.receiveShadow = true;
    parent?.add(mesh);
    added.push(mesh);
  };
  const turning = chain.filter((joint) => joint.jointType !== "fixed");
  for (const [i, joint] of turning.entries()) {
    const shrink = 1 - (0.45 * i) / Math.max(turning.length - 1, 1);
    const slides = joint.jointType === "prismatic";
    const size = radius * shrink * (slides ? 0.9 : 1.22);
    const drum = new Mesh(new CylinderGeometry(size, size, size * (slides ? 3 : 2), 40), housing);
    drum.quaternion.copy(new Quaternion().setFromUnitVectors(Y, joint.axis.clone().normalize()));
    add(joint, drum);
  }
  let passed = 0;
  for (const [i, { parent, to }] of offsets.entries()) {
    const shrink = 1 - (0.45 * passed) / Math.max(turning.length, 1);
    if (chain[i] !== undefined && chain[i].jointType !== "fixed") passed += 1;
    const length = to.length();
    if (length < SHORTEST) continue;
    const last = i === offsets.length - 1;
    const thickness = radius * shrink * (last ? 0.45 : 0.85);
    const rod = new Mesh(new CapsuleGeometry(Math.min(thickness, length), length, 8, 28), link);
    rod.position.copy(to).multiplyScalar(0.5);
    rod.quaternion.setFromUnitVectors(Y, to.clone().normalize());
    add(parent, rod);
  }
  const first = chain[0]?.parent ?? null;
  const foot = new Mesh(new CylinderGeometry(radius * 1.5, radius * 1.8, radius * 0.9, 48), housing);
  foot.rotation.x = Math.PI / 2;
  foot.position.z = radius * 0.45;
  const plate = new Group();
  plate.add(foot);
  first?.add(plate);
  foot.castShadow = foot.receiveShadow = true;
  added.push(plate);
  return added;
}
