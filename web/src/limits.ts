/** The limits that a motion keeps: the strictest of the robot's and the request's. */

import { isNumbers, isObject, type Request, type RobotInfo } from "./documents";

/** Lowest and highest value of a joint; null: none. */
export type Range = { lower: number | null; upper: number | null };

/** For each joint, the limits of position, velocity and acceleration. */
export function limitsOf(robot: RobotInfo, request: Request): Range[][] {
  const asked = isObject(request["limits"]) ? request["limits"] : {};
  const rate = (kind: "velocity" | "acceleration", j: number): Range => {
    const scale = asked[`${kind}_scale`];
    const own = robot.joints[j]![kind] * (typeof scale === "number" ? scale : 1);
    const above = entry(asked[kind], j);
    const below = entry(asked[`${kind}_lower`], j);
    const upper = above === null ? own : Math.min(own, above);
    return { lower: below === null ? -upper : Math.max(-own, below), upper };
  };
  return robot.joints.map((joint, j) => [
    { lower: joint.lower, upper: joint.upper },
    rate("velocity", j),
    rate("acceleration", j),
  ]);
}

function entry(value: unknown, j: number): number | null {
  if (typeof value === "number") return value;
  return isNumbers(value) ? (value[j] ?? null) : null;
}
