/** The document that all panels share: read once, changed by anyone, undone and redone, kept. */

import { isObject, type Request } from "../documents";
import { written } from "../merge";
import { keptDocument, keepDocument } from "./kept";

/** Who changed the document: the text editor, or anything else of the page. */
export type Origin = "editor" | "page";

interface Step {
  text: string;
  /** Changes with the same key are one step; null: a step of its own. */
  key: string | null;
}

const MOST_STEPS = 200;
/** Typing without a pause of this length is one step [ms]. */
const PAUSE_MS = 1000;

export class DocumentStore {
  text = "";
  /** The document; null where the text is not an object in JSON. */
  request: Request | null = null;
  /** Why there is no document. */
  fault = "";
  private past: Step[] = [];
  private future: Step[] = [];
  private changedAt = 0;
  private readonly listeners: ((origin: Origin) => void)[] = [];

  onChange(listener: (origin: Origin) => void): void {
    this.listeners.push(listener);
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** Takes up the document of the last visit; says whether there was one. */
  restore(): boolean {
    const kept = keptDocument();
    if (kept === null) return false;
    this.past = kept.past.map((text) => ({ text, key: null }));
    this.future = kept.future.map((text) => ({ text, key: null }));
    this.put(kept.text, "page");
    return true;
  }

  /** Writes the text; `key` joins changes that belong together, such as those of one drag. */
  write(text: string, origin: Origin = "page", key: string | null = null): void {
    if (text === this.text) return;
    const last = this.past.at(-1);
    const joined = key !== null && last !== undefined && last.key === key
      && (key !== "typing" || performance.now() - this.changedAt < PAUSE_MS);
    if (!joined && this.text !== "") this.past.push({ text: this.text, key });
    if (this.past.length > MOST_STEPS) this.past.shift();
    this.future = [];
    this.changedAt = performance.now();
    this.put(text, origin);
  }

  /** Replaces the document. */
  set(request: Request, key: string | null = null): void {
    const { robot, ...rest } = request;
    this.write(written({ robot, ...rest }), "page", key);
  }

  /** Changes the document; nothing happens while the text is not one. */
  edit(change: (request: Request) => Request, key: string | null = null): void {
    if (this.request !== null) this.set(change(structuredClone(this.request)), key);
  }

  undo(): void {
    const step = this.past.pop();
    if (step === undefined) return;
    this.future.push({ text: this.text, key: null });
    this.put(step.text, "page");
  }

  redo(): void {
    const step = this.future.pop();
    if (step === undefined) return;
    this.past.push({ text: this.text, key: null });
    this.put(step.text, "page");
  }

  private put(text: string, origin: Origin): void {
    this.text = text;
    this.read();
    keepDocument({ text, past: this.past.map((s) => s.text), future: this.future.map((s) => s.text) });
    for (const listener of this.listeners) listener(origin);
  }

  private read(): void {
    this.request = null;
    try {
      const value: unknown = JSON.parse(this.text);
      if (isObject(value)) this.request = value;
      this.fault = isObject(value) ? "" : "The document must be a JSON object.";
    } catch (error) {
      this.fault = `Not JSON: ${(error as Error).message}`;
    }
  }
}
