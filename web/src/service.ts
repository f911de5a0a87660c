/** Everything the page asks of the service, and nothing else is asked. */

import type { PointsRead, Problem, RobotInfo } from "./documents";

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
