/** Completion of names and values from the schema. */

import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import { syntaxTree } from "@codemirror/language";

import { isObject } from "../documents";
import { pathTo } from "./places";
import type { RequestSchema, Schema } from "./schema";

/** `document` is the last that could be read: while one types, the text is none. */
export function completer(
  schema: () => RequestSchema | null, document: () => unknown, robots: () => string[],
): (context: CompletionContext) => CompletionResult | null {
  return (context) => {
    const all = schema();
    if (all === null) return null;
    const { state, pos } = context;
    const node = syntaxTree(state).resolveInner(pos, -1);
    const word = context.matchBefore(/"?[\w-]*/);
    const from = word?.from ?? pos;
    if (!context.explicit && (word === null || word.from === word.to)) return null;
    const before = state.sliceDoc(Math.max(0, from - 200), from).trimEnd();
    const valued = before.endsWith(":") || (before.endsWith("[") || node.parent?.name === "Array");
    const path = pathTo(state, node);
    if (valued) {
      const schemas = all.at(document(), path);
      const known = path.length === 1 && path[0] === "robot" ? robots().map((name) => text(JSON.stringify(name))) : [];
      return result(from, [...known, ...schemas.flatMap(values)]);
    }
    const holder = node.name === "Object" ? path : path.slice(0, -1);
    return result(from, all.at(document(), holder).flatMap((one) => names(all, one)));
  };
}

function result(from: number, options: Completion[]): CompletionResult | null {
  const unique = [...new Map(options.map((option) => [option.label, option])).values()];
  return unique.length === 0 ? null : { from, options: unique, validFor: /^"?[\w-]*"?$/ };
}

const text = (label: string, info?: unknown): Completion =>
  ({ label, type: "enum", ...(typeof info === "string" ? { info } : {}) });

/** Values that a schema lists. */
function values(schema: Schema): Completion[] {
  if ("const" in schema) return [text(JSON.stringify(schema["const"]), schema["description"])];
  if (Array.isArray(schema["enum"])) return schema["enum"].map((v) => text(JSON.stringify(v), schema["description"]));
  if (schema["type"] === "boolean") return [text("true"), text("false")];
  if (schema["type"] === "null") return [text("null")];
  return [];
}

/** Fields of an object, each with its first value. */
function names(all: RequestSchema, schema: Schema): Completion[] {
  const properties = isObject(schema["properties"]) ? schema["properties"] : {};
  return Object.entries(properties).map(([name, property]) => {
    const described = isObject(property) ? property["description"] : undefined;
    return {
      label: JSON.stringify(name), apply: `${JSON.stringify(name)}: ${opening(all, property)}`, type: "property",
      ...(typeof described === "string" ? { info: described } : {}),
    };
  });
}

function opening(all: RequestSchema, property: unknown): string {
  const [first] = all.alternatives(property);
  if (first === undefined) return "";
  if ("const" in first) return JSON.stringify(first["const"]);
  return { object: "{}", array: "[]", string: '""' }[String(first["type"])] ?? "";
}
