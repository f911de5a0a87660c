/** Everything the page asks of the service, and nothing else is asked. */

import type { PointsRead, Problem, Request, RobotInfo } from "./documents";
import type { Pose } from "./path/items";
import type { Series } from "./see/series";

/** What the service answers when it refuses. */
export class Refusal extends Error {
  constructor(readonly problem: Problem, readonly retryAfter: string | null) {
    super(problem.detail);
  }
}

const KEY = "ikplan-key";

/** The key that the user gave, kept until the tab is closed. */
export const accessKey = {
  get: (): string => sessionStorage.getItem(KEY) ?? "",
  set: (key: string): void => sessionStorage.setItem(KEY, key),
};

/** Asks; the answer is a success. */
export async function ask(path: string, init: RequestInit = {}): Promise<Response> {
  const headers = new Headers(init.headers);
  if (accessKey.get()) headers.set("authorization", `Bearer ${accessKey.get()}`);
  let answer: Response;
  try {
    answer = await fetch(path, { ...init, headers });
  } catch (error) {
    if (error instanceof DOMException) throw error; // aborted by the user
    throw new Refusal(own("Service not reached", `no answer from ${location.origin}`), null);
  }
  if (!answer.ok) throw new Refusal(await problemOf(answer), answer.headers.get("retry-after"));
  return answer;
}

async function problemOf(answer: Response): Promise<Problem> {
  if (answer.headers.get("content-type")?.includes("json")) return (await answer.json()) as Problem;
  return own("Request failed", `the service answered ${answer.status}`, answer.status);
}

function own(title: string, detail: string, status = 0): Problem {
  return { type: "about:blank", title, status, detail };
}

export async function fetchRobots(): Promise<RobotInfo[]> {
  return ((await (await ask("v1/robots")).json()) as { robots: RobotInfo[] }).robots;
}

export async function fetchVisual(robot: string): Promise<string> {
  return (await ask(`v1/robots/${encodeURIComponent(robot)}/visual`)).text();
}

export async function fetchMesh(address: string): Promise<ArrayBuffer> {
  return (await ask(address)).arrayBuffer();
}

/** Reads a file of points, without planning. */
export async function readPoints(file: Blob, query: Record<string, string>): Promise<PointsRead> {
  const given = Object.entries(query).filter(([, value]) => value !== "");
  const answer = await ask(`v1/points?${new URLSearchParams(given)}`, {
    method: "POST",
    headers: { "content-type": "text/csv" },
    body: file,
  });
  return (await answer.json()) as PointsRead;
}

/** Joint values nearest to `start` with which the tool has a pose in the base, clear of the scene. */
export async function solvePose(
  robot: string, request: Request, pose: Pose, start: number[], verdict: boolean,
): Promise<number[]> {
  const { tool, scene, fixed_joints: fixed } = request;
  const asked = {
    robot, start, verdict, tool, scene: scene ?? {}, fixed_joints: fixed, budget_s: 3,
    position: pose.position, ...(pose.quaternion === null ? {} : { quaternion_xyzw: pose.quaternion }),
  };
  const answer = await ask("v1/ik", {
    method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(asked),
  });
  return ((await answer.json()) as { q: number[] }).q;
}

/** The service's own description, with the schema of every document. */
export async function fetchOpenapi(): Promise<Record<string, unknown>> {
  return (await (await ask("openapi.json")).json()) as Record<string, unknown>;
}

/** A format of plans. */
export interface FormatInfo {
  name: string;
  title: string;
  suffix: string;
  media_type: string;
}

/** The formats that a robot's plans can be had in. */
export async function fetchFormats(robot: string): Promise<FormatInfo[]> {
  const answer = await ask(`v1/robots/${encodeURIComponent(robot)}/formats`);
  return ((await answer.json()) as { formats: FormatInfo[] }).formats;
}

/** A plan of the service in a format. */
export async function fetchPlanAs(id: string, mediaType: string): Promise<Blob> {
  return (await ask(`v1/plans/${encodeURIComponent(id)}`, { headers: { accept: mediaType } })).blob();
}

/** Gives the service a robot; it is known by the name in the answer from then on. */
export async function uploadRobot(document: string, type: string): Promise<RobotInfo> {
  const answer = await ask("v1/robots", { method: "POST", headers: { "content-type": type }, body: document });
  return (await answer.json()) as RobotInfo;
}

/** Measures of the plan for a request, which the service has made before. */
export async function fetchSeries(request: Request): Promise<Series> {
  const answer = await ask("v1/series", {
    method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(request),
  });
  return (await answer.json()) as Series;
}

/** A plan or job in the list of the service. */
export interface PlanSummary {
  id: string;
  outcome: "finished" | "failed" | "unfinished";
  kind: "plan" | "time";
  robot: string | null;
  time: string;
  problem: string | null;
}

/** Plans that the service keeps, the newest first; an empty outcome: all. */
export async function fetchPlans(outcome: string, after: string | null): Promise<{ plans: PlanSummary[]; next: string | null }> {
  const query = new URLSearchParams({ limit: "50" });
  if (outcome !== "") query.set("outcome", outcome);
  if (after !== null) query.set("after", after);
  return (await (await ask(`v1/plans?${query}`)).json()) as { plans: PlanSummary[]; next: string | null };
}

/** A plan that the service keeps, as text. */
export async function fetchPlan(id: string): Promise<string> {
  return (await ask(`v1/plans/${encodeURIComponent(id)}`)).text();
}
