/** Directional albedo: the share of light from a direction that leaves again, and what that looks like in a furnace. */
import { scaleLinear } from "d3-scale";
import { computed } from "@preact/signals";
import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import { channelOf } from "../plot/colours";
import { clamp, STEEPEST } from "../plot/directions";
import type { Size } from "../plot/grid";
import { csvText, svgText } from "../plot/save";
import { number } from "../plot/scale";
import { spread } from "../plot/spread";
import { srgb8 } from "../plot/tone";
import { channel, type Shown, wi } from "../state";
import { Complaints, Frame } from "./frame";
import { Handle, setWi } from "./handle";
import { type Answer, Live, seen, settled } from "./live";
import { paced } from "./pace";
import { dash, keyedAngle, legend } from "./plane";
import { complaintsOf } from "./reading";
import { colour } from "./theme";
import { useDrawn } from "./timings";

/** Angles, a few a call, the coarse ones first: each may take tens of milliseconds. */
const BATCHES = [
  [0, 30, 60, 85],
  [15, 45, 75, 89.5],
  [7.5, 22.5, 37.5, 52.5],
  [67.5, 80, 87.5, 82.5],
  [70, 72.5, 77.5, 89],
  [50, 55, 57.5, 62.5],
  [65, 78.75, 83.75, 86.25],
  [81.25, 84.25, 88.25, 76.25],
];

/** The azimuth matters for what isn't isotropic, and only for that. */
const azimuth = (f: Shown): number => (f.description?.declares.isotropic === true ? 0 : paced.wi.value.phi);

/** The batch of the direction of incidence alone. */
const HERE = "here";

/** Which functions were asked for at all angles: only the coarse ones follow a slider. */
const whole = new Map<number, string>();

const albedos = new Live("albedo", () => {
  if (!seen.albedo.value) return null;
  const calm = settled.value;
  const batches = (f: Shown): number[][] => {
    const subject = `${f.text} ${azimuth(f)} ${f.revision}`;
    if (calm) whole.set(f.id, subject);
    return whole.get(f.id) === subject ? BATCHES : BATCHES.slice(0, 1);
  };
  const wish = (f: Shown, name: string, thetas: number[]) => ({ key: `${f.id}/${name}`, shown: f, request: { function: f.text, thetas, phi: azimuth(f) } });
  const wishes = paced.functions.value.map((f) => batches(f).map((thetas, k) => wish(f, String(k), thetas)));
  // The value that is written must be that of its angle, not one between two others.
  const exact = calm ? paced.functions.value.map((f) => wish(f, HERE, [paced.wi.value.theta])) : [];
  // The coarse ones of all functions first.
  return [...BATCHES.flatMap((_, k) => wishes.flatMap((w) => w[k] ?? [])), ...exact];
});

interface Curve {
  shown: Shown;
  thetas: number[];
  reflected: number[][];
  total: number[][];
  error: number;
  since: number;
}

/** The curves; what was answered for a function that has changed since is kept until the new one's coarse angles are there. */
const curves = computed<Curve[]>(() =>
  paced.functions.value.flatMap((shown) => {
    const answers = [HERE, ...BATCHES.keys()].map((name) => albedos.answers.value.get(`${shown.id}/${name}`)).filter((a) => a !== undefined);
    const like = (text: string, phi: number): Answer<"albedo">[] => answers.filter((a) => a.request.function === text && a.request.phi === phi);
    const ofNow = like(shown.text, azimuth(shown));
    const before = answers.at(-1)?.request;
    const used = ofNow.length >= 2 || before === undefined ? ofNow : like(before.function, before.phi);
    if (used.length === 0) return [];
    const points = used.flatMap((a) => a.request.thetas.map((theta, k) => ({ theta, reflected: triple(a.arrays["reflected"]!, k), total: triple(a.arrays["total"]!, k) })));
    points.sort((a, b) => a.theta - b.theta);
    return [
      {
        shown,
        thetas: points.map((p) => p.theta),
        reflected: points.map((p) => p.reflected),
        total: points.map((p) => p.total),
        error: Math.max(...used.map((a) => a.answer.error)),
        since: Math.max(...used.map((a) => a.since)),
      },
    ];
  }),
);

