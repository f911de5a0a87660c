/** A scale of colours for figures along the path: even in lightness, and told apart by everyone. */

import { Color } from "three";

import type { Quantity } from "./signals";
import { shareOf } from "./signals";

/** Viridis at five places. */
const STOPS = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"].map((colour) => new Color(colour));

/** The colour of a share from 0 to 1. */
export function colourOf(share: number): Color {
  const at = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1);
  const first = Math.min(Math.floor(at), STOPS.length - 2);
  return STOPS[first]!.clone().lerp(STOPS[first + 1]!, at - first);
}

/** One colour a sample for a quantity: by its limits, else by its own largest value. */
export function coloursOf(quantity: Quantity, samples: number): number[] {
  const { signals } = quantity;
  const largest = signals.map(({ values }) => Math.max(...values.map((value) => Math.abs(value ?? 0)), 1e-12));
  return Array.from({ length: samples }, (_, k) => {
    const shares = signals.map((signal, i) =>
      quantity.key === "clearance" ? 1 - (signal.values[k] ?? largest[i]!) / largest[i]! : shareOf(signal, k) ?? Math.abs(signal.values[k] ?? 0) / largest[i]!);
    return colourOf(Math.max(...shares)).toArray() as number[];
  }).flat();
}

/** Colours that tell lines and bands apart, in light and dark surroundings. */
export const LINES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b08a00", "#56b4e9", "#7a5cc0", "#8c564b"];
