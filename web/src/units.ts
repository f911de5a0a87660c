/** Showing numbers: documents are in radians and metres, people may prefer degrees. */

export type AngleUnit = "deg" | "rad";
export type JointUnit = "rad" | "m";

export type LengthUnit = "m" | "mm";

let angle: AngleUnit = "deg";
let length: LengthUnit = "m";

export const lengthUnit = (): LengthUnit => length;

export function setLengthUnit(unit: LengthUnit): void {
  length = unit;
}

/** How many of the unit shown are one of the document's. */
export const scaleOf = (kind: "length" | "angle"): number =>
  kind === "length" ? (length === "mm" ? 1000 : 1) : angle === "deg" ? 180 / Math.PI : 1;

/** A length in the unit shown, to a tenth of a millimetre. */
export const metresText = (metres: number): string =>
  length === "mm" ? fixed(metres * 1000, 1) : fixed(metres, 4);

export const angleUnit = (): AngleUnit => angle;

export function setAngleUnit(unit: AngleUnit): void {
  angle = unit;
}

/** A joint value in the unit shown. */
export function shown(value: number, unit: JointUnit): number {
  return unit === "rad" && angle === "deg" ? (value * 180) / Math.PI : value;
}

/** The unit shown, per second for the first derivative and so on. */
export function unitName(unit: JointUnit, order: 0 | 1 | 2 = 0): string {
  const name = unit === "m" ? "m" : angle;
  return name + ["", "/s", "/s²"][order];
}

/** A joint value as text, with as many digits as make sense in its unit. */
export function jointText(value: number, unit: JointUnit, order: 0 | 1 | 2 = 0): string {
  const inDegrees = unit === "rad" && angle === "deg";
  return fixed(shown(value, unit), inDegrees ? (order === 0 ? 2 : 1) : 3);
}

/** A number with so many decimals, with a true minus sign and no minus zero. */
export function fixed(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** A small length, in the unit that fits. */
export function lengthText(metres: number): string {
  const size = Math.abs(metres);
  if (size >= 0.1) return `${fixed(metres, 3)} m`;
  if (size >= 1e-4) return `${(metres * 1e3).toPrecision(3)} mm`;
  if (size >= 1e-7) return `${(metres * 1e6).toPrecision(2)} µm`;
  return size === 0 ? "0 mm" : "< 0.1 µm";
}

/** A small angle, in the unit shown. */
export function angleText(radians: number): string {
  const value = shown(radians, "rad");
  const size = Math.abs(value);
  const digits = size === 0 ? "0" : size < 1e-6 ? "< 1e-6" : value.toPrecision(2);
  return `${digits} ${angle}`;
}

/** A share of a limit, never rounded down: 100.0 % must not stand for more. */
export function shareText(ratio: number): string {
  return `${(Math.ceil(ratio * 1000 - 1e-6) / 10).toFixed(1)} %`;
}

export function timeText(seconds: number): string {
  return `${seconds.toFixed(3)} s`;
}
