/** What can be done to the list of a path; each takes a document and gives a new one. */

import type { Request } from "../documents";
import { itemsOf, withItems, type Item, type Pose } from "./items";

const freshGroup = (items: Item[]): number => Math.max(0, ...items.map(({ group }) => group)) + 1;

/** Puts a pose after an item; -1: before all of them. */
export function insertPose(request: Request, after: number, pose: Pose): Request {
  const items = itemsOf(request);
  const near = items[after] ?? items[after + 1];
  const settable = near !== undefined && ["line", "spline", "joint", "move"].includes(near.type);
  const type = settable ? near.type : "line";
  const group = settable && type === "spline" ? near.group : freshGroup(items);
  items.splice(after + 1, 0, { type, pose, rest: {}, group });
  return withItems(request, items);
}

export function duplicate(request: Request, index: number): Request {
  const items = itemsOf(request);
  const item = items[index]!;
  const type = item.type === "begin" ? "line" : item.type;
  items.splice(index + 1, 0, { ...structuredClone(item), type });
  return withItems(request, items);
}

export function remove(request: Request, index: number): Request {
  const items = itemsOf(request);
  const [gone] = items.splice(index, 1);
  // What a spline says stands at its first pose.
  const next = items[index];
  if (gone?.type === "spline" && next?.type === "spline" && next.group === gone.group) {
    next.rest = { ...gone.rest, ...next.rest };
  }
  return withItems(request, items);
}

/** Changes places with a neighbour. */
export function swap(request: Request, index: number, other: number): Request {
  const items = itemsOf(request);
  const [a, b] = [items[index], items[other]];
  if (a === undefined || b === undefined) return request;
  if (a.type === "begin" || b.type === "begin") [a.pose, b.pose] = [b.pose, a.pose];
  else [items[index], items[other]] = [b, a];
  return withItems(request, items);
}

export function setPose(request: Request, index: number, pose: Pose): Request {
  const items = itemsOf(request);
  items[index]!.pose = pose;
  const { rest } = items[index]!;
  for (const other of ["q", "any"]) delete rest[other];
  return withItems(request, items);
}

export function setType(request: Request, index: number, type: string): Request {
  const items = itemsOf(request);
  const item = items[index]!;
  const before = items[index - 1];
  const joins = type === "spline" && before?.type === "spline";
  items[index] = {
    type,
    pose: item.pose,
    rest: Object.fromEntries(Object.entries(item.rest).filter(([field]) =>
      field === "limits" || (field === "blend" && type !== "move"))),
    group: joins ? before.group : freshGroup(items),
  };
  return withItems(request, items);
}

/** Sets a field of the segment that an item is part of; undefined removes it. */
export function setField(request: Request, index: number, field: string, value: unknown): Request {
  const items = itemsOf(request);
  let first = index;
  const { type, group } = items[index]!;
  while (type === "spline" && items[first - 1]?.type === "spline" && items[first - 1]!.group === group) first -= 1;
  const { rest } = items[first]!;
  if (value === undefined) delete rest[field];
  else rest[field] = value;
  return withItems(request, items);
}

/** What the segment of an item says about a field. */
export function fieldOf(items: Item[], index: number, field: string): unknown {
  let first = index;
  const { type, group } = items[index]!;
  while (type === "spline" && items[first - 1]?.type === "spline" && items[first - 1]!.group === group) first -= 1;
  return items[first]!.rest[field];
}
