/** The slice: f as a picture, by the angle θh of the half vector and the angle θd between it and the light (Rusinkiewicz 1998). */
import { computed, signal } from "@preact/signals";
import type { ComponentChildren, JSX } from "preact";
import { useRef } from "preact/hooks";
import { channelOf, ofValue, paintValues } from "../plot/colours";
import { clamp } from "../plot/directions";
import type { Size } from "../plot/grid";
import { beside, csvText, pngOfCanvas, type Row } from "../plot/save";
import { type Axis, axis, number } from "../plot/scale";
import { type Channel, channel, phiD, type Scale, type Shown } from "../state";
import { Bar, BAR } from "./bar";
import { Complaints, Frame } from "./frame";
import { Cell, goTo, LAST } from "./cell";
import { follow } from "./handle";
import { label } from "./label";
import { type Answer, Live, seen } from "./live";
import { paced } from "./pace";
import { type Picture, Pictures } from "./pictures";
import { complaintsOf } from "./reading";
import { colour } from "./theme";
import { useDrawn } from "./timings";

export const slices = new Live("slice", () =>
  seen.slice.value || seen.difference.value ? paced.functions.value.map((f) => ({ key: String(f.id), shown: f, request: { function: f.text, phi_d: phiD.value } })) : null,
);

/** A slice spans more than any linear scale shows: it has a scale of its own. */
const kind = signal<Scale>("log");

/** Room for the axes. */
const LEFT = 40;
const BELOW = 34;
/** The share of the values below its end, and above its beginning, that the scale holds; the few others, at grazing angles, have the colours of its ends. */
const HELD = 0.98;

/** Each few of the values, without what is 0 or not finite, in order: enough for the ends of a scale. */
function positive(values: Float32Array, which: Channel): Float32Array {
  const numbers = new Float32Array(Math.ceil(values.length / STRIDE));
  let count = 0;
  for (let k = 0; k + 2 < values.length; k += STRIDE) {
    const value = which === "rgb" ? Math.max(values[k]!, values[k + 1]!, values[k + 2]!) : channelOf(which, values, k);
    if (value > 0 && value < Infinity) numbers[count++] = value;
  }
  return numbers.subarray(0, count).sort();
}
/** Of 3 a value; it shares no factor with the slice's side, so every column is looked at. */
const STRIDE = 15;

const shownAxis = computed<Axis>(() => {
  let [least, most] = [Infinity, 0];
  for (const { arrays } of slices.answers.value.values()) {
    const numbers = positive(arrays["values"]!, channel.value);
    if (numbers.length === 0) continue;
    least = Math.min(least, numbers[Math.ceil((1 - HELD) * (numbers.length - 1))]!);
    most = Math.max(most, numbers[Math.floor(HELD * (numbers.length - 1))]!);
  }
  return axis(kind.value, least, most);
});

const since = computed(() => Math.max(0, ...[...slices.answers.value.values()].map((a) => a.since)));

export function Slice(): JSX.Element {
  const body = useRef<HTMLDivElement>(null);
  return (
    <Frame
      view="slice"
      title="Slice θh × θd"
      about="f by the half angle θh (right) and the difference angle θd (up), as MERL’s materials are shown: highlights at the left, retro-reflection along the bottom, the Fresnel effect at the top left, grazing directions at the right and the top. Click, or move the cell with the arrow keys, to go to that pair of directions."
      many
      controls={
        <>
          <label class="phi-d">
            φd
            <input type="range" aria-label="Azimuth φd of the difference vector, degrees" min={0} max={180} step={1} value={phiD.value} onInput={(event) => (phiD.value = event.currentTarget.valueAsNumber)} />
            <output>{phiD.value}°</output>
          </label>
          <select class="view-select" aria-label="Scale of the slice" value={kind.value} onChange={(event) => (kind.value = event.currentTarget.value as Scale)}>
            <option value="log">log</option>
            <option value="cube-root">∛</option>
            <option value="linear">linear</option>
          </select>
        </>
      }
      saves={{
        png: () => {
          const canvases = [...(body.current?.querySelectorAll<HTMLCanvasElement>(".picture canvas") ?? [])];
          return canvases.length > 0 ? pngOfCanvas(beside(canvases, colour("--surface"))) : null;
        },
        csv: table,
      }}
    >
      {(size) => (
        <div ref={body}>
          <Drawing size={size} />
          <Complaints of={complaintsOf(slices, paced.functions.value)} />
        </div>
      )}
    </Frame>
  );
}

