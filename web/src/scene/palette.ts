/** Colours of the scene, for light and dark surroundings. */

import { Color } from "three";

export interface Palette {
  ground: Color;
  gridFine: Color;
  gridCoarse: Color;
  link: Color;
  housing: Color;
  ahead: Color;
  done: Color;
  waypoint: Color;
  fault: Color;
  obstacle: Color;
  carried: Color;
  ghost: Color;
  other: Color;
}

const make = (colours: Record<keyof Palette, string>): Palette =>
  Object.fromEntries(Object.entries(colours).map(([k, v]) => [k, new Color(v)])) as unknown as Palette;

const LIGHT = make({
  ground: "#eef0f2", gridFine: "#dfe3e7", gridCoarse: "#c3cad1", link: "#d5dae0",
  housing: "#4a5560", ahead: "#8d99a5", done: "#0072b2", waypoint: "#0072b2", fault: "#c62a1f",
  obstacle: "#8a6d3b", carried: "#009e73", ghost: "#56626d", other: "#b35900",
});
const DARK = make({
  ground: "#171b1f", gridFine: "#232a30", gridCoarse: "#36404a", link: "#aab3bd",
  housing: "#4f5b67", ahead: "#6d7a87", done: "#56b4e9", waypoint: "#56b4e9", fault: "#ff7a6e",
  obstacle: "#c9a86a", carried: "#4cc9a0", ghost: "#9aa6b1", other: "#ffb066",
});

const dark = matchMedia("(prefers-color-scheme: dark)");

export const palette = (): Palette => (dark.matches ? DARK : LIGHT);

export function onPaletteChange(listener: () => void): void {
  dark.addEventListener("change", listener);
}
