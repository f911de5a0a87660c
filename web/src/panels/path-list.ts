/** The path as a list: points are added, moved, turned, typed, limited and put in order. */

import type { Problem, Request } from "../documents";
import { failedWaypoints, isObject } from "../documents";
import { byId, h } from "../dom";
import * as edits from "../path/edits";
import { POSE_TYPES, itemsOf, pathOf, type Item, type Pose } from "../path/items";
import { pathFrame, quaternionOf, rpyOf, toPath } from "../path/frames";
import type { Selection } from "../state/selection";
import type { DocumentStore } from "../state/store";
import { fixed, lengthUnit } from "../units";
import { button, choice, numberField, redraw, vectorFields } from "./fields";

/** Rows that are drawn at once; the others are reached by selecting in the scene. */
const MOST_ROWS = 120;

export class PathList {
  private readonly host = byId("path-panel");
  private failed: number[] = [];

  /** `current` is the pose of the tool now, in the base. */
  constructor(
    private readonly store: DocumentStore, private readonly selection: Selection,
    private readonly current: () => Pose,
  ) {
    store.onChange(() => this.draw());
    selection.onChange(() => this.draw());
  }

  /** Marks the points that a problem names. */
  markFailed(problem: Problem | null): void {
    this.failed = problem === null ? [] : failedWaypoints(problem);
    this.draw();
  }

  draw(): void {
    const { request } = this.store;
    if (request === null) {
      redraw(this.host, h("p", { class: "fault" }, this.store.fault));
      return;
    }
    const items = itemsOf(request);
    const selected = this.selection.index("point");
    const first = Math.max(0, Math.min(selected - MOST_ROWS / 2, items.length - MOST_ROWS));
    const shown = items.slice(first, first + MOST_ROWS);
    const left = items.length - shown.length;
    redraw(this.host,
      h("ol", { class: "rows", start: first, "aria-label": "Points of the path" },
        ...shown.map((item, k) => this.row(item, first + k, items.length))),
      left > 0 ? h("p", { class: "hint" }, `${left} more points are not listed.`) : "",
      items.length === 0 ? h("p", { class: "hint" }, "No points yet. Move the arm, then add its pose.") : "",
      h("div", { class: "actions" },
        button("Add the current pose", "add-pose", () => this.insert(selected < 0 ? items.length - 1 : selected)),
        button("Insert before", "insert-pose", () => this.insert(selected - 1), "Insert before", selected < 0)),
      items[selected] === undefined ? "" : this.details(items, selected));
  }

  private row(item: Item, index: number, count: number): HTMLElement {
    const selected = index === this.selection.index("point");
    const name = `point ${index}`;
    const where = item.pose === null ? described(item) : item.pose.position.map(shortText).join("  ");
    const act = (change: (request: Request) => Request, then: number): void => {
      this.store.edit(change);
      this.selection.set(then < 0 ? null : { kind: "point", index: then });
    };
    return h("li", { class: [selected ? "selected" : "", this.failed.includes(index) ? "failed" : ""].join(" ").trim() },
      h("button", {
        type: "button", class: "name", "data-key": `row-${index}`, "aria-pressed": String(selected),
        onclick: () => this.selection.set(selected ? null : { kind: "point", index }),
      }, h("span", { class: "number" }, String(index)), h("span", { class: "where" }, where)),
      item.type === "begin" ? h("span", { class: "kind" }, "begin")
        : choice(`Type of ${name}`, item.type, typesOf(item), `type-${index}`, (type) =>
          act((request) => edits.setType(request, index, type), index)),
      h("span", { class: "tools" },
        button(`Move ${name} up`, `up-${index}`, () =>
          act((request) => edits.swap(request, index, index - 1), index - 1), "↑", index === 0),
        button(`Move ${name} down`, `down-${index}`, () =>
          act((request) => edits.swap(request, index, index + 1), index + 1), "↓", index === count - 1),
        button(`Duplicate ${name}`, `copy-${index}`, () =>
          act((request) => edits.duplicate(request, index), index + 1), "⊕"),
        button(`Delete ${name}`, `delete-${index}`, () =>
          act((request) => edits.remove(request, index), -1), "✕")));
  }

