/** What the service measures of a plan over time: torques, deviation, clearance. */

import type { Planned } from "../results";
import type { Quantity } from "./signals";

/** The answer of `POST /v1/series`, as far as the page reads it. */
export interface Series {
  torque: number[][] | null;
  torque_limit: (number | null)[];
  deviation: (number | null)[];
  deviation_limit: number;
  turn: (number | null)[];
  turn_limit: number;
  clearance_time: number[];
  clearance: (number | null)[];
  clearance_limit: number;
}

const known = (values: (number | null)[]): boolean => values.some((value) => value !== null);

export function seriesQuantities({ plan }: Planned, series: Series): Quantity[] {
  const found: Quantity[] = [];
  const { torque } = series;
  if (torque !== null) {
    found.push({
      key: "torque", title: "Torque",
      signals: plan.joint_names.map((name, j) => {
        const upper = series.torque_limit[j] ?? null;
        return {
          name, unit: { base: plan.joint_units[j] === "m" ? "N" : "Nm", order: 0 },
          values: torque.map((row) => row[j]!), limit: { lower: upper === null ? null : -upper, upper },
        };
      }),
    });
  }
  if (known(series.deviation)) {
    found.push({
      key: "deviation", title: "Deviation",
      signals: [
        { name: "Position", unit: { base: "m", order: 0 }, values: series.deviation, limit: { lower: null, upper: series.deviation_limit } },
        { name: "Orientation", unit: { base: "rad", order: 0 }, values: series.turn, limit: { lower: null, upper: series.turn_limit } },
      ].filter(({ values }) => known(values)) as Quantity["signals"],
    });
  }
  if (known(series.clearance)) {
    found.push({
      key: "clearance", title: "Clearance",
      signals: [{
        name: "Nearest bodies", unit: { base: "m", order: 0 }, limit: { lower: series.clearance_limit, upper: null },
        values: atSamples(plan.trajectory.time, series.clearance_time, series.clearance),
      }],
    });
  }
  return found;
}

/** Values at other times, by straight lines between those that are known. */
function atSamples(time: number[], at: number[], values: (number | null)[]): (number | null)[] {
  let k = 0;
  return time.map((t) => {
    while (k + 2 < at.length && at[k + 1]! < t) k += 1;
    const [a, b] = [values[k] ?? null, values[k + 1] ?? null];
    if (a === null || b === null || b === undefined) return a;
    const share = (t - at[k]!) / (at[k + 1]! - at[k]!);
    return a + (b - a) * Math.min(Math.max(share, 0), 1);
  });
}
