/** Position, velocity and acceleration of each joint over time, against their limits. */

import { h, s } from "../dom";
import type { Plan } from "../documents";
import type { Range } from "../limits";
import type { Moment } from "../playback";
import { jointText, shown, unitName, type JointUnit } from "../units";

const WIDTH = 600;
const HEIGHT = 100;
const KINDS = ["Position", "Velocity", "Acceleration"] as const;
type Order = 0 | 1 | 2;
const ORDERS: Order[] = [0, 1, 2];
const RATES = ["q", "dq", "ddq"] as const;

export class Plots {
  private cursors: SVGLineElement[] = [];
  private values: HTMLElement[][] = [];
  private units: JointUnit[] = [];
  private duration = 1;

  constructor(private readonly host: HTMLElement, private readonly seek: (time: number) => void) {}

  clear(): void {
    this.host.replaceChildren();
    this.cursors = [];
    this.values = [];
  }

  show(plan: Plan, limits: Range[][]): void {
    this.clear();
    this.units = plan.joint_units;
    this.duration = plan.trajectory.time.at(-1) || 1;
    const head = h("div", { class: "plot-row plot-head", "aria-hidden": "true" }, h("span", {}, "Joint"),
      ...ORDERS.map((order) => h("span", {}, `${KINDS[order]} [${this.names(order)}]`)));
    const rows = plan.joint_names.map((name, j) => {
      const outputs = ORDERS.map((order) => h("output", { "data-joint": name, "data-kind": RATES[order] }));
      this.values.push(outputs);
      return h("div", { class: "plot-row" },
        h("h3", {}, name),
        ...ORDERS.map((order) => h("div", { class: "plot" },
          h("span", { class: "plot-label" }, KINDS[order]), outputs[order]!,
          this.chart(plan, j, order, limits[j]![order]!))));
    });
    this.host.append(h("h2", {}, "Joints"), head, ...rows);
  }

  /** Moves the cursor. */
  update(time: number, moment: Moment): void {
    const x = String((time / this.duration) * WIDTH);
    for (const cursor of this.cursors) {
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
    }
    for (const [j, outputs] of this.values.entries()) {
      for (const order of ORDERS) {
        const value = moment[RATES[order]][j]!;
        outputs[order]!.textContent = jointText(value, this.units[j]!, order);
        outputs[order]!.dataset["value"] = String(value);
      }
    }
  }

  private names(order: Order): string {
    return [...new Set(this.units)].map((unit) => unitName(unit, order)).join(", ");
  }

  private chart(plan: Plan, j: number, order: Order, limit: Range): HTMLElement {
    const { time } = plan.trajectory;
    const values = plan.trajectory[RATES[order]].map((row) => row[j]!);
    let low = Math.min(...values);
    let high = Math.max(...values);
    const peak = Math.abs(low) > Math.abs(high) ? low : high;
    low = Math.min(low, limit.lower ?? low);
    high = Math.max(high, limit.upper ?? high);
    const room = Math.max((high - low) * 0.06, 1e-9);
    const y = (v: number): number => HEIGHT * (1 - (v - low + room) / (high - low + 2 * room));
    const x = (t: number): number => (t / this.duration) * WIDTH;
    const cursor = s("line", { class: "cursor", x1: 0, x2: 0, y1: 0, y2: HEIGHT });
    this.cursors.push(cursor);
    const bounds = [limit.lower, limit.upper].filter((v) => v !== null);
    const unit = this.units[j]!;
    const svg: SVGSVGElement = s("svg", {
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img",
      "aria-label": `${KINDS[order]} of ${plan.joint_names[j]}: at most ${jointText(peak, unit, order)} `
        + `${unitName(unit, order)}`
        + (limit.upper === null ? "" : `, limit ${jointText(limit.upper, unit, order)}`),
      onpointerdown: (event) => this.point(event as PointerEvent, svg),
      onpointermove: (event) => {
        if ((event as PointerEvent).buttons > 0) this.point(event as PointerEvent, svg);
      },
    });
    if (low < 0 && high > 0) svg.append(s("line", { class: "zero", x1: 0, x2: WIDTH, y1: y(0), y2: y(0) }));
    for (const bound of bounds) {
      svg.append(s("line", { class: "limit", x1: 0, x2: WIDTH, y1: y(bound), y2: y(bound) }));
    }
    const ticks = plan.waypoints.time.map((t) => `M${x(t).toFixed(1)} ${HEIGHT}V${HEIGHT - 7}`).join("");
    svg.append(s("path", { class: "tick", d: ticks }),
      s("path", { class: "curve", d: path(time, values, x, y) }), cursor);
    const edge = (v: number | null, where: string): HTMLElement[] =>
      v === null ? [] : [h("span", { class: `edge ${where}`, "aria-hidden": "true" },
        short(shown(v, unit)))];
    return h("div", { class: "chart" }, svg, ...edge(limit.upper, "upper"), ...edge(limit.lower, "lower"));
  }

  private point(event: PointerEvent, svg: SVGSVGElement): void {
    const box = svg.getBoundingClientRect();
    this.seek(((event.clientX - box.left) / box.width) * this.duration);
  }
}

const short = (value: number): string =>
  value.toLocaleString("en", { maximumSignificantDigits: 3, useGrouping: false }).replace("-", "−");

/** A line through the samples; where they are many, through the extremes of each small stretch. */
function path(time: number[], values: number[], x: (t: number) => number, y: (v: number) => number): string {
  const stretch = Math.max(1, Math.ceil(time.length / WIDTH));
  const kept: number[] = [];
  for (let k = 0; k < time.length; k += stretch) {
    let least = k;
    let most = k;
    for (let i = k; i < Math.min(k + stretch, time.length); i += 1) {
      if (values[i]! < values[least]!) least = i;
      if (values[i]! > values[most]!) most = i;
    }
    kept.push(...new Set([Math.min(least, most), Math.max(least, most)]));
  }
  if (kept.at(-1) !== time.length - 1) kept.push(time.length - 1);
  return kept.map((k, i) => `${i ? "L" : "M"}${x(time[k]!).toFixed(2)} ${y(values[k]!).toFixed(2)}`).join("");
}
