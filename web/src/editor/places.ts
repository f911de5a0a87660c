/** Places in the text of a document: from a cursor to a path, and from a path to a stretch of text. */

import { syntaxTree } from "@codemirror/language";
import type { EditorState } from "@codemirror/state";

import type { Path } from "./schema";

type Node = ReturnType<ReturnType<typeof syntaxTree>["resolveInner"]>;

const VALUES = new Set(["Object", "Array", "String", "Number", "True", "False", "Null"]);

/** The path to the object, list or value that holds a node. */
export function pathTo(state: EditorState, node: Node): Path {
  const path: Path = [];
  for (let at: Node | null = node; at !== null; at = at.parent) {
    const parent: Node | null = at.parent;
    if (at.name === "Property") path.unshift(nameOf(state, at));
    else if (parent?.name === "Array" && VALUES.has(at.name)) path.unshift(members(parent).findIndex((n) => n.from === at!.from));
  }
  return path;
}

/** The stretch of text of a place; of what is missing, that of what it is missing in. */
export function rangeOf(state: EditorState, path: Path): { from: number; to: number } {
  let at: Node | null = syntaxTree(state).topNode.firstChild;
  let name: Node | null = null;
  for (const step of path) {
    if (at === null) break;
    let next: Node | null = null;
    if (typeof step === "number" && at.name === "Array") {
      next = members(at)[step] ?? null;
    } else if (at.name === "Object") {
      const property: Node | undefined = at.getChildren("Property").find((p) => nameOf(state, p) === step);
      name = property?.getChild("PropertyName") ?? null;
      next = property?.lastChild ?? null;
    }
    if (next === null) break;
    at = next;
  }
  if (at === null) return { from: 0, to: 0 };
  // A long object is marked by its name.
  const short = state.doc.lineAt(at.from).number === state.doc.lineAt(at.to).number;
  const marked = short || name === null ? at : name;
  return { from: marked.from, to: short || name !== null ? marked.to : Math.min(at.to, at.from + 1) };
}

function nameOf(state: EditorState, property: Node): string {
  const name = property.getChild("PropertyName");
  return name === null ? "" : state.sliceDoc(name.from + 1, name.to - 1);
}

function members(array: Node): Node[] {
  const found: Node[] = [];
  for (let at = array.firstChild; at !== null; at = at.nextSibling) if (VALUES.has(at.name)) found.push(at);
  return found;
}

/** A field as the service names it, such as `path.segments[2].to`, as a path. */
export function pathOfField(field: string): Path {
  return [...field.matchAll(/\[(\d+)\]|([^.[\]]+)/g)].map(([, index, name]) =>
    (index === undefined ? name! : Number(index)));
}
