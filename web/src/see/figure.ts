/** A figure of a plan for a paper or a report: SVG, drawn for white paper. */

import { s } from "../dom";
import type { Planned } from "../results";
import { angleUnit, lengthUnit, scaleOf } from "../units";
import { LINES } from "./colours";
import type { Quantity, Signal } from "./signals";

const WIDTH = 720;
const PANEL = 130;
const LEFT = 64;
const RIGHT = 12;
const GAP = 34;
const TOP = 34;

export function figureOf({ plan }: Planned, quantities: Quantity[]): string {
  const { time } = plan.trajectory;
  const duration = Math.max(time.at(-1) ?? 0, 1e-9);
  const height = TOP + quantities.length * (PANEL + GAP) + 10;
  const root = s("svg", {
    xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${WIDTH} ${height}`, width: WIDTH, height,
    "font-family": "sans-serif", "font-size": 11, role: "img", "aria-label": `Plan ${plan.id} over time`,
  }, s("rect", { width: WIDTH, height, fill: "#fff" }));
  let x = LEFT;
  for (const [j, name] of plan.joint_names.entries()) {
    root.append(s("text", { x, y: 16, fill: LINES[j % LINES.length]! }, name));
    x += 10 + name.length * 6.2;
  }
  for (const [i, quantity] of quantities.entries()) {
    root.append(panel(quantity, time, duration, TOP + i * (PANEL + GAP)));
  }
  return new XMLSerializer().serializeToString(root);
}

function panel({ title, signals }: Quantity, time: number[], duration: number, top: number): SVGGElement {
  const scaled = signals.map((signal) => signal.values.map((value) => (value ?? 0) * factor(signal)));
  const low = Math.min(0, ...scaled.map((values) => Math.min(...values)));
  const high = Math.max(0, ...scaled.map((values) => Math.max(...values)));
  const span = Math.max(high - low, 1e-9);
  const x = (t: number): number => LEFT + (t / duration) * (WIDTH - LEFT - RIGHT);
  const y = (v: number): number => top + PANEL * (1 - (v - low) / span);
  const group = s("g", {}, s("rect", {
    x: LEFT, y: top, width: WIDTH - LEFT - RIGHT, height: PANEL, fill: "none", stroke: "#999",
  }), s("text", { x: LEFT, y: top - 5, "font-weight": "bold" }, `${title} [${unitOf(signals)}]`));
  for (const v of ticks(low, high)) {
    group.append(s("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v), stroke: "#e4e4e4" }),
      s("text", { x: LEFT - 5, y: y(v) + 4, "text-anchor": "end" }, String(Number(v.toPrecision(4)))));
  }
  for (const t of ticks(0, duration)) {
    group.append(s("text", { x: x(t), y: top + PANEL + 14, "text-anchor": "middle" }, `${Number(t.toPrecision(4))} s`));
  }
  for (const [j, values] of scaled.entries()) {
    const d = values.map((v, k) => `${k === 0 ? "M" : "L"}${x(time[k]!).toFixed(2)} ${y(v).toFixed(2)}`).join("");
    group.append(s("path", { d, fill: "none", stroke: LINES[j % LINES.length]!, "stroke-width": 1.3 }));
  }
  return group;
}

const factor = ({ unit: { base } }: Signal): number =>
  (base === "rad" ? scaleOf("angle") : base === "m" ? scaleOf("length") : 1);

function unitOf(signals: Signal[]): string {
  const names = signals.map(({ unit: { base, order } }) =>
    (base === "rad" ? angleUnit() : base === "m" ? lengthUnit() : base) + ["", "/s", "/s²", "/s³"][order]);
  return [...new Set(names)].join(", ");
}

/** Round values within a range, about four of them. */
function ticks(low: number, high: number): number[] {
  const rough = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(Math.max(rough, 1e-12)));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= rough) ?? rough;
  const found: number[] = [];
  for (let v = Math.ceil(low / step) * step; v <= high + step * 1e-6; v += step) found.push(v);
  return found;
}
