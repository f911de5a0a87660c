/** What the handles in the scene hold: the point, body or frame that is selected. */

import type { Request } from "../documents";
import { bodiesOf, changeBody, type BodyList } from "../path/bodies";
import { setPose } from "../path/edits";
import { frameOf, pathFrame, toBase, toPath } from "../path/frames";
import { itemsOf, pathOf, waypointOf, type Pose } from "../path/items";
import { withFrame, withTool } from "../panels/scene-list";
import type { Held } from "../scene/handles";
import { nameOf, type Selected } from "../state/selection";
import type { DocumentStore } from "../state/store";
import { toolOf } from "../targets";
import type { Carrier } from "../view";

type Holding = Omit<Held, "parent"> & { carrier: Carrier };

/** What to hold; null: nothing. `follow` hears where the tool is to go, in the base. */
export function holdingOf(
  selected: Selected | null, store: DocumentStore, ownTool: Pose, follow: (pose: Pose) => void,
): Holding | null {
  const { request } = store;
  if (selected === null || request === null) return null;
  const id = nameOf(selected);
  const put = (change: (request: Request) => Request, key: string): void => store.edit(change, key);
  switch (selected.kind) {
    case "point": {
      const item = itemsOf(request)[selected.index];
      if (item === undefined || item.pose === null) return null;
      const oriented = item.pose.quaternion !== null;
      return {
        id, carrier: "base", pose: toBase(pathFrame(request), item.pose),
        moved: (pose, key) => {
          const wanted = oriented ? pose : { ...pose, quaternion: null };
          put((old) => setPose(old, selected.index, toPath(pathFrame(old), wanted)), key);
          follow(wanted);
        },
      };
    }
    case "frame":
      return {
        id, carrier: "base", pose: frameOf(pathOf(request)["frame"]),
        moved: (pose, key) => put((old) => withFrame(old, pose), key),
      };
    case "tool": {
      const tool = toolOf(request);
      const pose = tool === null ? ownTool
        : { position: tool.position.toArray(), quaternion: tool.quaternion?.toArray() ?? null };
      return { id, carrier: "tip", pose, moved: (moved, key) => put((old) => withTool(old, moved), key) };
    }
    default: {
      const list: BodyList = selected.kind === "obstacle" ? "obstacles" : "attached";
      const body = bodiesOf(request, list)[selected.index];
      if (body === undefined) return null;
      return {
        id, carrier: list === "obstacles" ? "base" : "tool", pose: frameOf(body),
        moved: (pose, key) => put((old) => changeBody(old, list, selected.index, waypointOf(pose)), key),
      };
    }
  }
}
