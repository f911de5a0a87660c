/** One signal over time with its limits: uPlot with the page's cursor, zoomed together with others. */

import uPlot from "uplot";

import { h } from "../dom";
import type { Range } from "../limits";

export interface Look {
  time: number[];
  values: (number | null)[];
  limit: Range;
  /** Whether the limits are part of what is seen; else only where the values come near them. */
  wide: boolean;
  marks: number[];
}

const HEIGHT = 96;
const MOVED_PX = 4;

export class Chart {
  private readonly plot: uPlot;
  private readonly line = h("div", { class: "now", "aria-hidden": "true" });
  private now = 0;
  private from = 0;

  constructor(
    private readonly host: HTMLElement, look: Look,
    private readonly hooks: { seek: (time: number) => void; zoom: (from: number, to: number) => void },
  ) {
    const style = getComputedStyle(host);
    const colour = (name: string): string => style.getPropertyValue(name).trim();
    const axis = { stroke: colour("--soft"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, font: "10px system-ui" };
    this.plot = new uPlot({
      width: Math.max(host.clientWidth, 60), height: HEIGHT,
      legend: { show: false },
      cursor: { sync: { key: "ikplan" }, drag: { x: true, y: false, dist: MOVED_PX }, points: { size: 5 } },
      scales: { x: { time: false }, y: { range: (_, low, high) => rangeOf(look, low, high) } },
      axes: [{ ...axis, size: 20, gap: 2 }, { ...axis, size: 46, gap: 3, space: 26 }],
      series: [{}, { stroke: colour("--accent"), width: 1.5, points: { show: false } }],
      hooks: {
        draw: [(plot) => this.drawMarks(plot, look, colour)],
        setScale: [(plot, key) => {
          const { min, max } = plot.scales["x"]!;
          if (key === "x" && min != null && max != null) this.hooks.zoom(min, max);
        }],
      },
    }, [look.time, look.values] as uPlot.AlignedData, host);
    const { over } = this.plot;
    over.append(this.line);
    over.addEventListener("pointerdown", (event) => { this.from = event.clientX; });
    over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - this.from) > MOVED_PX) return; // that was a zoom
      this.hooks.seek(this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
    });
  }

  resize(): void {
    const width = this.host.clientWidth;
    if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
  }

  setZoom(from: number, to: number): void {
    const { min, max } = this.plot.scales["x"]!;
    if (min !== from || max !== to) this.plot.setScale("x", { min: from, max: to });
  }

  setTime(time: number): void {
    this.now = time;
    this.placeNow();
  }

  destroy(): void {
    this.plot.destroy();
  }

  private drawMarks(plot: uPlot, { limit, marks }: Look, colour: (name: string) => string): void {
    const { ctx, bbox: { left, top, width, height } } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    const line = (x1: number, y1: number, x2: number, y2: number): void => {
      ctx.beginPath();
      ctx.moveTo(x1, y1);
      ctx.lineTo(x2, y2);
      ctx.stroke();
    };
    ctx.lineWidth = devicePixelRatio;
    ctx.strokeStyle = colour("--bad");
    ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
    for (const bound of [limit.lower, limit.upper]) {
      if (bound === null) continue;
      const y = plot.valToPos(bound, "y", true);
      line(left, y, left + width, y);
    }
    ctx.setLineDash([]);
    ctx.strokeStyle = colour("--soft");
    for (const mark of marks) {
      const x = plot.valToPos(mark, "x", true);
      line(x, top + height - 5 * devicePixelRatio, x, top + height);
    }
    ctx.restore();
    this.placeNow();
  }

  /** Moves the line of the time shown, without drawing the plot anew. */
  private placeNow(): void {
    const { over } = this.plot ?? {};
    if (over === undefined) return; // the plot draws itself once while it is made
    const x = this.plot.valToPos(this.now, "x");
    this.line.hidden = !(x >= 0 && x <= over.clientWidth);
    this.line.style.transform = `translateX(${x}px)`;
  }
}

/** What is seen of the values' axis. */
function rangeOf({ limit, wide }: Look, low: number, high: number): [number, number] {
  let [least, most] = [low ?? 0, high ?? 0];
  if (wide) {
    least = Math.min(least, limit.lower ?? least);
    most = Math.max(most, limit.upper ?? most);
  }
  // Rounding of a joint that stands still is no motion.
  const room = Math.max((most - least) * 0.07, 1e-4 * Math.max(Math.abs(least), Math.abs(most)), 1e-9);
  return [least - room, most + room];
}
