/** Changing documents, and writing them so that people can read them. */

import { isObject, type Request } from "./documents";

/** A document with the fields of a change put in, object by object. */
export function merged(document: Request, change: Record<string, unknown>): Request {
  const result: Request = { ...document };
  for (const [key, value] of Object.entries(change)) {
    const old = result[key];
    result[key] = isObject(value) && isObject(old) ? merged(old, value) : value;
  }
  return result;
}

const WIDTH = 150;

/** JSON in which whatever fits is on one line. */
export function written(value: unknown, indent = ""): string {
  const short = inline(value);
  if (indent.length + short.length <= WIDTH && (indent !== "" || !isObject(value))) return short;
  const deeper = `${indent}  `;
  if (Array.isArray(value)) {
    return `[\n${value.map((v) => deeper + written(v, deeper)).join(",\n")}\n${indent}]`;
  }
  if (isObject(value)) {
    const rows = Object.entries(value).map(
      ([k, v]) => `${deeper}${JSON.stringify(k)}: ${written(v, deeper)}`,
    );
    return `{\n${rows.join(",\n")}\n${indent}}`;
  }
  return short;
}

function inline(value: unknown): string {
  if (Array.isArray(value)) return `[${value.map(inline).join(", ")}]`;
  if (isObject(value)) {
    const rows = Object.entries(value).map(([k, v]) => `${JSON.stringify(k)}: ${inline(v)}`);
    return `{${rows.join(", ")}}`;
  }
  return JSON.stringify(value);
}
