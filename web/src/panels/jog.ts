/** Moving the arm by hand: joint by joint, or the tool along the axes of the base or its own. */

import { Euler, Matrix4, Quaternion, Vector3 } from "three";

import type { LiveArm } from "../arm/live";
import type { JointInfo, RobotInfo } from "../documents";
import { byId, h } from "../dom";
import { matrixOf, poseOfMatrix } from "../path/frames";
import type { Pose } from "../path/items";
import { angleUnit, jointText, lengthUnit, scaleOf, shown, unitName, type JointUnit } from "../units";
import { button, choice } from "./fields";

type Frame = "base" | "tool";
const STEPS_M = [0.001, 0.01, 0.05];
const STEPS_RAD = [1, 5, 15].map((degrees) => (degrees * Math.PI) / 180);

export class JogPanel {
  private readonly host = byId("arm-panel");
  private robot: RobotInfo | null = null;
  private sliders: HTMLInputElement[] = [];
  private outputs: HTMLOutputElement[] = [];
  private frame: Frame = "base";
  private step = 1;

  /** `start` hears that the document is to begin at the joint values of now. */
  constructor(
    private readonly live: LiveArm, private readonly pose: () => Pose,
    private readonly start: (q: number[]) => void,
  ) {
    live.onMove(() => this.update());
  }

  show(robot: RobotInfo): void {
    this.robot = robot;
    this.sliders = [];
    this.outputs = [];
    const rows = robot.joints.map((joint, j) => this.row(joint, j));
    this.host.replaceChildren(
      h("div", { class: "joints", role: "group", "aria-label": "Joints" }, ...rows),
      h("div", { class: "jog", role: "group", "aria-label": "Jog the tool" },
        h("label", { class: "field" }, h("span", {}, "Tool along"),
          choice("Axes of the jog", this.frame, [["base", "axes of the base"], ["tool", "its own axes"]],
            "jog-frame", (value) => { this.frame = value as Frame; })),
        h("label", { class: "field" }, h("span", {}, "By"),
          choice("Step of the jog", String(this.step), STEPS_M.map((_, i) => [String(i), stepText(i)]),
            "jog-step", (value) => { this.step = Number(value); })),
        ...["x", "y", "z"].map((axis, i) => this.pair(axis, i, false)),
        ...["rx", "ry", "rz"].map((axis, i) => this.pair(axis, i, true))),
      h("div", { class: "actions" },
        button("Home", "home", () => this.live.setJoints(robot.joints.map(({ home }) => home))),
        button("Start the path here", "start-here", () => this.start(this.live.q))));
    this.update();
  }

  private row(joint: JointInfo, j: number): HTMLElement {
    const unit: JointUnit = joint.type === "prismatic" ? "m" : "rad";
    const [low, high] = [joint.lower ?? -Math.PI, joint.upper ?? Math.PI];
    const slider = h("input", {
      type: "range", min: low, max: high, step: "any", "aria-label": joint.name, "data-joint": joint.name,
      oninput: () => this.set(j, Number(slider.value)),
      onkeydown: (event) => {
        const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[(event as KeyboardEvent).key];
        if (by === undefined) return;
        event.preventDefault();
        this.nudge(j, by, unit);
      },
    });
    const output = h("output", {});
    this.sliders.push(slider);
    this.outputs.push(output);
    return h("div", { class: "joint" }, h("span", { class: "where" }, joint.name),
      button(`${joint.name} back`, `less-${j}`, () => this.nudge(j, -1, unit), "−"), slider,
      button(`${joint.name} on`, `more-${j}`, () => this.nudge(j, 1, unit), "+"), output);
  }

  private nudge(j: number, sign: number, unit: JointUnit): void {
    this.set(j, this.live.q[j]! + sign * (unit === "m" ? STEPS_M : STEPS_RAD)[this.step]!);
  }

  private set(j: number, value: number): void {
    const joint = this.robot!.joints[j]!;
    const kept = Math.min(Math.max(value, joint.lower ?? -Infinity), joint.upper ?? Infinity);
    this.live.setJoints(this.live.q.map((old, i) => (i === j ? kept : old)));
  }

  private pair(axis: string, i: number, turns: boolean): HTMLElement {
    return h("span", { class: "pair" }, button(`Jog ${axis} back`, `back-${axis}`, () => this.jog(i, turns, -1), "−"),
      axis, button(`Jog ${axis} on`, `on-${axis}`, () => this.jog(i, turns, 1), "+"));
  }

  private jog(i: number, turns: boolean, sign: number): void {
    const by = new Vector3().setComponent(i, sign * (turns ? STEPS_RAD : STEPS_M)[this.step]!);
    // Steps add up from where the last one leads, also while the arm is on its way.
    const { goal } = this.live;
    const at = matrixOf(goal === null || goal.quaternion === null ? this.pose() : goal);
    const change = turns
      ? new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromEuler(new Euler(by.x, by.y, by.z)))
      : new Matrix4().makeTranslation(by);
    const moved = this.frame === "tool" ? at.multiply(change) : inBase(at, change, turns);
    this.live.follow(poseOfMatrix(moved));
  }

  private update(): void {
    for (const [j, value] of this.live.q.entries()) {
      const joint = this.robot?.joints[j];
      const [slider, output] = [this.sliders[j], this.outputs[j]];
      if (joint === undefined || slider === undefined || output === undefined) continue;
      const unit: JointUnit = joint.type === "prismatic" ? "m" : "rad";
      slider.value = String(value);
      slider.setAttribute("aria-valuetext", `${jointText(value, unit)} ${unitName(unit)}`);
      output.textContent = jointText(value, unit);
      output.dataset["value"] = String(value);
    }
  }
}

/** A change along the axes of the base, about the tool's own point. */
function inBase(at: Matrix4, change: Matrix4, turns: boolean): Matrix4 {
  if (!turns) return change.multiply(at);
  const position = new Vector3().setFromMatrixPosition(at);
  return change.multiply(at).setPosition(position);
}

const stepText = (i: number): string =>
  `${Number((STEPS_M[i]! * scaleOf("length")).toFixed(3))} ${lengthUnit()}, `
  + `${Number(shown(STEPS_RAD[i]!, "rad").toFixed(3))} ${angleUnit()}`;
