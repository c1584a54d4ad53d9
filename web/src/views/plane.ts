/** f in the plane of incidence: the curves that the polar and the Cartesian plot share, and the axis on which all can be read. */
import { computed, signal } from "@preact/signals";
import { channelOf } from "../plot/colours";
import { axis, number } from "../plot/scale";
import { csvText, type Entry, type Row } from "../plot/save";
import { channel, cosine, scale, type Shown, visible, wi } from "../state";
import { Live, seen } from "./live";
import { colour } from "./theme";

export const curves = new Live("curve", () =>
  seen.polar.value || seen.cartesian.value
    ? visible.value.map((f) => ({ key: String(f.id), shown: f, request: { function: f.text, wi: wi.value, cosine: cosine.value } }))
    : null,
);

/** One line of a plot. */
export interface Line {
  key: string;
  shown: Shown;
  /** Class of its colour. */
  look: string;
  dash: string;
  angles: Float32Array;
  values: Float32Array;
  /** Angle and share of the light that leaves in this one direction. */
  spikes: [number, number][];
}

/** The same as in the command's plots: functions are told apart by more than their colour. */
const DASHES = ["", "7 3", "2 2.5", "9 3 2 3", "12 3", "5 2 1.5 2 1.5 2", "4 4", "1.5 3.5"];
export const dash = (k: number): string => DASHES[k % DASHES.length]!;

const CHANNELS = ["red", "green", "blue"] as const;

export const lines = computed<Line[]>(() => {
  const all: Line[] = [];
  const three = channel.value === "rgb";
  for (const shown of visible.value) {
    const answer = curves.answers.value.get(String(shown.id));
    if (answer === undefined) continue;
    const { angles, values, spikes } = answer.arrays as Record<string, Float32Array>;
    // A direction that light leaves in is one arrow, whatever channels are shown.
    const places: [number, number][] = [];
    for (let k = 0; k + 3 < (spikes?.length ?? 0); k += 4) places.push([spikes![k]!, channelOf(channel.value, spikes!, k + 1)]);
    for (const one of three ? CHANNELS : [channel.value]) {
      const numbers = new Float32Array(angles!.length);
      for (let k = 0; k < numbers.length; k += 1) numbers[k] = channelOf(one, values!, 3 * k);
      all.push({
        key: `${shown.id}-${one}`,
        shown,
        look: three ? `channel-${one}` : `series-${shown.colour}`,
        dash: dash(shown.colour),
        angles: angles!,
        values: numbers,
        spikes: three && one !== "red" ? [] : places,
      });
    }
  }
  return all;
});

/** The newest change that the lines show. */
export const since = computed(() => Math.max(0, ...[...curves.answers.value.values()].map((a) => a.since)));

export const transmits = computed(() => visible.value.some((f) => f.description?.transmits === true));

/** Directions nearer to the horizon than this make no axis longer than three times what the others need: some functions grow without bound there. */
const GRAZING = 5;

/** The axis, and notes on values that are beyond its end or no finite numbers. */
export const valueAxis = computed(() => {
  let [least, most, grazing, gaps] = [Infinity, 0, 0, 0];
  for (const line of lines.value) {
    for (let k = 0; k < line.values.length; k += 1) {
      const value = line.values[k]!;
      if (!Number.isFinite(value)) gaps += 1;
      if (!(value > 0) || value === Infinity) continue;
      grazing = Math.max(grazing, value);
      if (Math.abs(Math.abs(line.angles[k]!) - 90) < GRAZING) continue;
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  }
  const end = scale.value === "log" || grazing < 3 * most || most === 0 ? grazing : most;
  const made = axis(scale.value, least, end);
  const notes = [
    ...(grazing > made.high * (1 + 1e-6) ? [`up to ${number(grazing)} near the horizon: cut off`] : []),
    ...(gaps > 0 ? [`${gaps} ${gaps === 1 ? "value was" : "values were"} not finite: left out`] : []),
  ];
  return { axis: made, notes };
});

/** The angle in the plane that the pointer is at; both plots show it. */
export const looked = signal<number | null>(null);

/** The value of a line at an angle, between its neighbours in proportion. */
export function at({ angles, values }: Line, angle: number): number {
  let [low, high] = [0, angles.length - 1];
  if (high < 1 || angle < angles[0]! || angle > angles[high]!) return NaN;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (angles[middle]! <= angle) low = middle;
    else high = middle;
  }
  const step = angles[high]! - angles[low]!;
  const share = step > 0 ? (angle - angles[low]!) / step : 0;
  return values[low]! + share * (values[high]! - values[low]!);
}

export function legend(): Entry[] {
  const three = channel.value === "rgb";
  const entries = visible.value.map((f) => ({ colour: three ? colour("--ink") : colour(`--series-${f.colour}`), dash: dash(f.colour), text: f.text }));
  const { theta, phi } = wi.value;
  return [...entries, { colour: "none", dash: "", text: `θi = ${theta}°, φi = ${phi}°` }];
}

/** Every function's curve, one below the other: the steps differ, for each is finer where it bends. */
export function table(): string | null {
  const rows: Row[] = [];
  const columns = ["function", "theta_r_deg", "red", "green", "blue"];
  visible.value.forEach((f) => {
    const answer = curves.answers.value.get(String(f.id));
    const { angles, values } = answer?.arrays ?? {};
    for (let k = 0; k < (angles?.length ?? 0); k += 1) rows.push([f.text, angles![k]!, values![3 * k]!, values![3 * k + 1]!, values![3 * k + 2]!]);
  });
  return rows.length > 0 ? csvText(columns, rows) : null;
}

/** The keys of the plane: towards the horizon on the light's side, towards the normal; null for others. */
export function keyedAngle(angle: number, key: string, by: { shift: boolean; alt: boolean }): number | null {
  const step = by.shift ? 10 : by.alt ? 0.1 : 1;
  const moves: Record<string, number> = {
    ArrowLeft: angle - step,
    ArrowRight: angle + step,
    ArrowUp: angle + (angle < 0 ? step : -step),
    ArrowDown: angle + (angle < 0 ? -step : step),
    Home: 0,
  };
  return moves[key] ?? null;
}
