/** The JSON schema of requests, as the service gives it in its OpenAPI description. */

import { isObject } from "../documents";

export type Schema = Record<string, unknown>;
export type Path = (string | number)[];

export class RequestSchema {
  private readonly parts: Record<string, unknown>;
  readonly root: Schema;

  constructor(openapi: Record<string, unknown>, name = "PlanRequest") {
    const components = isObject(openapi["components"]) ? openapi["components"] : {};
    this.parts = isObject(components["schemas"]) ? components["schemas"] : {};
    this.root = { $ref: `#/components/schemas/${name}` };
  }

  /** The plain alternatives that a schema stands for; references are followed. */
  alternatives(schema: unknown): Schema[] {
    if (!isObject(schema)) return [];
    if (typeof schema["$ref"] === "string") {
      const { $ref, ...own } = schema;
      const name = schema["$ref"].slice(schema["$ref"].lastIndexOf("/") + 1);
      return this.alternatives(this.parts[name]).map((found) => ({ ...found, ...own }));
    }
    const choices = schema["anyOf"] ?? schema["oneOf"];
    if (Array.isArray(choices)) {
      const { description } = schema;
      return choices.flatMap((choice) => this.alternatives(choice)).map((found) => ({ description, ...found }));
    }
    return [schema];
  }

  /** The alternatives at a place of a document. */
  at(document: unknown, path: Path): Schema[] {
    let found = this.fitting(this.root, document);
    let value = document;
    for (const step of path) {
      value = isObject(value) || Array.isArray(value) ? (value as Record<string | number, unknown>)[step] : undefined;
      found = found.flatMap((schema) => this.fitting(this.child(schema, step), value));
    }
    return found;
  }

  /** What a schema says of a member. */
  child(schema: Schema, step: string | number): unknown {
    if (typeof step === "number") return schema["items"];
    const properties = isObject(schema["properties"]) ? schema["properties"] : {};
    return properties[step] ?? schema["additionalProperties"];
  }

  /** The alternatives that a value may be meant as: those of its type and its discriminator. */
  fitting(schema: unknown, value: unknown): Schema[] {
    const all = this.alternatives(schema);
    if (value === undefined) return all;
    const typed = all.filter((one) => isOfType(value, one));
    if (!isObject(value)) return typed.length > 0 ? typed : all;
    const told = typed.filter((one) => tagFits(one, value));
    return told.length > 0 ? told : typed.length > 0 ? typed : all;
  }
}

/** Whether a value has the type, and the constant, that a schema asks for. */
export function isOfType(value: unknown, schema: Schema): boolean {
  if ("const" in schema) return schema["const"] === value;
  if (Array.isArray(schema["enum"])) return schema["enum"].includes(value);
  switch (schema["type"]) {
    case "object": return isObject(value);
    case "array": return Array.isArray(value);
    case "string": return typeof value === "string";
    case "boolean": return typeof value === "boolean";
    case "number": return typeof value === "number";
    case "integer": return Number.isInteger(value);
    case "null": return value === null;
    default: return true;
  }
}

/** Whether constants such as the type of a segment are those of the schema. */
function tagFits(schema: Schema, value: Record<string, unknown>): boolean {
  const properties = isObject(schema["properties"]) ? schema["properties"] : {};
  return Object.entries(properties).every(([name, property]) =>
    !isObject(property) || !("const" in property) || !(name in value) || property["const"] === value[name]);
}
