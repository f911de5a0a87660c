/** The poses that a request asks for, in the base, in the order of the service's waypoints. */

import { Matrix4, Quaternion, Vector3 } from "three";

import { failedWaypoints, isNumbers, isObject, type Problem, type Request } from "./documents";

export interface Target {
  position: Vector3;
  /** null: any orientation. */
  quaternion: Quaternion | null;
}

/** One entry a waypoint; null where the document does not say the pose itself. */
export function targetsOf(request: Request): (Target | null)[] {
  const path = request["path"];
  if (!isObject(path)) return [];
  const frame = targetOf(path["frame"]) ?? { position: new Vector3(), quaternion: null };
  const T_base_path = new Matrix4().compose(
    frame.position, frame.quaternion ?? new Quaternion(), new Vector3(1, 1, 1),
  );
  return listed(path).map((pose) => {
    const target = targetOf(pose);
    if (target === null) return null;
    target.position.applyMatrix4(T_base_path);
    if (frame.quaternion !== null) target.quaternion?.premultiply(frame.quaternion);
    return target;
  });
}

/** The poses as written; curves have waypoints that only the service knows, so they end the list. */
function listed(path: Record<string, unknown>): unknown[] {
  if (Array.isArray(path["waypoints"])) return path["waypoints"];
  const found: unknown[] = path["begin"] ? [path["begin"]] : [];
  for (const segment of Array.isArray(path["segments"]) ? path["segments"] : []) {
    if (!isObject(segment)) break;
    if (segment["type"] === "spline" && Array.isArray(segment["through"])) {
      found.push(...segment["through"]);
    } else if (["line", "arc", "joint"].includes(String(segment["type"]))) {
      found.push(segment["to"] ?? null);
    } else {
      break;
    }
  }
  return found;
}

function targetOf(pose: unknown): Target | null {
  if (!isObject(pose) || !isNumbers(pose["position"], 3)) return null;
  const q = pose["quaternion_xyzw"];
  return {
    position: new Vector3(...pose["position"]),
    quaternion: isNumbers(q, 4) ? new Quaternion(...q).normalize() : null,
  };
}

/** The poses that a problem says could not be had; of a curve, only the service knows them. */
export function failedTargets(problem: Problem, request: Request): Target[] {
  const rows = (problem.waypoints ?? []).map((row) => (isObject(row) ? row["target"] : null));
  const told = (rows.some(isObject) ? rows : [problem.target]).map(targetOf).filter((target) => target !== null);
  if (told.length > 0) return told;
  const listed = targetsOf(request);
  return failedWaypoints(problem).flatMap((index) => listed[index] ?? []);
}

/** The tool of a request in the tip frame; null: the robot's own. */
export function toolOf(request: Request): Target | null {
  const tool = request["tool"];
  if (!isObject(tool)) return null;
  return targetOf({ position: [0, 0, 0], ...tool });
}
