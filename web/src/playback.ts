/** A plan at any time: exact at the samples, cubic between them, as `plan.at` of the library. */

import type { Trajectory } from "./documents";

export interface Moment {
  q: number[];
  dq: number[];
  ddq: number[];
}

export class Motion {
  readonly duration: number;

  constructor(readonly samples: Trajectory) {
    this.duration = samples.time.at(-1) ?? 0;
  }

  /** Index of the last sample at or before a time. */
  index(t: number): number {
    const time = this.samples.time;
    let low = 0;
    let high = time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (time[middle]! <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  at(t: number): Moment {
    const { time, q, dq, ddq } = this.samples;
    const clipped = Math.min(Math.max(t, 0), this.duration);
    const k = this.index(clipped);
    const from = clipped - time[k]!;
    if (from === 0 || k + 1 >= time.length) return { q: q[k]!, dq: dq[k]!, ddq: ddq[k]! };
    const length = time[k + 1]! - time[k]!;
    const x = from / length;
    const r = 1 - x;
    const each = (f: (j: number) => number): number[] => q[k]!.map((_, j) => f(j));
    return {
      q: each((j) => q[k]![j]! * r * r * (1 + 2 * x) + q[k + 1]![j]! * x * x * (1 + 2 * r)
        + length * x * r * (dq[k]![j]! * r - dq[k + 1]![j]! * x)),
      dq: each((j) => dq[k]![j]! * r * (1 - 3 * x) + dq[k + 1]![j]! * x * (3 * x - 2)
        + (6 * x * r * (q[k + 1]![j]! - q[k]![j]!)) / length),
      ddq: each((j) => r * ddq[k]![j]! + x * ddq[k + 1]![j]!),
    };
  }
}
