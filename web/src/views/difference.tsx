/** By how much a second function differs from a first: over the directions of reflection, and over the slice. */
import { computed } from "@preact/signals";
import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { Operation } from "../engine/protocol";
import { channelOf, ofDifference } from "../plot/colours";
import { clamp, fromDisc, mirrored, nudged, onDisc } from "../plot/directions";
import type { Size } from "../plot/grid";
import { continueRim } from "../plot/rim";
import { beside, csvText, pngOfCanvas } from "../plot/save";
import { degrees, number, roundUp } from "../plot/scale";
import { type Channel, channel, cosine, difference, phiD, type Shown, wi, wo } from "../state";
import { Bar, BAR } from "./bar";
import { Cell, goTo, LAST } from "./cell";
import { Complaints, Frame } from "./frame";
import { Handle, setWi, setWo } from "./handle";
import { label } from "./label";
import { type Answer, Live, seen, settled } from "./live";
import { paced } from "./pace";
import { Pixels } from "./pictures";
import { complaintsOf } from "./reading";
import { slices } from "./slice";
import { colour } from "./theme";
import { useDrawn } from "./timings";

/** Values along the diameter of the hemisphere: while something moves, and then. */
const COARSE = 72;
const FINE = 256;

/** The two that are compared: those that were chosen, or the first two that are shown. */
const pair = computed<[Shown, Shown] | null>(() => {
  const all = paced.functions.value;
  const chosen = difference.value?.map((id) => all.find((f) => f.id === id)) ?? [];
  const [a = all[0], b = all.find((f) => f.id !== a?.id)] = chosen;
  return a === undefined || b === undefined || a.id === b.id ? null : [a, b];
});

const hemispheres = new Live("hemisphere", () =>
  seen.difference.value
    ? (pair.value ?? []).map((f) => ({
        key: String(f.id),
        shown: f,
        request: { function: f.text, wi: paced.wi.value, size: settled.value ? FINE : COARSE, cosine: cosine.value },
        fine: settled.value,
      }))
    : null,
);

/** Differences over a square of values; NaN where there are no directions. */
interface Field {
  side: number;
  values: Float32Array;
  /** Index of the largest; −1 where there is none. */
  largest: number;
}

function field(a: Float32Array, b: Float32Array, side: number, which: Channel): Field {
  const values = new Float32Array(side * side);
  let [largest, size] = [-1, -1];
  for (let k = 0; k < values.length; k += 1) {
    const x = channelOf(which, a, 3 * k);
    const y = channelOf(which, b, 3 * k);
    const most = Math.max(Math.abs(x), Math.abs(y));
    const share = most === 0 ? 0 : (y - x) / most;
    values[k] = share;
    if (Math.abs(share) > size && Number.isFinite(share)) [largest, size] = [k, Math.abs(share)];
  }
  return { side, values, largest };
}

/** A field that is made anew only when one of the two answers is another: each of the two views' signals changes more often than that. */
function kept(): (a: Float32Array, b: Float32Array, side: number) => Field {
  let last: { a: Float32Array; b: Float32Array; which: Channel; field: Field } | null = null;
  return (a, b, side) => {
    const which = channel.value;
    if (last?.a !== a || last.b !== b || last.which !== which) last = { a, b, which, field: field(a, b, side, which) };
    return last.field;
  };
}
const [overSphere, overSlice] = [kept(), kept()];

const answers = <K extends Operation>(live: Live<K>): (Answer<K> | undefined)[] => (pair.value ?? []).map((f) => live.answers.value.get(String(f.id)));

const sphere = computed<Field | null>(() => {
  const [a, b] = answers(hemispheres);
  return a && b && a.request.size === b.request.size ? overSphere(a.arrays["values"]!, b.arrays["values"]!, a.request.size) : null;
});

const slice = computed<Field | null>(() => {
  const [a, b] = answers(slices);
  return a && b && a.request.phi_d === b.request.phi_d ? overSlice(a.arrays["values"]!, b.arrays["values"]!, a.answer.side) : null;
});

/** The difference at the end of the scale. */
const end = computed(() => {
  const most = Math.max(0, ...[sphere.value, slice.value].map((f) => (f === null || f.largest < 0 ? 0 : Math.abs(f.values[f.largest]!))));
  return most === 0 ? 1 : Math.min(1, roundUp(most));
});

const painters = new WeakMap<Field, { end: number; paint: (out: Uint8ClampedArray) => void }>();

function painted(of: Field): (out: Uint8ClampedArray) => void {
  const last = end.value;
  const before = painters.get(of);
  if (before?.end === last) return before.paint;
  const paint = (out: Uint8ClampedArray): void => {
    for (let k = 0; k < of.values.length; k += 1) {
      if (Number.isNaN(of.values[k]!)) continue;
      const [red, green, blue] = ofDifference(of.values[k]! / last);
      out[4 * k] = red;
      out[4 * k + 1] = green;
      out[4 * k + 2] = blue;
      out[4 * k + 3] = 255;
    }
    if (of === sphere.peek()) continueRim(out, of.side);
  };
  painters.set(of, { end: last, paint });
  return paint;
}

