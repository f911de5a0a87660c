/** Every quantity of a plan over time, against its limits, with the cursor and the zoom in step. */

import { h } from "../dom";
import type { Planned } from "../results";
import { Chart } from "../see/chart";
import { LINES } from "../see/colours";
import type { Binding, Quantity, Signal, Unit } from "../see/signals";
import type { Moment } from "../playback";
import { angleUnit, fixed, jointText, lengthUnit, scaleOf, shareText, unitName } from "../units";

const RATES = ["q", "dq", "ddq"] as const;

export class Plots {
  private charts: Chart[] = [];
  private readonly cells = new Map<string, HTMLElement>();
  private nowBinding: HTMLElement | null = null;
  private planned: Planned | null = null;
  private quantities: Quantity[] = [];
  private binding: Binding[] = [];
  private shown = "q";
  private zooming = false;

  constructor(private readonly host: HTMLElement, private readonly seek: (time: number) => void) {
    new ResizeObserver(() => this.charts.forEach((chart) => chart.resize())).observe(host);
  }

  clear(): void {
    for (const chart of this.charts) chart.destroy();
    this.charts = [];
    this.cells.clear();
    this.nowBinding = null;
    this.planned = null;
    this.host.replaceChildren();
  }

  show(planned: Planned, quantities: Quantity[], binding: Binding[]): void {
    const focused = (document.activeElement as HTMLElement | null)?.dataset["quantity"];
    this.clear();
    this.planned = planned;
    this.quantities = quantities;
    this.binding = binding;
    this.draw();
    if (focused !== undefined) this.host.querySelector<HTMLElement>(`[data-quantity="${focused}"]`)?.focus();
  }

  private draw(): void {
    const planned = this.planned!;
    for (const chart of this.charts) chart.destroy();
    this.charts = [];
    const quantity = this.quantities.find(({ key }) => key === this.shown) ?? this.quantities[0]!;
    const { time } = planned.plan.trajectory;
    const duration = time.at(-1) ?? 0;
    const hosts = quantity.signals.map(() => h("div", { class: "chart" }));
    this.cells.clear();
    const rows = quantity.signals.map((signal, i) => this.row(quantity, signal, hosts[i]!));
    this.host.replaceChildren(
      h("div", { class: "plot-top" }, h("h2", {}, "Over time"),
        h("div", { class: "actions tight", role: "group", "aria-label": "Quantity" },
          ...this.quantities.map(({ key, title }) => h("button", {
            type: "button", "data-quantity": key, "aria-pressed": String(key === quantity.key),
            onclick: () => { this.choose(key); },
          }, title))),
        h("button", { type: "button", onclick: () => this.zoom(0, duration) }, "Whole motion")),
      this.band(duration), ...this.states(planned), ...rows);
    const wide = quantity.key !== "q";
    const marks = planned.plan.waypoints.time;
    this.charts = quantity.signals.map((signal, i) => new Chart(hosts[i]!, {
      time, wide, marks,
      values: signal.values.map((value) => (value === null ? null : value * scale(signal.unit))),
      limit: {
        lower: signal.limit.lower === null ? null : signal.limit.lower * scale(signal.unit),
        upper: signal.limit.upper === null ? null : signal.limit.upper * scale(signal.unit),
      },
    }, { seek: this.seek, zoom: (from, to) => this.zoom(from, to) }));
  }

  private choose(key: string): void {
    this.shown = key;
    this.draw();
    this.host.querySelector<HTMLElement>(`[data-quantity="${key}"]`)?.focus();
    this.seek(this.at);
  }

  private at = 0;

  /** Moves the cursor. */
  update(time: number, moment: Moment): void {
    if (this.planned === null) return;
    this.at = time;
    for (const chart of this.charts) chart.setTime(time);
    const { joint_names: names, joint_units: units } = this.planned.plan;
    for (const [j, name] of names.entries()) {
      for (const [order, rate] of RATES.entries()) {
        const cell = this.cells.get(`${rate}-${name}`);
        if (cell === undefined) continue;
        cell.textContent = jointText(moment[rate][j]!, units[j]!, order as 0 | 1 | 2);
        cell.dataset["value"] = String(moment[rate][j]!);
      }
    }
    const k = this.planned.motion.index(time);
    for (const { key, signals } of this.quantities) {
      for (const signal of signals) {
        const cell = this.cells.get(`${key}:${signal.name}`);
        const value = signal.values[k];
        if (cell !== undefined) cell.textContent = value == null ? "–" : text(value, signal.unit);
      }
    }
    const now = this.binding[k];
    if (this.nowBinding !== null && now !== undefined) {
      this.nowBinding.textContent = now.name === "" ? `none (${shareText(now.share)} of a limit at most)`
        : `${now.name}, ${shareText(now.share)}`;
    }
  }