function Drawing({ size }: { size: Size }): JSX.Element {
  useDrawn("slice", since.value);
  const scale = shownAxis.value;
  const pictures = paced.functions.value.flatMap((f): Picture[] => {
    const answer = slices.answers.value.get(String(f.id));
    if (answer === undefined) return [];
    const { side } = answer.answer;
    return [{ shown: f, width: side, height: side, paint: painted(answer, scale), words: `Slice of ${f.text} at φd = ${phiD.value}°` }];
  });
  const below = pictures.length > 1 ? 0 : BELOW;
  const inner: Size = { width: size.width - LEFT - BAR, height: size.height - below };
  const barHeight = Math.max(40, size.height - 64);
  return (
    <>
      <div class="slice-place" style={{ left: `${LEFT - 6}px`, right: `${BAR}px`, bottom: `${below === 0 ? 0 : below - 6}px` }}>
        {pictures.length > 0 && (
          <Pictures
            size={inner}
            aspect={1}
            pictures={pictures}
            foot={pictures.length > 1 ? 30 : 0}
            over={(cell, left, k) => (
              <Axes cell={cell} single={pictures.length === 1} left={left}>
                <Cell size={cell.width} nodes={pictures[k]!.width} name={pictures.length === 1 ? "slice" : `slice of ${label(pictures[k]!.shown)}`} read={(index) => inWords(pictures[k]!.shown, index)} />
              </Axes>
            )}
          />
        )}
      </div>
      {pictures.length > 0 && (
        <div class="bar-place" style={{ top: "25px" }}>
          <span class="bar-name">sr⁻¹</span>
          <Bar height={barHeight - 11} name="f in sr⁻¹" ticks={scale.ticks} colourAt={(p) => ofValue(channel.value, scale, [scale.value(p), scale.value(p), scale.value(p)])} />
        </div>
      )}
    </>
  );
}

/** The value at a node. */
function inWords(shown: Shown, index: number): string {
  const values = slices.answers.value.get(String(shown.id))?.arrays["values"];
  const value = values === undefined ? NaN : channelOf(channel.value, values, 3 * index);
  return Number.isFinite(value) ? `f ${number(value)} per steradian` : "no value";
}

const painters = new WeakMap<Answer<"slice">, { axis: Axis; which: Channel; paint: (out: Uint8ClampedArray) => void }>();

function painted(answer: Answer<"slice">, scale: Axis): (out: Uint8ClampedArray) => void {
  const before = painters.get(answer);
  const which = channel.value;
  if (before?.axis === scale && before.which === which) return before.paint;
  const paint = (out: Uint8ClampedArray): void => {
    paintValues(out, which, scale, answer.arrays["values"]!);
  };
  painters.set(answer, { axis: scale, which, paint });
  return paint;
}

/** Angles along the edges. */
function Axes({ cell, single, left, children }: { cell: Size; single: boolean; left: boolean; children: ComponentChildren }): JSX.Element {
  const side = cell.width;
  const at = (degrees: number): number => (clamp(degrees, 0, LAST) / LAST) * side;
  const wide = single || side > 200;
  const steps = side > 170 ? [0, 15, 30, 45, 60, 75, 90] : [0, 30, 60, 90];
  const go = (x: number, y: number): void => void goTo(clamp(x / side, 0, 1) * LAST, clamp(1 - y / side, 0, 1) * LAST);
  return (
    <svg
      class="over plot slice-axes"
      viewBox={`0 0 ${side} ${side}`}
      width={side}
      height={side}
      role="group"
      aria-label="Half angle θh to the right, difference angle θd upwards"
      onPointerDown={(event) => {
        const box = event.currentTarget.getBoundingClientRect();
        go(event.clientX - box.left, event.clientY - box.top);
        if (event.pointerType === "mouse") follow(event, event.currentTarget, go);
      }}
    >
      <rect class="rim" x={0} y={0} width={side} height={side} />
      {steps.map((t) => (
        <g key={t}>
          <line class="rim" x1={at(t)} x2={at(t)} y1={side} y2={side + 4} />
          <line class="rim" x1={-4} x2={0} y1={side - at(t)} y2={side - at(t)} />
          {wide && (
            <text class="tick" x={at(t)} y={side + 12}>
              {t}°
            </text>
          )}
          {left && t > 0 && (
            <text class="tick end" x={-7} y={side - at(t)}>
              {t}°
            </text>
          )}
        </g>
      ))}
      <text class="axis-name" x={side / 2} y={side + (wide ? 25 : 15)} text-anchor="middle">
        half angle θh
      </text>
      {single && (
        <text class="axis-name" transform={`translate(-33 ${side / 2}) rotate(-90)`} text-anchor="middle">
          difference angle θd
        </text>
      )}
      {children}
    </svg>
  );
}

function table(): string | null {
  const rows: Row[] = [];
  paced.functions.value.forEach((f) => {
    const answer = slices.answers.value.get(String(f.id));
    if (answer === undefined) return;
    const { side } = answer.answer;
    const values = answer.arrays["values"]!;
    for (let k = 0; k < side * side; k += 1) {
      if (Number.isNaN(values[3 * k]!)) continue;
      const node = (n: number): number => (n * LAST) / (side - 1);
      rows.push([f.text, node(k % side), node(side - 1 - Math.floor(k / side)), ...values.subarray(3 * k, 3 * k + 3)]);
    }
  });
  return rows.length > 0 ? csvText(["function", "theta_h_deg", "theta_d_deg", "red", "green", "blue"], rows) : null;
}
