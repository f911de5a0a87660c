/** A path as a flat list of items, one a pose or segment, and written back as a path. */

import { isNumbers, isObject, type Request } from "../documents";

export interface Pose {
  position: number[];
  /** null: any orientation. */
  quaternion: number[] | null;
}

export interface Item {
  /** "begin", or the type of a segment; of waypoints, how they are joined. */
  type: string;
  /** The pose at its end; null: the document gives it in another way. */
  pose: Pose | null;
  /** What else the segment says; of a spline, what its first pose says. */
  rest: Record<string, unknown>;
  /** Neighbours with the same number are poses of one spline. */
  group: number;
}

/** Types whose segment ends at a pose that can be given by hand. */
export const POSE_TYPES = ["line", "spline", "joint", "move"] as const;

type Path = Record<string, unknown>;

export const pathOf = (request: Request): Path => (isObject(request["path"]) ? request["path"] : {});

export function itemsOf(request: Request): Item[] {
  const path = pathOf(request);
  if (Array.isArray(path["waypoints"])) {
    const type = String(path["interpolation"] ?? "joint");
    return path["waypoints"].map((waypoint) => ({ type, pose: poseOf(waypoint), rest: {}, group: 0 }));
  }
  const items: Item[] = isObject(path["begin"])
    ? [{ type: "begin", pose: poseOf(path["begin"]), rest: {}, group: -1 }]
    : [];
  const segments: unknown[] = Array.isArray(path["segments"]) ? path["segments"] : [];
  for (const [k, segment] of segments.entries()) {
    if (!isObject(segment)) continue;
    const { type, to, through, ...rest } = segment;
    if (type === "spline" && Array.isArray(through)) {
      items.push(...through.map((pose, i) => ({
        type: "spline", pose: poseOf(pose), rest: i === 0 ? rest : {}, group: k,
      })));
    } else {
      items.push({ type: String(type), pose: poseOf(to), rest, group: k });
    }
  }
  return items;
}

/** The document with a path of other items: waypoints where they can say it, else segments. */
export function withItems(request: Request, items: Item[]): Request {
  const path = pathOf(request);
  const { waypoints, segments, begin, interpolation, ...kept } = path;
  const asWaypoints = Array.isArray(waypoints) || (segments === undefined && begin === undefined);
  const wanted = items.length === 0 ? String(interpolation ?? "line") : items[0]!.type;
  const plain = items.every(({ type, pose, rest }) =>
    type === wanted && pose !== null && Object.keys(rest).length === 0);
  if (asWaypoints && plain && ["joint", "line", "spline"].includes(wanted)) {
    const joined = wanted === "joint" && interpolation === undefined ? {} : { interpolation: wanted };
    return { ...request, path: { ...kept, ...joined, waypoints: items.map(({ pose }) => waypointOf(pose!)) } };
  }
  const first = items[0];
  // Waypoints begin at the first of them where the start does not lead there along the path.
  const leads = request["start"] !== "free" && (kept["approach"] ?? "path") === "path";
  const begins = first !== undefined && first.pose !== null
    && (first.type === "begin" || (asWaypoints && !leads && ["line", "spline"].includes(first.type)));
  return {
    ...request,
    path: {
      ...kept,
      ...(begins ? { begin: waypointOf(first.pose!) } : {}),
      segments: segmentsOf(begins ? items.slice(1) : items),
    },
  };
}

function segmentsOf(items: Item[]): unknown[] {
  const segments: Record<string, unknown>[] = [];
  let group: number | null = null;
  for (const item of items) {
    if (item.type !== "spline") {
      segments.push({ type: item.type, ...(item.pose === null ? {} : { to: waypointOf(item.pose) }), ...item.rest });
      group = null;
    } else if (item.group === group) {
      const spline = segments.at(-1)!;
      (spline["through"] as unknown[]).push(waypointOf(item.pose!));
      Object.assign(spline, item.rest);
    } else {
      segments.push({ type: "spline", through: [waypointOf(item.pose!)], ...item.rest });
      group = item.group;
    }
  }
  return segments;
}

export function poseOf(value: unknown): Pose | null {
  if (!isObject(value) || !isNumbers(value["position"], 3)) return null;
  const q = value["quaternion_xyzw"];
  return { position: value["position"], quaternion: isNumbers(q, 4) ? q : null };
}

export function waypointOf({ position, quaternion }: Pose): Record<string, unknown> {
  const rounded = position.map(tidy);
  return quaternion === null
    ? { position: rounded }
    : { position: rounded, quaternion_xyzw: quaternion.map((c) => Number(c.toFixed(9)) + 0) };
}

/** A length without the noise of arithmetic: to a micrometre. */
export const tidy = (metres: number): number => Number(metres.toFixed(6)) + 0;
