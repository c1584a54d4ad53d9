/** The polar plot: lobes in the plane of incidence. */
import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import { angleOnPolar, clamp, fromPlane, inPlane, onPolar, STEEPEST } from "../plot/directions";
import type { Size } from "../plot/grid";
import { outline } from "../plot/outline";
import { svgText } from "../plot/save";
import { type Axis, number } from "../plot/scale";
import { channel, cosine, scale, wi, wo } from "../state";
import { Complaints, Frame } from "./frame";
import { Handle, setWi, setWo } from "./handle";
import { at, curves, keyedAngle, legend, type Line, lines, looked, since, table, transmits, valueAxis } from "./plane";
import { complaintsOf, Reading } from "./reading";
import { colour } from "./theme";
import { useDrawn } from "./timings";

/** Room around the rim for the angles. */
const RIM = 26;
/** Room below the horizon for the values. */
const BELOW = 22;

export function Polar(): JSX.Element {
  const svg = useRef<SVGSVGElement>(null);
  return (
    <Frame
      view="polar"
      title="Polar plot"
      about="f in the plane of incidence: the distance from the centre is the value towards that direction. The light comes from the left; drag its arrow. Click anywhere to look at a direction."
      saves={{
        svg: () => svg.current && svgText(svg.current, legend(), colour("--surface"), colour("--ink")),
        csv: table,
      }}
    >
      {(size) => <Drawing size={size} svg={svg} />}
    </Frame>
  );
}

function Drawing({ size: { width, height }, svg }: { size: Size; svg: { current: SVGSVGElement | null } }): JSX.Element {
  useDrawn("polar", since.value);
  const below = transmits.value;
  const radius = Math.max(20, below ? Math.min(width / 2 - RIM - 8, height / 2 - RIM) : Math.min(width / 2 - RIM - 8, height - RIM - BELOW - 4));
  const spare = height - radius - RIM - BELOW;
  const centre: [number, number] = [width / 2, below ? height / 2 : RIM + radius + 0.4 * Math.max(0, spare)];
  const end = below ? 180 : 90;
  const { axis, notes } = valueAxis.value;
  const at2 = (angle: number, r: number): [number, number] => {
    const [x, y] = onPolar(angle, r);
    return [centre[0] + x, centre[1] + y];
  };
  const angleAt = (x: number, y: number): number => clamp(angleOnPolar(x - centre[0], y - centre[1]), -end, end);
  // The same elements while the axis is the same: nothing of them is looked at when only curves change.
  const grid = useMemo(() => <Grid {...{ axis, centre, radius, end }} />, [axis, width, height, end]);
  const values = useMemo(() => <Values {...{ axis, centre, radius, below }} />, [axis, width, height, end]);
  const light = at2(-wi.value.theta, radius);
  const lightIn = at2(-wi.value.theta, radius - 26);
  const quantity = `${cosine.value ? "f cos θr" : "f"} in sr⁻¹`;
  return (
    <>
      <svg
        ref={svg}
        class="plot"
        viewBox={`0 0 ${width} ${height}`}
        width={width}
        height={height}
        role="group"
        aria-label={`Polar plot of ${quantity}, light from ${wi.value.theta}°. ${inWords(lines.value)}`}
        onPointerMove={(event) => {
          if (event.pointerType !== "mouse") return;
          const box = event.currentTarget.getBoundingClientRect();
          looked.value = angleAt(event.clientX - box.left, event.clientY - box.top);
        }}
        onPointerLeave={() => (looked.value = null)}
        onClick={(event) => {
          if ((event.target as Element).closest(".handle") !== null) return;
          const box = event.currentTarget.getBoundingClientRect();
          setWo(fromPlane(wi.value, angleAt(event.clientX - box.left, event.clientY - box.top)));
        }}
      >
        {grid}
        <g class="light-ray">
          <line class="ray-dim" x1={centre[0]} y1={centre[1]} x2={lightIn[0]} y2={lightIn[1]} />
          <line class="ray" x1={light[0]} y1={light[1]} x2={lightIn[0]} y2={lightIn[1]} />
          <Head tip={lightIn} angle={-wi.value.theta} />
        </g>
        <Along class="mirror-ray" from={at2(wi.value.theta, radius - 5)} to={at2(wi.value.theta, radius + 5)} />
        {lines.value.map((line) => (
          <Lobe key={line.key} {...{ line, axis, centre, radius }} filled={lines.value.length <= 4 && channel.value !== "rgb"} />
        ))}
        <Along class="horizon" from={at2(-90, radius)} to={at2(90, radius)} />
        {lines.value.flatMap((line) =>
          line.spikes.map(([angle, share]) => (
            <g key={`${line.key} ${angle}`} class={`series-${line.shown.colour}`}>
              <Along class="spike" from={centre} to={at2(angle, 0.76 * radius)} />
              <Head tip={at2(angle, 0.76 * radius)} angle={angle + 180} />
              <text class="value strong" x={at2(angle, 0.76 * radius + 16)[0]} y={at2(angle, 0.76 * radius + 16)[1]}>
                {number(share)}
              </text>
            </g>
          )),
        )}
        {values}
        {looked.value !== null && Math.abs(looked.value) <= end && <Along class="crosshair aside" from={centre} to={at2(looked.value, radius)} />}
        <Viewed {...{ axis, centre, radius, end, angleAt }} />
        <Handle
          which="light"
          x={light[0]}
          y={light[1]}
          angles={wi.value}
          moved={(x, y) => setWi({ theta: clamp(-angleAt(x, y), 0, STEEPEST), phi: wi.value.phi })}
          keyed={(key, by) => {
            const next = keyedAngle(-wi.value.theta, key, by);
            if (next !== null) setWi({ theta: Math.max(0, -next), phi: wi.value.phi });
            return next !== null;
          }}
        />
      </svg>
      <Reading place="corner" />
      <p class="view-note top">
        {quantity}
        {scale.value !== "linear" && `, ${scale.value === "log" ? "logarithmic" : "cube root"}`}
        {notes.map((note) => `; ${note}`)}
      </p>
      <Complaints of={complaintsOf(curves)} />
    </>
  );
}

