/** What stands around the arm: obstacles, carried parts, the path frame and the tool. */

import { isNumbers, isObject, type Request } from "../documents";
import { byId, h } from "../dom";
import {
  SHAPES, addBody, bodiesOf, changeBody, removeBody, sceneField, setSceneField,
  type Body, type BodyList, type ShapeName,
} from "../path/bodies";
import { frameOf, matrixOf, quaternionOf, rpyOf, three, toBase, toPath } from "../path/frames";
import { pathOf, waypointOf, type Pose } from "../path/items";
import { nameOf, type Selected, type Selection } from "../state/selection";
import type { DocumentStore } from "../state/store";
import { button, numberField, redraw, vectorFields } from "./fields";

const NO_TURN = [0, 0, 0, 1];

export class SceneList {
  private readonly host = byId("scene-panel");

  /** `place` says where a new obstacle stands, `tool` where the tool is now, in the base. */
  constructor(
    private readonly store: DocumentStore, private readonly selection: Selection,
    private readonly place: () => number[], private readonly tool: () => Pose,
  ) {
    store.onChange(() => this.draw());
    selection.onChange(() => this.draw());
  }

  draw(): void {
    const { request } = this.store;
    if (request === null) {
      redraw(this.host, h("p", { class: "fault" }, this.store.fault));
      return;
    }
    if (typeof request["scene"] === "string") {
      redraw(this.host, h("p", { class: "hint" }, `The scene ${request["scene"]} is kept by the service.`));
      return;
    }
    const clearance = sceneField(request, "clearance");
    const own = sceneField(request, "self_collision") !== false;
    const check = h("input", {
      type: "checkbox", checked: own, "data-key": "self", onchange: () =>
        this.store.edit((old) => setSceneField(old, "self_collision", check.checked)),
    });
    redraw(this.host,
      h("ul", { class: "rows", "aria-label": "Obstacles, parts and frames" },
        ...bodiesOf(request, "obstacles").map((body, i) => this.row(body, "obstacles", i)),
        ...bodiesOf(request, "attached").map((body, i) => this.row(body, "attached", i)),
        this.line({ kind: "frame" }, "Path frame", "in the base"),
        this.line({ kind: "tool" }, "Tool", "in the tip frame")),
      h("div", { class: "actions" }, ...(Object.keys(SHAPES) as ShapeName[]).map((shape) =>
        button(`Add a ${shape}`, `add-${shape}`, () => this.add(shape)))),
      this.details(request),
      h("div", { class: "vector" },
        numberField("Clearance", typeof clearance === "number" ? clearance : null, "length", (value) =>
          this.store.edit((old) => setSceneField(old, "clearance", value ?? 0)),
        { key: "clearance", min: 0, placeholder: "0" })),
      h("label", { class: "check" }, check, "Check the arm against itself"));
  }

  private add(shape: ShapeName): void {
    const position = this.place();
    this.store.edit((request) => addBody(request, "obstacles", { name: shape, shape: SHAPES[shape], position }));
    const count = this.store.request === null ? 0 : bodiesOf(this.store.request, "obstacles").length;
    this.selection.set({ kind: "obstacle", index: count - 1 });
  }

  private row(body: Body, list: BodyList, index: number): HTMLElement {
    const name = String(body["name"]);
    const shape = isObject(body["shape"]) ? String(body["shape"]["type"]) : "no shape";
    const selected: Selected = { kind: list === "obstacles" ? "obstacle" : "part", index };
    return this.line(selected, name, list === "obstacles" ? shape : `${shape}, carried`,
      button(`Duplicate ${name}`, `copy-${list}-${index}`, () =>
        this.store.edit((request) => addBody(request, list, structuredClone(body))), "⊕"),
      button(`Delete ${name}`, `delete-${list}-${index}`, () => {
        this.selection.set(null);
        this.store.edit((request) => removeBody(request, list, index));
      }, "✕"));
  }

  private line(selected: Selected, name: string, kind: string, ...tools: HTMLElement[]): HTMLElement {
    const on = nameOf(selected) === nameOf(this.selection.now);
    return h("li", { class: on ? "selected" : "" },
      h("button", {
        type: "button", class: "name", "data-key": nameOf(selected), "aria-pressed": String(on),
        onclick: () => this.selection.set(on ? null : selected),
      }, h("span", { class: "where" }, name)),
      h("span", { class: "kind" }, kind), h("span", { class: "tools" }, ...tools));
  }

