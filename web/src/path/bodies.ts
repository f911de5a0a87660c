/** The bodies of a document: obstacles, and parts that the tool carries. */

import { isObject, type Request } from "../documents";

export type Body = Record<string, unknown>;
export type BodyList = "obstacles" | "attached";

export const SHAPES = {
  box: { type: "box", size: [0.2, 0.2, 0.2] },
  cylinder: { type: "cylinder", radius: 0.08, length: 0.3 },
  sphere: { type: "sphere", radius: 0.1 },
} as const;
export type ShapeName = keyof typeof SHAPES;

const sceneOf = (request: Request): Record<string, unknown> =>
  (isObject(request["scene"]) ? request["scene"] : {});

export function bodiesOf(request: Request, list: BodyList): Body[] {
  const found = sceneOf(request)[list];
  return Array.isArray(found) ? found.filter(isObject) : [];
}

/** The document with another list; a scene that is named by an id is not changed. */
export function withBodies(request: Request, list: BodyList, bodies: Body[]): Request {
  return { ...request, scene: { ...sceneOf(request), [list]: bodies } };
}

export function addBody(request: Request, list: BodyList, body: Body): Request {
  const taken = new Set([...bodiesOf(request, "obstacles"), ...bodiesOf(request, "attached")].map((b) => b["name"]));
  const wanted = String(body["name"]);
  let name = wanted;
  for (let n = 2; taken.has(name); n += 1) name = `${wanted} ${n}`;
  return withBodies(request, list, [...bodiesOf(request, list), { ...body, name }]);
}

export function changeBody(request: Request, list: BodyList, index: number, change: Body): Request {
  return withBodies(request, list, bodiesOf(request, list).map((body, i) =>
    (i === index ? { ...body, ...change } : body)));
}

export function removeBody(request: Request, list: BodyList, index: number): Request {
  return withBodies(request, list, bodiesOf(request, list).filter((_, i) => i !== index));
}

/** Sets or removes a field of the scene. */
export function setSceneField(request: Request, field: string, value: unknown): Request {
  return { ...request, scene: { ...sceneOf(request), [field]: value } };
}

export const sceneField = (request: Request, field: string): unknown => sceneOf(request)[field];