type Point = [number, number];

const Along = ({ from, to, ...rest }: { class: string; from: Point; to: Point }): JSX.Element => (
  <line {...rest} x1={from[0].toFixed(1)} y1={from[1].toFixed(1)} x2={to[0].toFixed(1)} y2={to[1].toFixed(1)} />
);

/** The head of an arrow that comes from `angle`. */
const Head = ({ tip, angle }: { tip: Point; angle: number }): JSX.Element => (
  <path class="arrow" d="M0 0 L-4 -9 L4 -9 Z" transform={`translate(${tip[0].toFixed(1)} ${tip[1].toFixed(1)}) rotate(${angle.toFixed(2)})`} />
);

function Grid({ axis, centre, radius, end }: { axis: Axis; centre: Point; radius: number; end: number }): JSX.Element {
  const arc = (r: number): string =>
    end === 180
      ? `M${centre[0] - r} ${centre[1]} a${r} ${r} 0 1 1 ${2 * r} 0 a${r} ${r} 0 1 1 ${-2 * r} 0`
      : `M${centre[0] - r} ${centre[1]} a${r} ${r} 0 0 1 ${2 * r} 0`;
  const rays = [];
  for (let angle = -end; angle <= end; angle += 10) {
    if (angle === -180) continue;
    const long = angle % 30 === 0;
    const [x, y] = onPolar(angle, 1);
    const inner = long ? 0 : radius - 5;
    rays.push(
      <Along
        key={angle}
        class="grid"
        from={[centre[0] + inner * x, centre[1] + inner * y]}
        to={[centre[0] + (radius + (long ? 4 : 0)) * x, centre[1] + (radius + (long ? 4 : 0)) * y]}
      />,
    );
    if (!long) continue;
    const place = radius + 15;
    rays.push(
      <text key={`${angle} text`} class="tick" x={centre[0] + (place + (Math.abs(angle) === 90 ? 2 : 0)) * x} y={centre[1] + place * y}>
        {Math.abs(angle) > 90 ? 180 - Math.abs(angle) : Math.abs(angle)}°
      </text>,
    );
  }
  return (
    <g>
      {axis.ticks.map(({ value, position, label }) => (position > 0 && position < 1 ? <path key={value} class={label === "" ? "grid fine" : "grid"} d={arc(position * radius)} /> : null))}
      {rays}
      <path class="rim" d={arc(radius)} />
    </g>
  );
}