  private details(request: Request): HTMLElement | string {
    const { now } = this.selection;
    if (now === null || now.kind === "point") return "";
    if (now.kind === "frame") {
      return this.placed("Path frame", frameOf(pathOf(request)["frame"]), (pose) =>
        this.store.edit((old) => withFrame(old, pose)));
    }
    if (now.kind === "tool") {
      return this.placed("Tool", frameOf(request["tool"]), (pose) => this.store.edit((old) => withTool(old, pose)));
    }
    const list: BodyList = now.kind === "obstacle" ? "obstacles" : "attached";
    const body = bodiesOf(request, list)[now.index];
    if (body === undefined) return "";
    const change = (fields: Body): void =>
      this.store.edit((old) => changeBody(old, list, now.index, fields));
    const name = h("input", {
      type: "text", value: String(body["name"]), "data-key": "body-name", autocomplete: "off",
      onchange: () => { if (name.value.trim() !== "") change({ name: name.value.trim() }); },
    });
    return this.placed(String(body["name"]), frameOf(body), (pose) => change(waypointOf(pose)),
      h("label", { class: "field" }, h("span", {}, "Name"), name),
      isObject(body["shape"]) ? sizes(body["shape"], (shape) => change({ shape })) : "",
      button(list === "obstacles" ? "Let the tool carry it" : "Put it down here", "carry", () => this.carry(list, now.index)));
  }

  /** Makes an obstacle a part that the tool carries, or the other way; it stays where it is. */
  private carry(list: BodyList, index: number): void {
    const tool = matrixOf(this.tool());
    const to: BodyList = list === "obstacles" ? "attached" : "obstacles";
    this.store.edit((request) => {
      const body = bodiesOf(request, list)[index]!;
      const pose = frameOf(body);
      const oriented = { ...pose, quaternion: pose.quaternion ?? NO_TURN };
      const moved = list === "obstacles" ? toPath(tool, oriented) : toBase(tool, oriented);
      const { first_segment: _, last_segment: __, touches: ___, ...kept } = body;
      return addBody(removeBody(request, list, index), to, { ...kept, ...waypointOf(moved) });
    });
    const count = this.store.request === null ? 0 : bodiesOf(this.store.request, to).length;
    this.selection.set({ kind: to === "obstacles" ? "obstacle" : "part", index: count - 1 });
  }

  private placed(
    title: string, pose: Pose, change: (pose: Pose) => void, ...first: (HTMLElement | string)[]
  ): HTMLElement {
    const turn = pose.quaternion ?? NO_TURN;
    return h("fieldset", { class: "details" }, h("legend", {}, title), ...first,
      vectorFields("Position", ["x", "y", "z"], pose.position, "length", (position) =>
        change({ position, quaternion: pose.quaternion })),
      vectorFields("Orientation", ["roll", "pitch", "yaw"], rpyOf(turn), "angle", (rpy) =>
        change({ position: pose.position, quaternion: quaternionOf(rpy) })));
  }
}

function sizes(shape: Body, change: (shape: Body) => void): HTMLElement | string {
  if (shape["type"] === "box") {
    return vectorFields("Size", ["x", "y", "z"], three(shape["size"], [0.1, 0.1, 0.1]), "length", (size) => {
      if (isNumbers(size, 3) && Math.min(...size) > 0) change({ ...shape, size });
    });
  }
  const fields = ["radius", "length"].filter((field) => typeof shape[field] === "number");
  if (fields.length === 0) return "";
  return h("div", { class: "vector" }, ...fields.map((field) =>
    numberField(field === "radius" ? "Radius" : "Length", Number(shape[field]), "length", (value) => {
      if (value !== null && value > 0) change({ ...shape, [field]: value });
    }, { key: field, min: 0 })));
}

export function withFrame(request: Request, pose: Pose): Request {
  return { ...request, path: { ...pathOf(request), frame: waypointOf(pose) } };
}

export function withTool(request: Request, pose: Pose): Request {
  const tool = isObject(request["tool"]) ? request["tool"] : {};
  return { ...request, tool: { ...tool, ...waypointOf(pose) } };
}