export function Difference(): JSX.Element {
  const body = useRef<HTMLDivElement>(null);
  return (
    <Frame
      view="difference"
      title="Difference"
      about="(f₂ − f₁) / max(|f₁|, |f₂|): red where the second function is larger, blue where it is smaller. Left: all directions of reflection, seen from above, the normal in the middle. Right: the slice of half and difference angles. Click, or move the viewer or the cell with the arrow keys, to look at a direction."
      many
      controls={pair.value !== null && <Choice pair={pair.value} />}
      saves={{
        png: () => {
          const canvases = [...(body.current?.querySelectorAll<HTMLCanvasElement>(".picture-place canvas") ?? [])];
          return canvases.length > 0 ? pngOfCanvas(beside(canvases, colour("--surface"))) : null;
        },
        csv: table,
      }}
    >
      {(size) => (
        <div ref={body}>
          {pair.value === null ? <p class="view-empty">Two functions that are shown are compared here.</p> : <Drawing size={size} pair={pair.value} />}
          <Complaints of={[...complaintsOf(hemispheres, paced.functions.value), ...complaintsOf(slices, paced.functions.value)].slice(0, 2)} />
        </div>
      )}
    </Frame>
  );
}

function Choice({ pair: [a, b] }: { pair: [Shown, Shown] }): JSX.Element {
  const select = (name: string, value: Shown, set: (id: number) => void): JSX.Element => (
    <select class={`view-select series-${value.colour}`} aria-label={name} value={value.id} onChange={(event) => set(Number(event.currentTarget.value))}>
      {paced.functions.value.map((f) => (
        <option key={f.id} value={f.id}>
          {label(f)}
        </option>
      ))}
    </select>
  );
  // Choosing the other one exchanges the two.
  return (
    <div class="choice">
      {select("First function", a, (id) => (difference.value = id === b.id ? [b.id, a.id] : [id, b.id]))}
      <span>→</span>
      {select("Second function", b, (id) => (difference.value = id === a.id ? [b.id, a.id] : [a.id, id]))}
    </div>
  );
}

function Drawing({ size, pair: [a, b] }: { size: Size; pair: [Shown, Shown] }): JSX.Element {
  useDrawn("difference", Math.max(0, ...answers(hemispheres).map((x) => x?.since ?? 0)));
  const below = 40;
  const upright = size.height > 1.3 * size.width;
  const side = Math.floor(Math.max(40, upright ? Math.min(size.width - BAR - 24, (size.height - 2 * below - 40) / 2) : Math.min((size.width - BAR - 36) / 2, size.height - below - 32)));
  const colourAt = (p: number): [number, number, number] => ofDifference(2 * p - 1);
  return (
    <div class={`difference${upright ? " upright" : ""}`}>
      {sphere.value !== null && (
        <Panel name="Reflection" round field={sphere.value} side={side} place={placeOnDisc(sphere.value)} over={<Disc side={side} field={sphere.value} />} words={`Difference of ${b.text} from ${a.text} over the directions of reflection`} />
      )}
      {slice.value !== null && (
        <Panel name={`Slice, φd = ${phiD.value}°`} field={slice.value} side={side} place={placeOnSlice(slice.value)} over={<Edge side={side} field={slice.value} />} words={`Difference of ${b.text} from ${a.text} over the slice`} />
      )}
      {(sphere.value ?? slice.value) !== null && (
        <div class="bar-place" style={{ top: "26px" }}>
          <Bar height={Math.max(60, Math.min(side, size.height - 80))} name="differences" ticks={[-1, -0.5, 0, 0.5, 1].map((t) => ({ position: (t + 1) / 2, label: percent(t * end.value) }))} colourAt={colourAt} />
        </div>
      )}
    </div>
  );
}

const inWords = (share: number): string => (Number.isFinite(share) ? `difference ${percent(share)}` : "no value");

const percent = (x: number): string => `${x > 0 ? "+" : ""}${number(100 * x, 2)} %`;

interface Place {
  words: string;
  go: () => void;
}

interface PanelProps {
  name: string;
  field: Field;
  side: number;
  place: Place | null;
  over: JSX.Element;
  words: string;
  round?: boolean;
}

function Panel({ name, field, side: shown, place, over, words, round = false }: PanelProps): JSX.Element {
  const { side, largest, values } = field;
  return (
    <figure class="picture">
      <figcaption class="picture-name">{name}</figcaption>
      <div class={round ? "picture-place round" : "picture-place"} style={{ width: `${shown}px`, height: `${shown}px` }}>
        <Pixels picture={{ width: side, height: side, paint: painted(field), words }} cell={{ width: shown, height: shown }} />
        {over}
      </div>
      {place !== null && (
        <button type="button" class="largest" style={{ maxWidth: `${shown}px` }} title={`Go to the largest difference: ${place.words}`} onClick={place.go}>
          largest {percent(values[largest]!)}
          <br />
          {place.words}
        </button>
      )}
    </figure>
  );
}