const triple = (values: Float32Array, k: number): number[] => [...values.subarray(3 * k, 3 * k + 3)];

const LEFT = 40;
const RIGHT = 16;
const TOP = 22;
const BOTTOM = 36;
/** The height of a function's strip in the furnace. */
const STRIP = 9;

export function Albedo(): JSX.Element {
  const svg = useRef<SVGSVGElement>(null);
  return (
    <Frame
      view="albedo"
      title="Directional albedo"
      about="The share of the light from an angle that leaves again: above 1 the function gains energy. Of what transmits, the reflected part is dotted. The strip below is the furnace: how bright the surface is under light of radiance 1 from everywhere, before a ground of 1; what is lossless disappears."
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
  const all = curves.value;
  useDrawn("albedo", Math.max(0, ...all.map((c) => c.since)));
  const channels = channel.value === "rgb" ? (["red", "green", "blue"] as const) : [channel.value];
  const most = Math.max(1, ...all.flatMap((c) => channels.flatMap((one) => c.total.map((v) => channelOf(one, v)))).filter(Number.isFinite));
  const top = most > 1.002 ? Math.ceil(most * 5) / 5 : 1;
  const furnace = all.length * (STRIP + 1) + 8;
  const bottom = height - BOTTOM - furnace;
  const x = scaleLinear().domain([0, 90]).range([LEFT, width - RIGHT]);
  const y = scaleLinear().domain([0, top]).range([bottom, TOP]);
  const at = clamp(wi.value.theta, 0, 90);
  const marks = all.flatMap((c) => channels.map((one) => ({ c, one, value: between(c, at, one) })));
  const labels = spread(marks.map((m) => y(m.value) - 9), 14);
  return (
    <>
      <svg ref={svg} class="plot" viewBox={`0 0 ${width} ${height}`} width={width} height={height} role="group" aria-label={words(all)}>
        {y.ticks(5).map((t) => (
          <g key={t}>
            <line class={t === 1 && top > 1 ? "rim" : "grid"} x1={LEFT} x2={width - RIGHT} y1={y(t)} y2={y(t)} />
            <text class="tick end" x={LEFT - 6} y={y(t)}>
              {number(t)}
            </text>
          </g>
        ))}
        {[0, 15, 30, 45, 60, 75, 90].map((t) => (
          <g key={t}>
            <line class="grid" x1={x(t)} x2={x(t)} y1={TOP} y2={bottom + 3} />
            <text class="tick" x={x(t)} y={height - BOTTOM + 12}>
              {t}°
            </text>
          </g>
        ))}
        <line class="horizon" x1={LEFT} x2={width - RIGHT} y1={bottom} y2={bottom} />
        <text class="axis-name" x={width - RIGHT} y={height - 8} text-anchor="end">
          angle of incidence θi
        </text>
        <text class="axis-name" x={8} y={11} text-anchor="start">
          albedo
        </text>
        <Furnace {...{ all, x, top: bottom + 6, width }} />
        <line class="ray" x1={x(at)} x2={x(at)} y1={TOP} y2={bottom} />
        {all.flatMap((c) =>
          channels.flatMap((one) => {
            const look = channel.value === "rgb" ? `channel-${one}` : `series-${c.shown.colour}`;
            const line = (values: number[][]): string =>
              values.map((v, k) => (Number.isFinite(channelOf(one, v)) ? `${x(c.thetas[k]!).toFixed(1)} ${y(channelOf(one, v)).toFixed(1)}` : "")).filter(Boolean).join("L");
            return [
              <path key={`${c.shown.id}${one}`} class={`curve ${look}`} d={`M${line(c.total)}`} stroke-dasharray={dash(c.shown.colour) || undefined} />,
              c.shown.description?.transmits === true && <path key={`${c.shown.id}${one}r`} class={`curve thin ${look}`} d={`M${line(c.reflected)}`} stroke-dasharray="1.5 3" />,
            ];
          }),
        )}
        {marks.map(({ c, one, value }, k) => (
          <Mark
            key={`${c.shown.id}${one}m`}
            look={channel.value === "rgb" ? `channel-${one}` : `series-${c.shown.colour}`}
            cx={x(at)}
            cy={y(value)}
            label={labels[k]!}
            value={value}
            left={at > 70}
          />
        ))}
        <Handle
          which="light"
          x={x(at)}
          y={TOP}
          angles={wi.value}
          moved={(px) => setWi({ theta: clamp(x.invert(px), 0, STEEPEST), phi: wi.value.phi })}
          keyed={(key, by) => {
            const next = keyedAngle(wi.value.theta, key, by);
            if (next !== null) setWi({ theta: Math.max(0, next), phi: wi.value.phi });
            return next !== null;
          }}
        />
      </svg>
      {all.some((c) => c.error > 0.002) && <p class="view-note">exact to {number(Math.max(...all.map((c) => c.error)))}</p>}
      <Complaints of={complaintsOf(albedos, paced.functions.value)} />
    </>
  );
}

function Mark({ look, cx, cy, label, value, left }: { look: string; cx: number; cy: number; label: number; value: number; left: boolean }): JSX.Element | null {
  if (!Number.isFinite(cy)) return null;
  return (
    <g class={look}>
      <circle class="mark" cx={cx} cy={cy} r={3.5} />
      <text class={left ? "value strong to-left" : "value strong to-right"} x={cx + (left ? -8 : 8)} y={label}>
        {value.toFixed(3)}
      </text>
    </g>
  );
}

/** The value at an angle, between its neighbours in proportion. */
function between(c: Curve, theta: number, one: Parameters<typeof channelOf>[0]): number {
  const k = c.thetas.findIndex((t) => t >= theta);
  if (k < 0) return NaN;
  const to = channelOf(one, c.total[k]!);
  if (k === 0 || c.thetas[k] === theta) return to;
  const share = (theta - c.thetas[k - 1]!) / (c.thetas[k]! - c.thetas[k - 1]!);
  return (1 - share) * channelOf(one, c.total[k - 1]!) + share * to;
}

/** Strips whose colour is the albedo, before a ground of 1. */
function Furnace({ all, x, top, width }: { all: Curve[]; x: (theta: number) => number; top: number; width: number }): JSX.Element {
  return (
    <g>
      {all.map((c, k) => {
        const last = c.thetas.at(-1) ?? 90;
        const id = `furnace-${c.shown.id}`;
        return (
          <g key={c.shown.id}>
            <defs>
              <linearGradient id={id}>
                {c.thetas.map((theta, n) => (
                  <stop key={theta} offset={theta / last} stop-color={`rgb(${c.total[n]!.map(srgb8).join()})`} />
                ))}
              </linearGradient>
            </defs>
            <rect class="furnace" x={x(0)} y={top + k * (STRIP + 1) - 1} width={width - RIGHT - x(0)} height={STRIP + 2} />
            <rect x={x(0)} y={top + k * (STRIP + 1) + 1} width={x(last) - x(0)} height={STRIP - 2} fill={`url(#${id})`} />
            <circle class={`dot series-${c.shown.colour}`} cx={x(0) - 9} cy={top + k * (STRIP + 1) + STRIP / 2} r={3} />
          </g>
        );
      })}
    </g>
  );
}

function words(all: Curve[]): string {
  const each = all.map((c) => `${c.shown.text}: ${number(channelOf("luminance", c.total[0]!))} at 0°, ${number(channelOf("luminance", c.total.at(-1)!))} at ${c.thetas.at(-1)}°`);
  return `Directional albedo against the angle of incidence. ${each.join("; ")}`;
}

function table(): string | null {
  const rows = curves.value.flatMap((c) => c.thetas.map((theta, k) => [c.shown.text, theta, ...c.reflected[k]!, ...c.total[k]!]));
  const columns = ["function", "theta_i_deg", "reflected_red", "reflected_green", "reflected_blue", "total_red", "total_green", "total_blue"];
  return rows.length > 0 ? csvText(columns, rows) : null;
}