  private details(items: Item[], index: number): HTMLElement {
    const item = items[index]!;
    const set = (pose: Pose): void => this.store.edit((request) => edits.setPose(request, index, pose));
    const parts: (HTMLElement | string)[] = [];
    if (item.pose !== null) {
      const { position, quaternion } = item.pose;
      parts.push(
        vectorFields("Position", ["x", "y", "z"], position, "length", (values) =>
          set({ position: values, quaternion })),
        h("label", { class: "check" }, this.freedom(item.pose, set), "Any orientation"));
      if (quaternion !== null) {
        parts.push(vectorFields("Orientation", ["roll", "pitch", "yaw"], rpyOf(quaternion), "angle",
          (values) => set({ position, quaternion: quaternionOf(values) })));
      }
      parts.push(button("Set to the current pose", "set-pose", () => this.store.edit((request) => {
        const pose = toPath(pathFrame(request), this.current());
        return edits.setPose(request, index, quaternion === null ? { ...pose, quaternion: null } : pose);
      })));
    }
    if (item.type !== "begin") parts.push(this.own(items, index));
    return h("fieldset", { class: "details" }, h("legend", {}, `Point ${index}`), ...parts);
  }

  private freedom(pose: Pose, set: (pose: Pose) => void): HTMLInputElement {
    const box = h("input", {
      type: "checkbox", "data-key": "free", checked: pose.quaternion === null,
      onchange: () => set({
        position: pose.position,
        quaternion: box.checked ? null
          : toPath(pathFrame(this.store.request ?? {}), this.current()).quaternion,
      }),
    });
    return box;
  }

  /** Blend and limits of the segment. */
  private own(items: Item[], index: number): HTMLElement {
    const limits = edits.fieldOf(items, index, "limits");
    const known: Record<string, unknown> = isObject(limits) ? limits : {};
    const blend = edits.fieldOf(items, index, "blend");
    const general = this.store.request === null ? undefined : pathOf(this.store.request)["blend"];
    const number = (value: unknown): number | null => (typeof value === "number" ? value : null);
    const speed = isObject(known["tool_speed"]) ? known["tool_speed"]["linear"] : known["tool_speed"];
    const limit = (field: string, value: unknown): void => {
      const { [field]: _, ...rest } = known;
      const changed = value === null ? rest : { ...rest, [field]: value };
      this.store.edit((request) => edits.setField(
        request, index, "limits", Object.keys(changed).length === 0 ? undefined : changed));
    };
    const fields = [
      numberField("Velocity scale", number(known["velocity_scale"]), "plain",
        (value) => limit("velocity_scale", value), { key: "velocity", min: 0, max: 1, placeholder: "1" }),
      numberField("Tool speed, per second", number(speed), "length",
        (value) => limit("tool_speed", value === null ? null : { linear: value }),
        { key: "speed", min: 0, placeholder: "any" }),
    ];
    if (items[index]!.type !== "move") {
      fields.unshift(numberField("Blend", number(blend), "length",
        (value) => this.store.edit((request) => edits.setField(request, index, "blend", value ?? undefined)),
        { key: "blend", min: 0, placeholder: typeof general === "number" ? String(general) : "as the path" }));
    }
    return h("div", { class: "vector" }, ...fields);
  }

  private insert(after: number): void {
    const pose = this.current();
    this.store.edit((request) => edits.insertPose(request, after, toPath(pathFrame(request), pose)));
    this.selection.set({ kind: "point", index: after + 1 });
  }
}

function typesOf(item: Item): [string, string][] {
  const types: string[] = item.pose === null ? [item.type] : [...POSE_TYPES];
  if (!types.includes(item.type)) types.push(item.type);
  return types.map((type) => [type, type]);
}

function described(item: Item): string {
  const { q, radius, length, angle } = item.rest;
  if (Array.isArray(q)) return "joint values";
  const said = [["radius", radius], ["length", length], ["angle", angle]].filter(([, value]) => typeof value === "number");
  return said.map(([name, value]) => `${String(name)} ${String(value)}`).join(", ") || "see the document";
}

/** A length in a list: to a millimetre. */
const shortText = (metres: number): string => (lengthUnit() === "mm" ? fixed(metres * 1000, 0) : fixed(metres, 3));
