/** The Cartesian plot: f against the angle of reflection in the plane of incidence. */
import { scaleLinear } from "d3-scale";
import type { JSX } from "preact";
import { useMemo, useRef } from "preact/hooks";
import { clamp, fromPlane, inPlane, STEEPEST } from "../plot/directions";
import type { Size } from "../plot/grid";
import { outline } from "../plot/outline";
import { svgText } from "../plot/save";
import { type Axis, number } from "../plot/scale";
import { cosine, scale, wi, wo } from "../state";
import { Complaints, Frame } from "./frame";
import { Handle, setWi, setWo } from "./handle";
import { at, curves, keyedAngle, legend, type Line, lines, looked, since, table, transmits, valueAxis } from "./plane";
import { complaintsOf, Reading } from "./reading";
import { colour } from "./theme";
import { useDrawn } from "./timings";

const LEFT = 48;
const RIGHT = 16;
const TOP = 22;
const BOTTOM = 36;

export function Cartesian(): JSX.Element {
  const svg = useRef<SVGSVGElement>(null);
  return (
    <Frame
      view="cartesian"
      title="Cartesian plot"
      about="f in the plane of incidence against the angle of reflection, negative on the light's side. Drag the light's line; click to look at a direction."
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
  useDrawn("cartesian", since.value);
  const end = transmits.value ? 180 : 90;
  const { axis, notes } = valueAxis.value;
  const x = scaleLinear().domain([-end, end]).range([LEFT, width - RIGHT]);
  const [top, bottom] = [TOP, height - BOTTOM];
  const y = (value: number): number => bottom + (top - bottom) * axis.position(value);
  const angleAt = (px: number): number => clamp(x.invert(px), -end, end);
  const quantity = cosine.value ? "f cos θr" : "f";
  const light = x(-wi.value.theta);
  // The same elements while the axes are the same: nothing of them is looked at when only curves change.
  const ticks = useMemo(() => <Ticks {...{ axis, y, left: LEFT, right: width - RIGHT }} />, [axis, width, height]);
  const grid = useMemo(() => <Angles {...{ x, top, bottom, end, width }} />, [width, height, end]);
  const kind = scale.value === "log" ? ", logarithmic" : scale.value === "cube-root" ? ", cube root" : "";
  return (
    <>
      <svg
        ref={svg}
        class="plot"
        viewBox={`0 0 ${width} ${height}`}
        width={width}
        height={height}
        role="group"
        aria-label={`${quantity} in sr⁻¹ against the angle of reflection, light from ${wi.value.theta}°`}
        onPointerMove={(event) => {
          if (event.pointerType === "mouse") looked.value = angleAt(event.clientX - event.currentTarget.getBoundingClientRect().left);
        }}
        onPointerLeave={() => (looked.value = null)}
        onClick={(event) => {
          if ((event.target as Element).closest(".handle") !== null) return;
          setWo(fromPlane(wi.value, angleAt(event.clientX - event.currentTarget.getBoundingClientRect().left)));
        }}
      >
        {ticks}
        {grid}
        <line class="horizon" x1={LEFT} x2={width - RIGHT} y1={bottom} y2={bottom} />
        <text class="axis-name" x={width - RIGHT} y={height - 8} text-anchor="end">
          angle of reflection θr
        </text>
        <text class="axis-name" x={8} y={11} text-anchor="start">
          {quantity} in sr⁻¹{kind}
        </text>
        <line class="ray" x1={light} x2={light} y1={top} y2={bottom} />
        <line class="mirror-ray" x1={x(wi.value.theta)} x2={x(wi.value.theta)} y1={top} y2={bottom} />
        {lines.value.map((line) => (
          <path key={line.key} class={`curve ${line.look}`} d={path(line, x, y)} stroke-dasharray={line.dash || undefined} />
        ))}
        {lines.value.flatMap((line) =>
          line.spikes.map(([angle, share]) => (
            <g key={`${line.key} ${angle}`} class={`series-${line.shown.colour}`}>
              <line class="spike" x1={x(angle)} x2={x(angle)} y1={bottom} y2={top + 24} />
              <path class="arrow" d="M0 0 L-4 9 L4 9 Z" transform={`translate(${x(angle).toFixed(1)} ${top + 20})`} />
              <text class="value strong" x={x(angle)} y={top + 10}>
                {number(share)}
              </text>
            </g>
          )),
        )}
        {looked.value !== null && Math.abs(looked.value) <= end && <line class="crosshair aside" x1={x(looked.value)} x2={x(looked.value)} y1={top} y2={bottom} />}
        <Viewed {...{ x, y, top, bottom, end, angleAt }} />
        <Handle
          which="light"
          x={light}
          y={top}
          angles={wi.value}
          moved={(px) => setWi({ theta: clamp(-angleAt(px), 0, STEEPEST), phi: wi.value.phi })}
          keyed={(key, by) => {
            const next = keyedAngle(-wi.value.theta, key, by);
            if (next !== null) setWi({ theta: Math.max(0, -next), phi: wi.value.phi });
            return next !== null;
          }}
        />
      </svg>
      <Reading place="inside" />
      {notes.length > 0 && <p class="view-note">{notes.join("; ")}</p>}
      <Complaints of={complaintsOf(curves)} />
    </>
  );
}

/** The angles along the horizontal axis with their lines. */
function Angles({ x, top, bottom, end, width }: { x: (angle: number) => number; top: number; bottom: number; end: number; width: number }): JSX.Element {
  const step = width < 420 ? end / 3 : end / 6;
  const angles = Array.from({ length: Math.round((2 * end) / step) + 1 }, (_, k) => -end + k * step);
  return (
    <g>
      {angles.map((angle) => (
        <g key={angle}>
          <line class="grid" x1={x(angle)} x2={x(angle)} y1={top} y2={bottom + 4} />
          <text class="tick" x={x(angle)} y={bottom + 12}>
            {`${angle}°`.replace("-", "−")}
          </text>
        </g>
      ))}
    </g>
  );
}

/** The values of a vertical axis with their lines. */
export function Ticks({ axis, y, left, right }: { axis: Axis; y: (value: number) => number; left: number; right: number }): JSX.Element {
  let last = Infinity;
  return (
    <g>
      {axis.ticks.map(({ value, label }) => {
        const place = y(value);
        const written = label !== "" && last - place > 13;
        if (written) last = place;
        return (
          <g key={value}>
            <line class={label === "" ? "grid fine" : "grid"} x1={left} x2={right} y1={place} y2={place} />
            {written && (
              <text class="tick end" x={left - 6} y={place}>
                {label}
              </text>
            )}
          </g>
        );
      })}
    </g>
  );
}

function path(line: Line, x: (angle: number) => number, y: (value: number) => number): string {
  const xs = Float64Array.from(line.angles, x);
  const ys = Float64Array.from(line.values, (value) => (Number.isFinite(value) ? y(value) : NaN));
  return outline(xs, ys);
}

interface Places {
  x: (angle: number) => number;
  y: (value: number) => number;
  top: number;
  bottom: number;
  end: number;
  angleAt: (px: number) => number;
}

function Viewed({ x, y, top, bottom, end, angleAt }: Places): JSX.Element | null {
  if (wo.value === null) return null;
  const { angle, off } = inPlane(wi.value, wo.value);
  if (Math.abs(angle) > end) return null;
  const inside = off < 0.5;
  return (
    <g>
      <line class={inside ? "view-ray" : "view-ray dim"} x1={x(angle)} x2={x(angle)} y1={top} y2={bottom} />
      {inside &&
        lines.value.map((line) => {
          const value = at(line, angle);
          return Number.isFinite(value) ? <circle key={line.key} class={`mark ${line.look}`} cx={x(angle)} cy={y(value)} r={3.5} /> : null;
        })}
      <Handle
        which="viewer"
        hollow={!inside}
        x={x(angle)}
        y={bottom}
        angles={wo.value}
        moved={(px) => setWo(fromPlane(wi.value, angleAt(px)))}
        keyed={(key, by) => {
          const next = keyedAngle(angle, key, by);
          if (next !== null) setWo(fromPlane(wi.value, clamp(next, -end, end)));
          return next !== null;
        }}
      />
    </g>
  );
}
