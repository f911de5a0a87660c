/** A plan as a job of the service: asked for, watched while it is made, given up. */

import type { Plan, PlanStatus } from "./documents";
import { Refusal, ask } from "./service";

const POLL_MS = 1000;

export interface Made {
  plan: Plan;
  /** The bytes it came in. */
  text: string;
}

/** Lets the service make a plan, and tells how far it is; once the signal is aborted, it stops. */
export async function makePlan(
  request: string, signal: AbortSignal, tell: (status: PlanStatus) => void,
): Promise<Made> {
  const headers = { "content-type": "application/json", prefer: "respond-async" };
  const accepted = await ask("v1/plans", { method: "POST", body: request, headers, signal });
  if (accepted.status === 200) return madeOf(accepted); // it was there already
  const status = (await accepted.json()) as PlanStatus;
  const place = `v1/plans/${encodeURIComponent(status.id)}`;
  // What nobody looks at any more is not worth a worker; the page may be gone by the answer.
  const giveUp = (): void => void ask(place, { method: "DELETE", keepalive: true }).catch(() => undefined);
  signal.addEventListener("abort", giveUp);
  addEventListener("pagehide", giveUp);
  try {
    tell(status);
    for (;;) {
      await watch(`${place}/events`, signal, tell);
      const found = await ask(place, { signal, cache: "no-store" });
      if (found.status === 200) return await madeOf(found);
      tell((await found.json()) as PlanStatus);
      await pause(POLL_MS, signal);
    }
  } finally {
    signal.removeEventListener("abort", giveUp);
    removeEventListener("pagehide", giveUp);
  }
}

async function madeOf(answer: Response): Promise<Made> {
  const text = await answer.text();
  return { plan: JSON.parse(text) as Plan, text };
}

/** Hears the service's events until they end; where they do not get through, asking has to do. */
async function watch(
  address: string, signal: AbortSignal, tell: (status: PlanStatus) => void,
): Promise<void> {
  try {
    const answer = await ask(address, { signal, headers: { accept: "text/event-stream" } });
    if (answer.body === null) return;
    const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    let text = "";
    for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
      const events = (text + piece.value).split(/\r?\n\r?\n/);
      text = events.pop() ?? "";
      for (const event of events) hear(event, tell);
    }
  } catch (error) {
    signal.throwIfAborted();
    if (!(error instanceof Refusal || error instanceof TypeError)) throw error;
  }
}

function hear(event: string, tell: (status: PlanStatus) => void): void {
  const data = event.split(/\r?\n/).filter((line) => line.startsWith("data:"))
    .map((line) => line.slice(5)).join("\n");
  if (!/^event: ?progress$/m.test(event) || data === "") return;
  tell(JSON.parse(data) as PlanStatus);
}

function pause(milliseconds: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const stop = (): void => { clearTimeout(waiting); reject(signal.reason as Error); };
    const waiting = setTimeout(() => { signal.removeEventListener("abort", stop); resolve(); }, milliseconds);
    signal.addEventListener("abort", stop, { once: true });
  });
}
