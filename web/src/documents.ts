/** The documents of the service, as far as the page reads them. SI units. */

export interface JointInfo {
  name: string;
  type: "revolute" | "continuous" | "prismatic";
  lower: number | null;
  upper: number | null;
  velocity: number;
  acceleration: number;
  home: number;
}

export interface RobotInfo {
  name: string;
  title: string;
  joints: JointInfo[];
  base_frame: string;
  tip_frame: string;
  coupling: { serial: string[]; matrix: number[][]; offset: number[] } | null;
  tool_position: number[];
  tool_quaternion_xyzw: number[];
  /** What its controller asks for; null: none is known. */
  controller: { jerk: number[] | null } | null;
}

export interface Place {
  joint: string;
  time: number;
}

/** A segment with limits of its own; null: not limited there. */
export interface SegmentCertificate {
  field: string;
  begin: number;
  velocity_limit_ratio: number | null;
  acceleration_limit_ratio: number | null;
  torque_limit_ratio: number | null;
  tool_speed_ratio: number | null;
  tool_acceleration_ratio: number | null;
}

/** How near two bodies come, and where on each; null: no pair is checked. */
export interface NearestPlace {
  proven: boolean;
  least: number | null;
  time: number | null;
  pair: string[] | null;
  points: number[][] | null;
}

export interface Clearance extends NearestPlace {
  clearance: number;
  self: NearestPlace;
  scene: NearestPlace;
  segments: { begin: number; end: number }[];
  unchecked: string[];
}

export interface Certificate {
  valid: boolean;
  max_position_error: number | null;
  max_orientation_error: number | null;
  max_path_deviation: number | null;
  max_orientation_deviation: number | null;
  max_path_deviation_time: number | null;
  max_orientation_deviation_time: number | null;
  position_limit_ratio: number;
  position_limit_at: Place | null;
  velocity_limit_ratio: number;
  velocity_limit_at: Place;
  acceleration_limit_ratio: number;
  acceleration_limit_at: Place;
  jerk_limited: boolean;
  jerk_limit_ratio: number | null;
  jerk_limit_at: Place | null;
  torque_limit_ratio: number | null;
  torque_limit_at: Place | null;
  tool_speed_ratio: number | null;
  tool_speed_time: number | null;
  tool_acceleration_ratio: number | null;
  tool_acceleration_time: number | null;
  min_singular_value: number;
  min_singular_value_time: number;
  elongation_sum: number;
  elongation_lower_bound: number;
  segments: SegmentCertificate[];
  /** null: nothing was checked for contact. */
  clearance: Clearance | null;
}

export interface Trajectory {
  time: number[];
  q: number[][];
  dq: number[][];
  ddq: number[][];
}

export interface Timing {
  duration: number;
  binding: { limit: string; joint: string | null; share: number }[];
  summary: string;
  what_if: { limit: string; joint: string | null; factor: number; duration: number }[];
}

export interface Plan {
  id: string;
  version: string;
  robot: string;
  joint_names: string[];
  joint_units: ("rad" | "m")[];
  waypoints: { q: number[][]; time: number[] };
  trajectory: Trajectory;
  certificate: Certificate;
  timing: Timing | null;
}

/** How far a plan is. */
export interface PlanStatus {
  id: string;
  state: "queued" | "running" | "finished" | "failed" | "cancelled";
  stage: string | null;
  done: number;
  /** 0: the stage does not count waypoints. */
  total: number;
}

export interface Repair {
  change: Record<string, unknown>;
  detail: string;
}

/** An RFC 9457 document with the data of one class of error; which, its type says. */
export interface Problem {
  type: string;
  title: string;
  status: number;
  detail: string;
  waypoint?: number;
  waypoints?: unknown[];
  /** Where the tool was to be, in the base. */
  target?: unknown;
  /** Names of two bodies that touch. */
  pair?: string[];
  /** The closest configuration, or the one at which the motion gets no further. */
  q?: number[];
  reason?: string;
  field?: string;
  errors?: { field: string; detail: string }[];
  repairs?: Repair[];
}

/** A file of points as a request, and how it was read. */
export interface PointsRead {
  request: Request;
  notes: { text: string; guessed: boolean }[];
}

/** What the user wrote: an object, of which nothing else is known. */
export type Request = Record<string, unknown>;

export function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function isNumbers(value: unknown, length?: number): value is number[] {
  return (
    Array.isArray(value) &&
    (length === undefined || value.length === length) &&
    value.every((v) => typeof v === "number" && Number.isFinite(v))
  );
}

/** The waypoints that a problem names: the one that failed, all that do, or two without a way. */
export function failedWaypoints(problem: Problem): number[] {
  const named = [problem.waypoint, ...(problem.waypoints ?? [])].map((entry) =>
    isObject(entry) ? entry["waypoint"] : entry,
  );
  return [...new Set(named.filter((entry) => typeof entry === "number"))];
}