/** The values of the rings, below the horizon; those that would touch are left out. */
function Values({ axis, centre, radius, below }: { axis: Axis; centre: Point; radius: number; below: boolean }): JSX.Element {
  let last = Infinity;
  const labels = [];
  for (const { value, position, label } of [...axis.ticks].reverse()) {
    const half = 3.4 * label.length;
    const r = position * radius;
    if (label === "" || last - r < half + 8 || (axis.low === 0 && position === 0)) continue;
    last = r - half;
    labels.push(
      <text key={value} class="value" x={centre[0] - r} y={centre[1] + 12}>
        {label}
      </text>,
    );
  }
  return (
    <g>
      {labels}
      <text class="value" x={centre[0] + radius - (below ? 18 : 0)} y={centre[1] + 12}>
        {below ? "inside" : "sr⁻¹"}
      </text>
    </g>
  );
}

/** The outline of a lobe. A value that is not finite breaks it. */
function Lobe({ line, axis, centre, radius, filled }: { line: Line; axis: Axis; centre: Point; radius: number; filled: boolean }): JSX.Element {
  const xs = new Float64Array(line.angles.length);
  const ys = new Float64Array(line.angles.length);
  for (let k = 0; k < xs.length; k += 1) {
    const value = line.values[k]!;
    const [x, y] = onPolar(line.angles[k]!, Number.isFinite(value) ? radius * axis.position(value) : NaN);
    xs[k] = centre[0] + x;
    ys[k] = centre[1] + y;
  }
  return <path class={`curve ${line.look} ${filled ? "filled" : ""}`} d={outline(xs, ys)} stroke-dasharray={line.dash || undefined} />;
}

/** The direction of view: a ray, its value on every curve, and a handle at the rim. */
function Viewed({ axis, centre, radius, end, angleAt }: { axis: Axis; centre: Point; radius: number; end: number; angleAt: (x: number, y: number) => number }): JSX.Element | null {
  if (wo.value === null) return null;
  const { angle, off } = inPlane(wi.value, wo.value);
  if (Math.abs(angle) > end) return null;
  const inside = off < 0.5;
  const [x, y] = onPolar(angle, 1);
  return (
    <g>
      <Along class={inside ? "view-ray" : "view-ray dim"} from={centre} to={[centre[0] + radius * x, centre[1] + radius * y]} />
      {inside &&
        lines.value.map((line) => {
          const r = radius * axis.position(at(line, angle));
          return Number.isFinite(r) ? <circle key={line.key} class={`mark ${line.look}`} cx={centre[0] + r * x} cy={centre[1] + r * y} r={3.5} /> : null;
        })}
      <Handle
        which="viewer"
        hollow={!inside}
        x={centre[0] + radius * x}
        y={centre[1] + radius * y}
        angles={wo.value}
        moved={(px, py) => setWo(fromPlane(wi.value, angleAt(px, py)))}
        keyed={(key, by) => {
          const next = keyedAngle(angle, key, by);
          if (next !== null) setWo(fromPlane(wi.value, clamp(next, -end, end)));
          return next !== null;
        }}
      />
    </g>
  );
}

/** Each curve in words, for those who can't see the picture. */
function inWords(all: Line[]): string {
  return all
    .map((line) => {
      let peak = -1;
      for (let k = 0; k < line.values.length; k += 1) if (Number.isFinite(line.values[k]!) && (peak < 0 || line.values[k]! > line.values[peak]!)) peak = k;
      const spikes = line.spikes.map(([angle, share]) => ` ${number(share)} of the light goes to ${number(angle)}°.`).join("");
      return peak < 0 ? spikes : `${line.shown.text}: largest ${number(line.values[peak]!)} at ${number(line.angles[peak]!)}°.${spikes}`;
    })
    .join(" ");
}
