/** A small polar plot: lobes in the plane of incidence, with the directions of the light and the viewer. */
import type { JSX } from "preact";
import type { Reply } from "../engine/protocol";
import { onPolar } from "../plot/directions";
import { number, roundUp } from "../plot/scale";
import { pairs } from "./chart";
import { Drawing } from "./figure";

export interface Lobe {
  look: string;
  reply: Reply<"curve"> | null;
}

interface Props {
  label: string;
  lobes: readonly Lobe[];
  /** Angles in the plane; positive on the side where a mirror reflects. */
  lights?: readonly { angle: number; strength?: number; name?: string }[];
  viewer?: number | null;
  /** Half of the angle of a cone around the first light. */
  cone?: number;
  /** What the rim means, where it isn't the lobes' largest value. */
  largest?: number;
}

export function Polar({ label, lobes, lights = [], viewer = null, cone, largest }: Props): JSX.Element {
  const lines = lobes.map(({ look, reply }) => ({ look, points: pairs(reply?.arrays.angles, reply?.arrays.values), spikes: reply?.arrays.spikes }));
  const top = largest ?? lines.reduce((most, l) => l.points.reduce((m, [, y]) => (Number.isFinite(y) ? Math.max(m, y) : m), most), 0);
  const rim = top > 0 ? roundUp(top) : 1;
  return (
    <Drawing ratio={1.72} label={label}>
      {({ width, height }) => {
        const radius = Math.min(width / 2 - 34, height - 54);
        const [cx, cy] = [width / 2, height - 24];
        const at = (angle: number, r: number): [number, number] => {
          const [x, y] = onPolar(angle, r);
          return [cx + x, cy + y];
        };
        const path = (points: readonly (readonly [number, number])[]): string =>
          points
            .filter(([angle, value]) => Math.abs(angle) <= 90 && Number.isFinite(value))
            .map(([angle, value]) => `L${at(angle, radius * Math.min(value / rim, 1)).map((v) => v.toFixed(1)).join(" ")}`)
            .join("");
        const arcOf = (r: number): string => `M${at(-90, r).join(" ")}A${r} ${r} 0 0 1 ${at(90, r).join(" ")}`;
        return (
          <>
            {[0.25, 0.5, 0.75, 1].map((share) => (
              <path key={share} class="grid" d={arcOf(share * radius)} />
            ))}
            {[-60, -30, 0, 30, 60].map((angle) => (
              <g key={angle}>
                <line class="grid" x1={cx} y1={cy} x2={at(angle, radius)[0]} y2={at(angle, radius)[1]} />
                {/* A light's name has the place of the number. */}
                {lights.some((l) => l.name !== undefined && Math.abs(l.angle - angle) < 12) ? null : (
                  <text class="tick" text-anchor="middle" x={at(angle, radius + 13)[0]} y={at(angle, radius + 13)[1] + 4}>
                    {Math.abs(angle)}°
                  </text>
                )}
              </g>
            ))}
            {top > 0 ? (
              <>
                <text class="tick" text-anchor="middle" x={cx + radius} y={cy + 15}>
                  {number(rim)} sr⁻¹
                </text>
                <text class="tick" text-anchor="middle" x={cx + radius / 2} y={cy + 15}>
                  {number(rim / 2)}
                </text>
              </>
            ) : null}
            {cone !== undefined && lights[0] !== undefined ? (
              <path
                class="cone"
                d={`M${cx} ${cy}L${at(Math.max(lights[0].angle - cone, -90), radius).join(" ")}A${radius} ${radius} 0 0 1 ${at(Math.min(lights[0].angle + cone, 90), radius).join(" ")}Z`}
              />
            ) : null}
            {lines.map((l) => (
              <g key={l.look} class={l.look}>
                {l.points.length > 0 ? <path class="lobe" d={`M${cx} ${cy}${path(l.points)}Z`} /> : null}
                {l.spikes !== undefined
                  ? Array.from({ length: l.spikes.length / 4 }, (_, i) => l.spikes![4 * i]!).map((angle) => (
                      <line key={angle} class="spike" x1={cx} y1={cy} x2={at(angle, radius)[0]} y2={at(angle, radius)[1]} />
                    ))
                  : null}
              </g>
            ))}
            <line class="ground" x1={cx - radius - 8} x2={cx + radius + 8} y1={cy} y2={cy} />
            {lights.map(({ angle, strength = 1, name }, i) => (
              <g key={i} class="light">
                <Arrow from={at(angle, radius)} to={at(angle, radius * (1 - 0.42 * strength) - 2)} />
                {name !== undefined ? (
                  <text class="light-name" text-anchor="middle" x={at(angle, radius + 13)[0]} y={at(angle, radius + 13)[1] + 4}>
                    {name}
                  </text>
                ) : null}
              </g>
            ))}
            {viewer !== null ? (
              <g class="viewer">
                <Arrow from={at(viewer, radius * 0.66)} to={at(viewer, radius)} />
              </g>
            ) : null}
          </>
        );
      }}
    </Drawing>
  );
}

export function Arrow({ from, to }: { from: readonly [number, number]; to: readonly [number, number] }): JSX.Element {
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
  const side = (turn: number): string => `${(to[0] - 9 * Math.cos(angle + turn)).toFixed(1)} ${(to[1] - 9 * Math.sin(angle + turn)).toFixed(1)}`;
  return (
    <>
      <line class="shaft" x1={from[0]} y1={from[1]} x2={to[0]} y2={to[1]} />
      <path class="head" d={`M${to[0].toFixed(1)} ${to[1].toFixed(1)}L${side(0.38)}L${side(-0.38)}Z`} />
    </>
  );
}
