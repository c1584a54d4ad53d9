/** Axes of values: which value stands where, and which are written beside them. The conventions are those of the command's plots. */
import { scaleLinear, scaleLog, scalePow } from "d3-scale";
import type { Scale } from "../state";

export interface Tick {
  value: number;
  /** From 0 at the beginning of the axis to 1 at its end. */
  position: number;
  /** Nothing where there is only a line. */
  label: string;
}

/** An axis from 0 (or from a power of ten) to a round number. */
export interface Axis {
  kind: Scale;
  low: number;
  high: number;
  /** 0 at the beginning, 1 at the end; values outside stand at the nearer end, NaN stays NaN. */
  position(value: number): number;
  /** The inverse of `position`. */
  value(position: number): number;
  ticks: Tick[];
}

/** Decades that a logarithmic axis has at most. */
const DECADES = 10;

/** The exponent of the largest power of ten that is not above `value` > 0. */
function exponent(value: number): number {
  const e = Math.floor(Math.log10(value));
  // A logarithm may be off by rounding at a power of ten.
  return tenTo(e + 1) <= value ? e + 1 : e;
}

/** Read, not computed: exact. */
const tenTo = (e: number): number => Number(`1e${e}`);

/** The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is not below `value` > 0. */
export function roundUp(value: number): number {
  const e = exponent(value);
  const lead = [1, 1.5, 2, 3, 4, 5, 6, 8].find((x) => x * tenTo(e) >= value * (1 - 1e-9)) ?? 10;
  return Number(`${lead}e${e}`);
}

/** An axis that holds values up to `most`; the smallest positive one of interest is `least`. */
export function axis(kind: Scale, least: number, most: number): Axis {
  const top = Number.isFinite(most) && most > 0 ? most : 1;
  return kind === "log" ? logarithmic(least, top) : kind === "cube-root" ? cubeRoot(roundUp(top)) : linear(roundUp(top));
}

function linear(high: number): Axis {
  const scale = scaleLinear().domain([0, high]).clamp(true);
  // 1.5, 3 and 6 in thirds, 5 in fifths, the others in quarters.
  const lead = Math.round((2 * high) / tenTo(exponent(high * (1 + 1e-9))));
  const parts = [3, 6, 12].includes(lead) ? 3 : lead === 10 ? 5 : 4;
  const values = Array.from({ length: parts + 1 }, (_, k) => (high * k) / parts);
  return make("linear", 0, high, scale, values, values);
}

function cubeRoot(high: number): Axis {
  const scale = scalePow().exponent(1 / 3).domain([0, high]).clamp(true);
  const decades: number[] = [];
  // Not so near the end that the labels touch, nor so near 0 that the lines do.
  for (let e = exponent(high * 0.6); scale(tenTo(e)) > 0.12; e -= 1) decades.unshift(tenTo(e));
  const values = [0, ...decades, high];
  return make("cube-root", 0, high, scale, values, values);
}

function logarithmic(least: number, most: number): Axis {
  const top = exponent(most * (1 - 1e-9)) + 1;
  const bottom = least > 0 && Number.isFinite(least) ? exponent(least * (1 + 1e-9)) : top - DECADES;
  const first = clampTo(bottom, top - DECADES, top - 1);
  const scale = scaleLog().domain([tenTo(first), tenTo(top)]).clamp(true);
  const decades: number[] = [];
  const values: number[] = [];
  for (let e = first; e <= top; e += 1) {
    decades.push(tenTo(e));
    values.push(tenTo(e));
    if (e < top && top - first <= 6) for (let k = 2; k < 10; k += 1) values.push(k * tenTo(e));
  }
  return make("log", tenTo(first), tenTo(top), scale, values, decades);
}

const clampTo = (x: number, low: number, high: number): number => Math.min(Math.max(x, low), high);

type Mapping = { (value: number): number; invert(position: number): number };

/** Axes that were made: the same one is the same object, so that what is drawn from it isn't drawn anew. */
const made = new Map<string, Axis>();
const KEPT = 200;

function make(kind: Scale, low: number, high: number, scale: Mapping, values: number[], labelled: number[]): Axis {
  const key = `${kind} ${low} ${high}`;
  const before = made.get(key);
  if (before !== undefined) return before;
  const decades = Math.log(high / low);
  // In one expression: pictures ask for the places of tens of thousands of values. NaN stays NaN.
  const place = {
    linear: (value: number) => value / high,
    "cube-root": (value: number) => Math.cbrt(value / high),
    // A logarithm has no place for what is not positive: it stands at the beginning.
    log: (value: number) => Math.log(Math.max(value, low) / low) / decades,
  }[kind];
  const position = (value: number): number => Math.min(Math.max(place(value), 0), 1);
  const named = new Set(labelled);
  const ticks = values.map((value) => ({ value, position: position(value), label: named.has(value) ? number(value) : "" }));
  const axis: Axis = { kind, low, high, position, value: (p) => scale.invert(p), ticks };
  if (made.size >= KEPT) made.clear();
  made.set(key, axis);
  return axis;
}

const SMALL = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const superscript = (digits: string): string => digits.replace(/[0-9-]/g, (c) => (c === "-" ? "⁻" : (SMALL[Number(c)] ?? c)));

/** `x` with `digits` significant digits; as a power of ten where it is tiny or huge: 0.32, 1200, 4.5 × 10⁶, 10⁻⁴. */
export function number(x: number, digits = 3): string {
  if (x === 0) return "0";
  if (!Number.isFinite(x)) return Number.isNaN(x) ? "not a number" : x > 0 ? "∞" : "−∞";
  const rounded = Number(x.toPrecision(digits));
  const sign = rounded < 0 ? "−" : "";
  const size = Math.abs(rounded);
  if (size >= 1e-3 && size < 1e5) return `${sign}${size}`;
  const [lead = "1", power = "0"] = size.toExponential().split("e");
  const raised = superscript(power.replace("+", ""));
  return lead === "1" ? `${sign}10${raised}` : `${sign}${lead} × 10${raised}`;
}

/** `x` for a column of figures: always `digits` significant digits, so that they align. */
export function aligned(x: number, digits = 5): string {
  if (!Number.isFinite(x)) return number(x);
  const size = Math.abs(x);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? x.toExponential(digits - 1) : x.toPrecision(digits);
  const [lead = text, power] = text.split("e");
  const minus = lead.replace("-", "−");
  return power === undefined ? minus : `${minus} × 10${superscript(power.replace("+", ""))}`;
}

/** An angle, to a tenth of a degree. */
export const degrees = (x: number): string => `${(Math.round(x * 10) / 10 || 0).toFixed(1).replace("-", "−")}°`;