function placeOnDisc({ side, largest }: Field): Place | null {
  if (largest < 0) return null;
  const at = (k: number): number => (2 * (k + 0.5)) / side - 1;
  const angles = fromDisc("equidistant", at(largest % side), -at(Math.floor(largest / side)));
  return { words: `θr ${degrees(angles.theta)}, φr ${degrees(angles.phi)}`, go: () => setWo(angles) };
}

function placeOnSlice({ side, largest }: Field): Place | null {
  if (largest < 0) return null;
  const node = (k: number): number => (k * LAST) / (side - 1);
  const [thetaH, thetaD] = [node(largest % side), node(side - 1 - Math.floor(largest / side))];
  return { words: `θh ${degrees(thetaH)}, θd ${degrees(thetaD)}`, go: () => void goTo(thetaH, thetaD) };
}

/** The hemisphere's grid, with the directions of light and view. */
function Disc({ side, field }: { side: number; field: Field }): JSX.Element {
  const half = side / 2;
  const at = (x: number, y: number): [number, number] => [x / half - 1, 1 - y / half];
  const put = (v: [number, number]): { x: number; y: number } => ({ x: half + half * v[0], y: half - half * v[1] });
  const given = wo.value !== null && wo.value.theta <= 90;
  // With no direction of view the keys begin at the mirror's.
  const view = given ? wo.value! : mirrored(wi.value);
  const value = (): number => {
    const [x, y] = onDisc("equidistant", view);
    const pixel = (share: number): number => clamp(Math.floor(((share + 1) / 2) * field.side), 0, field.side - 1);
    return field.values[pixel(-y) * field.side + pixel(x)]!;
  };
  return (
    <svg
      class="over plot"
      viewBox={`0 0 ${side} ${side}`}
      width={side}
      height={side}
      role="group"
      aria-label="Directions of reflection from above"
      onClick={(event) => {
        if ((event.target as Element).closest(".handle") !== null) return;
        const box = event.currentTarget.getBoundingClientRect();
        setWo(fromDisc("equidistant", ...at(event.clientX - box.left, event.clientY - box.top)));
      }}
    >
      {[30, 60].map((t) => (
        <circle key={t} class="over-grid" cx={half} cy={half} r={(t / 90) * half} />
      ))}
      <circle class="rim" cx={half} cy={half} r={half - 0.5} />
      <Handle
        which="viewer"
        unset={!given}
        {...put(onDisc("equidistant", view))}
        angles={view}
        words={inWords(value())}
        moved={(x, y) => setWo(fromDisc("equidistant", ...at(x, y), view.phi))}
        keyed={(key, by) => {
          const next = nudged(view, key, by, 90);
          if (next !== null) setWo(next);
          return next !== null;
        }}
      />
      <Handle
        which="light"
        {...put(onDisc("equidistant", wi.value))}
        angles={wi.value}
        moved={(x, y) => setWi(fromDisc("equidistant", ...at(x, y), wi.value.phi))}
        keyed={(key, by) => {
          const next = nudged(wi.value, key, by);
          if (next !== null) setWi(next);
          return next !== null;
        }}
      />
    </svg>
  );
}

function Edge({ side, field }: { side: number; field: Field }): JSX.Element {
  return (
    <svg
      class="over plot"
      viewBox={`0 0 ${side} ${side}`}
      width={side}
      height={side}
      role="group"
      aria-label="Half angle θh to the right, difference angle θd upwards"
      onClick={(event) => {
        const box = event.currentTarget.getBoundingClientRect();
        const node = (share: number): number => Math.round(clamp(share, 0, 1) * (field.side - 1));
        const index = node((event.clientY - box.top) / side) * field.side + node((event.clientX - box.left) / side);
        placeOnSlice({ ...field, largest: index })?.go();
      }}
    >
      <rect class="rim" x={0.5} y={0.5} width={side - 1} height={side - 1} />
      <text class="over-text" x={side - 4} y={side - 6} text-anchor="end">
        θh →
      </text>
      <text class="over-text" x={4} y={13}>
        θd ↑
      </text>
      <Cell size={side} nodes={field.side} name="difference of the slices" read={(index) => inWords(field.values[index]!)} />
    </svg>
  );
}

function table(): string | null {
  if (sphere.value === null) return null;
  const { side, values } = sphere.value;
  const rows: number[][] = [];
  for (let k = 0; k < values.length; k += 1) {
    if (Number.isNaN(values[k]!)) continue;
    const at = (n: number): number => (2 * (n + 0.5)) / side - 1;
    const { theta, phi } = fromDisc("equidistant", at(k % side), -at(Math.floor(k / side)));
    rows.push([theta, phi, values[k]!]);
  }
  return csvText(["theta_r_deg", "phi_r_deg", "relative_difference"], rows);
}
