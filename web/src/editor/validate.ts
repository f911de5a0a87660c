/** Faults of a document against the schema, each at its place. */

import { isObject } from "../documents";
import { isOfType, type Path, type RequestSchema, type Schema } from "./schema";

export interface Fault {
  path: Path;
  text: string;
}

const MOST = 100;

export function faultsOf(schema: RequestSchema, document: unknown): Fault[] {
  const faults: Fault[] = [];
  check(schema, schema.root, document, [], faults);
  return faults.slice(0, MOST);
}

function check(all: RequestSchema, schema: unknown, value: unknown, path: Path, faults: Fault[]): void {
  if (faults.length >= MOST) return;
  const options = all.fitting(schema, value);
  if (options.length === 0) return;
  let best: Fault[] | null = null;
  for (const option of options) {
    const found: Fault[] = [];
    one(all, option, value, path, found);
    if (found.length === 0) return;
    if (best === null || found.length < best.length) best = found;
  }
  const types = new Set(options.map(nameOf));
  if (options.every((option) => !isOfType(value, option)) && types.size > 1) {
    faults.push({ path, text: `must be ${[...types].join(" or ")}` });
  } else {
    faults.push(...best!);
  }
}

function one(all: RequestSchema, schema: Schema, value: unknown, path: Path, faults: Fault[]): void {
  const say = (text: string, at: Path = path): void => void faults.push({ path: at, text });
  if (!isOfType(value, schema)) {
    say(`must be ${nameOf(schema)}`);
  } else if (typeof value === "number") {
    bounds(schema, value).forEach((text) => say(text));
  } else if (Array.isArray(value)) {
    const { minItems: least, maxItems: most } = schema;
    if (typeof least === "number" && value.length < least) say(`needs at least ${least} entries, has ${value.length}`);
    if (typeof most === "number" && value.length > most) say(`may have ${most} entries at most, has ${value.length}`);
    for (const [i, entry] of value.entries()) {
      check(all, schema["items"], entry, [...path, i], faults);
      if (faults.length >= MOST) return;
    }
  } else if (isObject(value)) {
    const properties = isObject(schema["properties"]) ? schema["properties"] : {};
    for (const name of Array.isArray(schema["required"]) ? schema["required"] : []) {
      if (!(String(name) in value)) say(`"${String(name)}" is missing`);
    }
    for (const [name, entry] of Object.entries(value)) {
      if (name in properties || isObject(schema["additionalProperties"])) {
        check(all, all.child(schema, name), entry, [...path, name], faults);
      } else if (schema["additionalProperties"] === false) {
        say(`there is no field "${name}" here; known: ${Object.keys(properties).join(", ")}`, [...path, name]);
      }
    }
  }
}

function bounds(schema: Schema, value: number): string[] {
  const { minimum, maximum, exclusiveMinimum: above, exclusiveMaximum: below } = schema;
  const said: string[] = [];
  if (typeof minimum === "number" && value < minimum) said.push(`must be at least ${minimum}`);
  if (typeof maximum === "number" && value > maximum) said.push(`must be at most ${maximum}`);
  if (typeof above === "number" && value <= above) said.push(`must be above ${above}`);
  if (typeof below === "number" && value >= below) said.push(`must be below ${below}`);
  return said;
}

function nameOf(schema: Schema): string {
  if ("const" in schema) return JSON.stringify(schema["const"]);
  if (Array.isArray(schema["enum"])) return `one of ${schema["enum"].map((v) => JSON.stringify(v)).join(", ")}`;
  const type = String(schema["type"]);
  return { object: "an object", array: "a list", integer: "a whole number", null: "null" }[type] ?? `a ${type}`;
}
