/** What a plan does over time, quantity by quantity, each with its limits. */

import type { Vector3 } from "three";

import { isNumbers, isObject, type Request, type RobotInfo } from "../documents";
import { limitsOf, type Range } from "../limits";
import type { Planned } from "../results";
import type { JointUnit } from "../units";

/** Unit of a signal, per second for each order. */
export interface Unit {
  base: JointUnit | "Nm" | "N";
  order: 0 | 1 | 2 | 3;
}

export interface Signal {
  name: string;
  unit: Unit;
  /** At the samples; null: not known there. */
  values: (number | null)[];
  limit: Range;
}

export interface Quantity {
  key: string;
  title: string;
  signals: Signal[];
}

const RATES = [
  { key: "q", title: "Position", order: 0 },
  { key: "dq", title: "Velocity", order: 1 },
  { key: "ddq", title: "Acceleration", order: 2 },
] as const;
const NONE: Range = { lower: null, upper: null };
/** Step of the differences that give the speed of the tool [s]. */
const STEP_S = 1e-4;

/** Where the tool is and how it is turned at several configurations. */
export interface Kinematics {
  positions(rows: number[][]): Vector3[];
  turns(rows: number[][]): number[][];
}

export function quantitiesOf(planned: Planned, arm: Kinematics): Quantity[] {
  const { plan, robot, request } = planned;
  const { time, q, dq, ddq } = plan.trajectory;
  const limits = limitsOf(robot, request);
  const jerk = jerkLimits(robot, request);
  const joints = plan.joint_names;
  const rows = { q, dq, ddq };
  const found: Quantity[] = RATES.map(({ key, title, order }) => ({
    key, title,
    signals: joints.map((name, j) => ({
      name, unit: { base: plan.joint_units[j]!, order }, values: rows[key].map((row) => row[j]!),
      limit: limits[j]![order]!,
    })),
  }));
  found.push({
    key: "jerk", title: "Jerk",
    signals: joints.map((name, j) => ({
      name, unit: { base: plan.joint_units[j]!, order: 3 }, limit: jerk[j]!,
      values: differences(time, ddq.map((row) => row[j]!)),
    })),
  });
  found.push({ key: "tool", title: "Tool", signals: toolSignals(planned, arm) });
  return found;
}

/** Accelerations are linear between samples: their slope there; at a sample, that to the next. */
function differences(time: number[], values: number[]): number[] {
  const slopes = values.slice(1).map((value, k) => (value - values[k]!) / (time[k + 1]! - time[k]!));
  return [...slopes, slopes.at(-1) ?? 0];
}

function jerkLimits(robot: RobotInfo, request: Request): Range[] {
  const asked = isObject(request["limits"]) ? request["limits"]["jerk"] : undefined;
  const known = asked === false ? null : robot.controller?.jerk ?? null;
  return robot.joints.map((_, j) => {
    const own = known?.[j] ?? null;
    const wanted = typeof asked === "number" ? asked : isNumbers(asked) ? asked[j] ?? null : null;
    const upper = own === null || wanted === null ? own ?? wanted : Math.min(own, wanted);
    return upper === null ? NONE : { lower: -upper, upper };
  });
}

function toolSignals({ plan, request }: Planned, arm: Kinematics): Signal[] {
  const { q, dq } = plan.trajectory;
  const at = (sign: number): number[][] => q.map((row, k) => row.map((value, j) => value + sign * STEP_S * dq[k]![j]!));
  const [ahead, behind] = [at(1), at(-1)];
  const [to, from] = [arm.positions(ahead), arm.positions(behind)];
  const [toTurn, fromTurn] = [arm.turns(ahead), arm.turns(behind)];
  const limits = isObject(request["limits"]) ? request["limits"] : {};
  const asked = limits["tool_speed"];
  const most = (name: string): Range => {
    const value = isObject(asked) ? asked[name] : name === "linear" ? asked : undefined;
    return typeof value === "number" ? { lower: null, upper: value } : NONE;
  };
  return [
    {
      name: "Speed", unit: { base: "m", order: 1 }, limit: most("linear"),
      values: to.map((p, k) => p.distanceTo(from[k]!) / (2 * STEP_S)),
    },
    {
      name: "Turning", unit: { base: "rad", order: 1 }, limit: most("angular"),
      values: toTurn.map((turn, k) => angleBetween(turn, fromTurn[k]!) / (2 * STEP_S)),
    },
  ];
}

/** The angle between two unit quaternions, exact also for small ones [rad]. */
function angleBetween(a: number[], b: number[]): number {
  const sign = a.reduce((sum, c, i) => sum + c * b[i]!, 0) < 0 ? -1 : 1;
  const chord = Math.hypot(...a.map((c, i) => c - sign * b[i]!));
  return 4 * Math.asin(Math.min(chord / 2, 1));
}

/** How much of its limit a signal uses at a sample; null: it has none. */
export function shareOf({ values, limit }: Signal, k: number): number | null {
  const value = values[k];
  if (value === null || value === undefined) return null;
  const bound = value < 0 ? limit.lower : limit.upper;
  return bound === null || bound === 0 ? null : value / bound;
}

export interface Binding {
  /** Which limit, such as "elbow velocity"; empty: none is near. */
  name: string;
  share: number;
}

/** From which share on a limit counts as binding. */
const BINDS = 0.98;

/** What is driven at its limits; positions, deviation and clearance are no rates, and bind nothing. */
const RATED = ["dq", "ddq", "jerk", "tool", "torque"];

/** The limit that is used most at each sample. */
export function bindingOf(quantities: Quantity[], samples: number): Binding[] {
  const rates = quantities.filter(({ key }) => RATED.includes(key));
  return Array.from({ length: samples }, (_, k) => {
    let best: Binding = { name: "", share: 0 };
    for (const { title, signals } of rates) {
      for (const signal of signals) {
        const share = shareOf(signal, k) ?? 0;
        if (share > best.share) best = { name: title === "Tool" ? `tool ${signal.name.toLowerCase()}` : `${signal.name} ${title.toLowerCase()}`, share };
      }
    }
    return best.share < BINDS ? { name: "", share: best.share } : best;
  });
}
