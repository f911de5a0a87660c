/** Poses between frames, and orientations as angles that people read. */

import { Euler, Matrix4, Quaternion, Vector3 } from "three";

import { isNumbers, isObject, type Request } from "../documents";
import { pathOf, poseOf, type Pose } from "./items";

/** The path frame in the base. */
export function pathFrame(request: Request): Matrix4 {
  return matrixOf(frameOf(pathOf(request)["frame"]));
}

/** A frame of the document; what it does not say is zero. */
export function frameOf(value: unknown): Pose {
  return poseOf(isObject(value) ? { position: [0, 0, 0], ...value } : null)
    ?? { position: [0, 0, 0], quaternion: null };
}

export function matrixOf({ position, quaternion }: Pose): Matrix4 {
  return new Matrix4().compose(
    new Vector3().fromArray(position),
    quaternion === null ? new Quaternion() : new Quaternion().fromArray(quaternion).normalize(),
    new Vector3(1, 1, 1),
  );
}

/** A pose with an orientation; `oriented` false leaves it out. */
export function poseOfMatrix(matrix: Matrix4, oriented = true): Pose {
  const position = new Vector3();
  const turn = new Quaternion();
  matrix.decompose(position, turn, new Vector3());
  if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);
  return { position: position.toArray(), quaternion: oriented ? turn.toArray() : null };
}

/** A pose of the path frame in the base. */
export const toBase = (frame: Matrix4, pose: Pose): Pose =>
  poseOfMatrix(frame.clone().multiply(matrixOf(pose)), pose.quaternion !== null);

/** A pose of the base in the path frame. */
export const toPath = (frame: Matrix4, pose: Pose): Pose =>
  poseOfMatrix(frame.clone().invert().multiply(matrixOf(pose)), pose.quaternion !== null);

/** Roll, pitch and yaw, about fixed x, y and z in this order [rad]. */
export function rpyOf(quaternion: number[]): number[] {
  const { x, y, z } = new Euler().setFromQuaternion(new Quaternion().fromArray(quaternion), "ZYX");
  return [x, y, z];
}

export function quaternionOf(rpy: number[]): number[] {
  return new Quaternion().setFromEuler(new Euler(rpy[0], rpy[1], rpy[2], "ZYX")).toArray();
}

/** Three numbers of a field, or those of `otherwise`. */
export const three = (value: unknown, otherwise: number[]): number[] =>
  isNumbers(value, 3) ? value : otherwise;
