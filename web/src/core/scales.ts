/** Sliders and swatches: where a value lies on its control, and back. */

/** Ranges of more than two decades (exponents, indices of metals) are drawn so that small values have room too. */
function bent(low: number, high: number): boolean {
  return low >= 0 && high - low > 100;
}

/** Curvature of such a slider: its middle is at about a hundredth of the range for 0…10 000. */
function knee(low: number, high: number): number {
  return low > 0 ? low : Math.sqrt(high) / 10;
}

/** 0…1 for a value of low…high. */
export function position(x: number, low: number, high: number): number {
  const clamped = Math.min(Math.max(x, low), high);
  if (!bent(low, high)) return high > low ? (clamped - low) / (high - low) : 0;
  const k = knee(low, high);
  return Math.log1p((clamped - low) / k) / Math.log1p((high - low) / k);
}

/** The value at 0…1, rounded to what a step of the slider means. */
export function value(at: number, low: number, high: number): number {
  if (at <= 0) return low;
  if (at >= 1) return high;
  if (!bent(low, high)) return Number((low + at * (high - low)).toPrecision(4));
  const k = knee(low, high);
  return Math.min(high, Number((low + k * Math.expm1(at * Math.log1p((high - low) / k))).toPrecision(3)));
}

/** sRGB's transfer curve (IEC 61966-2-1), for swatches: descriptions are linear, screens are not. */
function encode(x: number): number {
  const c = Math.min(Math.max(x, 0), 1);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
}
function decode(x: number): number {
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
}

export function toHex(rgb: readonly [number, number, number]): string {
  return `#${rgb.map((x) => Math.round(encode(x) * 255).toString(16).padStart(2, "0")).join("")}`;
}

/** Linear, to four digits: as fine as eight bits are. */
export function fromHex(hex: string): [number, number, number] {
  const at = (i: number): number => Number(decode(parseInt(hex.slice(i, i + 2), 16) / 255).toPrecision(4));
  return [at(1), at(3), at(5)];
}
