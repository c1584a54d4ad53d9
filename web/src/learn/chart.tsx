/** A small chart: lines over a horizontal axis. */
import { scaleLinear } from "d3-scale";
import { line } from "d3-shape";
import type { JSX } from "preact";
import { channelOf } from "../plot/colours";
import { number } from "../plot/scale";
import { Drawing } from "./figure";

export interface Line {
  name: string;
  /** A class that gives the colour. */
  look: string;
  points: readonly (readonly [number, number])[];
  dashed?: boolean;
  /** Dots instead of a line. */
  dots?: boolean;
}

interface Props {
  label: string;
  x: { from: number; to: number; name: string; ticks?: readonly number[] };
  y: { from: number; to: number; name: string };
  lines: readonly Line[];
  /** Horizontal lines: a value that is exact, a bound. */
  levels?: readonly { value: number; name: string }[];
  /** A vertical line: where the slider is. */
  mark?: number | null;
}

/** Around the lines, for the axes. */
export const ROOM = { left: 54, right: 12, top: 14, bottom: 40 };

export function Chart({ label, x, y, lines, levels = [], mark = null }: Props): JSX.Element {
  return (
    <>
      <Drawing ratio={(width) => (width < 360 ? 1.25 : 1.7)} label={label}>
        {({ width, height }) => {
          const across = scaleLinear([x.from, x.to], [ROOM.left, width - ROOM.right]);
          const up = scaleLinear([y.from, y.to], [height - ROOM.bottom, ROOM.top]).clamp(true);
          const path = line<readonly [number, number]>()
            .defined(([a, b]) => Number.isFinite(a) && Number.isFinite(b))
            .x(([a]) => across(a))
            .y(([, b]) => up(b));
          const ticksX = x.ticks ?? across.ticks(width < 380 ? 4 : 6);
          const ticksY = up.ticks(5);
          return (
            <>
              {ticksY.map((t) => (
                <g key={t}>
                  <line class="grid" x1={ROOM.left} x2={width - ROOM.right} y1={up(t)} y2={up(t)} />
                  <text class="tick" x={ROOM.left - 7} y={up(t) + 4} text-anchor="end">
                    {number(t)}
                  </text>
                </g>
              ))}
              {ticksX.map((t) => (
                <g key={t}>
                  <line class="grid" y1={ROOM.top} y2={height - ROOM.bottom} x1={across(t)} x2={across(t)} />
                  <text class="tick" y={height - ROOM.bottom + 16} x={across(t)} text-anchor="middle">
                    {number(t)}
                  </text>
                </g>
              ))}
              <text class="axis-name" x={(ROOM.left + width - ROOM.right) / 2} y={height - 6} text-anchor="middle">
                {x.name}
              </text>
              <text class="axis-name" x={12} y={(ROOM.top + height - ROOM.bottom) / 2} text-anchor="middle" transform={`rotate(-90 12 ${(ROOM.top + height - ROOM.bottom) / 2})`}>
                {y.name}
              </text>
              {levels.map(({ value, name }) => (
                <g key={name}>
                  <line class="level" x1={ROOM.left} x2={width - ROOM.right} y1={up(value)} y2={up(value)} />
                  <text class="level-name" x={width - ROOM.right - 4} y={up(value) - 5} text-anchor="end">
                    {name}
                  </text>
                </g>
              ))}
              {mark !== null ? <line class="mark" x1={across(mark)} x2={across(mark)} y1={ROOM.top} y2={height - ROOM.bottom} /> : null}
              {lines.map((l) =>
                l.dots ? (
                  <g key={l.name} class={l.look}>
                    {l.points.map(([a, b]) => (
                      <circle key={a} class="dot" cx={across(a)} cy={up(b)} r={2.5} />
                    ))}
                  </g>
                ) : (
                  <path key={l.name} class={`curve ${l.look}${l.dashed ? " dashed" : ""}`} d={path(l.points) ?? ""} />
                ),
              )}
            </>
          );
        }}
      </Drawing>
      {lines.length > 1 ? <Legend lines={lines} /> : null}
    </>
  );
}

export function Legend({ lines }: { lines: readonly { name: string; look: string; dashed?: boolean }[] }): JSX.Element {
  return (
    <ul class="learn-legend">
      {lines.map(({ name, look, dashed }) => (
        <li key={name}>
          <span class={`learn-numbers-key ${look}${dashed ? " dashed" : ""}`} />
          {name}
        </li>
      ))}
    </ul>
  );
}

/** Pairs of what two arrays hold: `y` may have three numbers for each of `x`, of which the luminance is taken as the plots do. */
export function pairs(x: ArrayLike<number> | undefined, y: ArrayLike<number> | undefined): [number, number][] {
  if (x === undefined || y === undefined) return [];
  const three = y.length === 3 * x.length;
  return Array.from(x, (a, i) => [a, three ? luminance(y[3 * i]!, y[3 * i + 1]!, y[3 * i + 2]!) : y[i]!]);
}

/** Of linear Rec.709. */
export const luminance = (r: number, g: number, b: number): number => channelOf("luminance", [r, g, b]);