  /** Joint values of the moment, for all quantities at once. */
  private states(planned: Planned): HTMLElement[] {
    const { joint_names: names, joint_units: units } = planned.plan;
    const unit = (order: 0 | 1 | 2): string => [...new Set(units)].map((u) => unitName(u, order)).join(", ");
    const cell = (name: string, rate: string): HTMLElement => {
      const output = h("output", { "data-joint": name, "data-kind": rate });
      this.cells.set(`${rate}-${name}`, output);
      return h("td", {}, output);
    };
    return [h("details", { class: "states" }, h("summary", {}, "Values now"),
      h("table", { class: "plot-head" },
        h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Joint"),
          ...(["Position", "Velocity", "Acceleration"] as const).map((title, i) =>
            h("th", { scope: "col" }, `${title} [${unit(i as 0 | 1 | 2)}]`)))),
        h("tbody", {}, ...names.map((name) => h("tr", {}, h("th", { scope: "row" }, name),
          ...RATES.map((rate) => cell(name, rate)))))))];
  }

  private row(quantity: Quantity, signal: Signal, chart: HTMLElement): HTMLElement {
    const value = h("output", {});
    this.cells.set(`${quantity.key}:${signal.name}`, value);
    const { lower, upper } = signal.limit;
    const bounds = [lower, upper].filter((bound) => bound !== null).map((bound) => text(bound, signal.unit));
    const peak = signal.values.reduce<number>((most, v) => (Math.abs(v ?? 0) > Math.abs(most) ? v! : most), 0);
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${quantity.title} of ${signal.name}: at most ${text(peak, signal.unit)} `
      + `${unitText(signal.unit)}${bounds.length === 0 ? "" : `, limits ${bounds.join(" to ")}`}`);
    return h("div", { class: "plot-row", "data-signal": signal.name },
      h("div", { class: "plot-name" }, h("h3", {}, signal.name), value, h("span", { class: "hint" }, unitText(signal.unit)),
        bounds.length === 0 ? "" : h("span", { class: "hint" }, `limit ${bounds.join(" … ")}`)),
      chart);
  }

  /** Which limit the motion is at, over time. */
  private band(duration: number): HTMLElement {
    const { time } = this.planned!.plan.trajectory;
    const names = [...new Set(this.binding.map(({ name }) => name).filter((name) => name !== ""))];
    const strip = h("div", { class: "band-strip", "aria-hidden": "true" });
    let first = 0;
    for (let k = 1; k <= time.length; k += 1) {
      if (k < time.length && this.binding[k]!.name === this.binding[first]!.name) continue;
      const { name } = this.binding[first]!;
      const end = time[Math.min(k, time.length - 1)]!;
      const part = h("span", { title: name === "" ? "no limit binds" : name });
      part.style.width = `${((end - time[first]!) / Math.max(duration, 1e-9)) * 100}%`;
      if (name !== "") part.style.background = LINES[names.indexOf(name) % LINES.length]!;
      strip.append(part);
      first = k;
    }
    strip.addEventListener("click", (event) => {
      const box = strip.getBoundingClientRect();
      this.seek(((event.clientX - box.left) / box.width) * duration);
    });
    this.nowBinding = h("output", {});
    return h("div", { class: "band" }, h("span", { class: "hint" }, "Binding limit now: ", this.nowBinding), strip,
      h("ul", { class: "band-names" }, ...names.map((name, i) => {
        const dot = h("span", { class: "dot", "aria-hidden": "true" });
        dot.style.background = LINES[i % LINES.length]!;
        return h("li", {}, dot, name);
      })));
  }

  private zoom(from: number, to: number): void {
    if (this.zooming) return;
    this.zooming = true;
    for (const chart of this.charts) chart.setZoom(from, to);
    this.host.dataset["zoom"] = `${from} ${to}`;
    this.zooming = false;
  }
}

const scale = ({ base }: Unit): number =>
  (base === "rad" ? scaleOf("angle") : base === "m" ? scaleOf("length") : 1);

const unitText = ({ base, order }: Unit): string =>
  (base === "rad" ? angleUnit() : base === "m" ? lengthUnit() : base) + ["", "/s", "/s²", "/s³"][order];

function text(value: number, unit: Unit): string {
  const shown = value * scale(unit);
  const size = Math.abs(shown);
  return fixed(shown, size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3);
}
