/** What planning has given: a plan or a refusal, whether it is still that of the document. */

import type { Plan, Problem, Request, RobotInfo } from "./documents";
import type { Motion } from "./playback";

export interface Planned {
  request: Request;
  plan: Plan;
  /** The bytes it came in. */
  text: string;
  motion: Motion;
  robot: RobotInfo;
}

export interface Refused {
  problem: Problem;
  retryAfter: string | null;
  request: Request;
}

export class Results {
  planned: Planned | null = null;
  refused: Refused | null = null;
  /** The plan to compare with. */
  kept: Planned | null = null;

  forget(): void {
    this.planned = null;
    this.refused = null;
  }

  /** Whether there is a result that is not of this document; null: a text that is none. */
  stale(request: Request | null): boolean {
    const of = this.planned?.request ?? this.refused?.request;
    return of !== undefined && (request === null || !same(of, request));
  }
}

/** Whether two documents say the same, in whatever order. */
export function same(one: unknown, other: unknown): boolean {
  if (one === other) return true;
  if (typeof one !== "object" || typeof other !== "object" || one === null || other === null) return false;
  if (Array.isArray(one) !== Array.isArray(other)) return false;
  const [a, b] = [one as Record<string, unknown>, other as Record<string, unknown>];
  const names = Object.keys(a);
  return names.length === Object.keys(b).length && names.every((name) => name in b && same(a[name], b[name]));
}
