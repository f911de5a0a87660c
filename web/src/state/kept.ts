/** What the browser keeps of the user's work over a reload. */

import { isObject } from "../documents";

export interface Kept {
  text: string;
  past: string[];
  future: string[];
}

const KEY = "ikplan-document";
/** How much of the steps is kept, in characters: the browser has a few megabytes. */
const MOST = 1_000_000;
const DELAY_MS = 150;

let waiting: Kept | null = null;
let timer = 0;

/** The document of the last visit; null: there is none, or it cannot be read. */
export function keptDocument(): Kept | null {
  try {
    const value: unknown = JSON.parse(localStorage.getItem(KEY) ?? "null");
    if (!isObject(value) || typeof value["text"] !== "string") return null;
    return { text: value["text"], past: texts(value["past"]), future: texts(value["future"]) };
  } catch (error) {
    // A browser may keep nothing, or hold what another version wrote.
    if (error instanceof SyntaxError || error instanceof DOMException) return null;
    throw error;
  }
}

/** Keeps a document soon, and at the latest when the page is left. */
export function keepDocument(kept: Kept): void {
  waiting = kept;
  clearTimeout(timer);
  timer = window.setTimeout(flush, DELAY_MS);
}

function flush(): void {
  if (waiting === null) return;
  const { text, past, future } = waiting;
  waiting = null;
  try {
    localStorage.setItem(KEY, JSON.stringify({ text, past: newest(past), future: newest(future) }));
  } catch (error) {
    // Full or switched off: the work goes on, only a reload loses it.
    if (!(error instanceof DOMException)) throw error;
  }
}

function newest(steps: string[]): string[] {
  let room = MOST;
  let first = steps.length;
  while (first > 0 && (room -= steps[first - 1]!.length) >= 0) first -= 1;
  return steps.slice(first);
}

const texts = (value: unknown): string[] =>
  Array.isArray(value) ? value.filter((entry) => typeof entry === "string") : [];

addEventListener("pagehide", flush);
