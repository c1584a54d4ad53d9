/** T1 and T5 to T7: light, radiance, irradiance, radiant exitance. */
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { shown } from "../../plot/tone";
import { Chart, luminance, pairs, ROOM } from "../chart";
import { Choice, Drawing, Figure, Numbers, Slider, figureOf } from "../figure";
import { useLearn } from "../use";
import { Cells } from "./cells";

export function Light(): JSX.Element {
  const [kelvin, setKelvin] = useState(5500);
  const { answer, arrays, complaint } = useLearn<{ efficacy: number; rgb: [number, number, number] }>({ figure: "light", kelvin });
  const { lambda, v, radiance, colour } = arrays;
  const rgb = answer === null ? null : shown(answer.rgb, 0, "srgb");
  return (
    <Figure
      complaint={complaint}
      caption="A black body's spectrum, what the eye makes of each wavelength, and the two together as colour and as lumens per watt."
      controls={
        <>
          <Slider label="temperature" value={kelvin} min={1500} max={12000} step={50} unit=" K" onValue={setKelvin} />
          <Numbers rows={[{ name: "luminous efficacy", value: answer === null ? null : `${figureOf(answer.efficacy, 4)} lm/W`, strong: true }]} />
          {rgb !== null ? (
            <p class="learn-swatch-row">
              <svg class="learn-swatch" width="44" height="22" aria-hidden="true">
                <rect width="44" height="22" rx="4" fill={`rgb(${rgb.join(" ")})`} />
              </svg>
              its colour
            </p>
          ) : null}
        </>
      }
    >
      <Chart
        label={`Spectral radiance of a black body of ${kelvin} kelvin, and the luminous efficiency of the eye, from 380 to 780 nanometres.`}
        x={{ from: 380, to: 780, name: "wavelength in nm" }}
        y={{ from: 0, to: 1, name: "relative" }}
        lines={[
          { name: "black body", look: "ls-1", points: pairs(lambda, radiance) },
          { name: "V(λ), the eye", look: "ls-0", points: pairs(lambda, v) },
        ]}
      />
      <Drawing ratio={22} label="The colours of the wavelengths.">
        {({ width, height }) =>
          lambda === undefined || colour === undefined
            ? null
            : Array.from(lambda, (nm, i) => {
                const [left, right] = [ROOM.left, ROOM.right];
                const w = (width - left - right) / lambda.length;
                return <rect key={nm} x={left + i * w} width={w + 0.5} height={height} fill={`rgb(${shown(Array.from(colour.subarray(3 * i, 3 * i + 3)), 0, "srgb").join(" ")})`} />;
              })
        }
      </Drawing>
    </Figure>
  );
}

interface RadianceAnswer {
  solid_angle: number;
  projected: number;
  irradiance: number;
  inverse_square: number;
  ratio: number;
}

export function Radiance(): JSX.Element {
  const [distance, setDistance] = useState(2);
  const [radius, setRadius] = useState(0.5);
  const { answer, complaint } = useLearn<RadianceAnswer>({ figure: "radiance", radius, distance, radiance: 1 });
  return (
    <Figure
      complaint={complaint}
      caption="A lamp that is farther away gives less light, and is smaller in the same proportion: what arrives per projected solid angle stays."
      controls={
        <>
          <Slider label="distance d" value={distance} min={0.5} max={6} step={0.1} unit=" m" onValue={setDistance} />
          <Slider label="radius of the lamp" value={radius} min={0.1} max={1} step={0.05} unit=" m" onValue={setRadius} />
          <Numbers
            rows={[
              { name: "irradiance E", value: answer === null ? null : `${figureOf(answer.irradiance)} W m⁻²` },
              { name: "projected solid angle", value: answer === null ? null : `${figureOf(answer.projected)} sr` },
              { name: "radiance L, their ratio", value: answer === null ? null : `${figureOf(answer.ratio)} W m⁻² sr⁻¹`, strong: true },
              { name: "L A / d², the law of far lamps", value: answer === null ? null : `${figureOf(answer.inverse_square)} W m⁻²` },
            ]}
          />
        </>
      }
    >
      <Drawing ratio={2.1} label={`A lamp of radius ${radius} metres in a distance of ${distance} metres: its irradiance is ${figureOf(answer?.irradiance) ?? "…"}, its radiance 1.`}>
        {({ width, height }) => {
          const unit = (width - 70) / 7;
          const [x0, y0] = [24, height / 2];
          const x1 = x0 + distance * unit;
          const r = Math.min(radius * unit, height / 2 - 8);
          return (
            <>
              <path class="cone" d={`M${x0} ${y0}L${x1} ${y0 - r}L${x1} ${y0 + r}Z`} />
              <line class="ground" x1={x0} x2={x0} y1={y0 - 34} y2={y0 + 34} />
              <g class="light">
                <line class="lamp" x1={x1} x2={x1} y1={y0 - r} y2={y0 + r} />
              </g>
              <line class="thin dashed" x1={x0} x2={x1} y1={y0} y2={y0} />
              <text class="symbol" x={(x0 + x1) / 2} y={y0 - 6} text-anchor="middle">
                d
              </text>
            </>
          );
        }}
      </Drawing>
    </Figure>
  );
}

export const SKIES = [
  ["uniform", "uniform"],
  ["overcast", "overcast"],
  ["low-sun", "a low sun"],
] as const;
export type Sky = (typeof SKIES)[number][0];

export function Irradiance(): JSX.Element {
  const [sky, setSky] = useState<Sky>("overcast");
  const [steps, setSteps] = useState(6);
  const { answer, arrays, complaint } = useLearn<{ sum: number; exact: number }>({ figure: "irradiance", sky, steps });
  const sums = arrays.sums === undefined ? [] : Array.from(arrays.sums, (s, i): [number, number] => [i + 1, s]);
  const most = Math.max(answer?.exact ?? 1, ...sums.map(([, s]) => s));
  return (
    <Figure
      complaint={complaint}
      layout="halves"
      caption="The hemisphere seen from above, in cells: each is as bright as what it adds, L cosθ sinθ dθ dφ. More cells come nearer to the integral."
      controls={
        <>
          <Choice label="sky" value={sky} options={SKIES} onValue={setSky} />
          <Slider label="steps in θ" value={steps} min={1} max={16} text={`${steps} (${4 * steps * steps} cells)`} onValue={setSteps} />
          <Numbers
            rows={[
              { name: "sum", value: answer === null ? null : `${figureOf(answer.sum, 7)} W m⁻²`, strong: true },
              { name: "integral E", value: answer === null ? null : `${figureOf(answer.exact, 7)} W m⁻²` },
              { name: "error", value: answer === null ? null : `${figureOf((100 * Math.abs(answer.sum - answer.exact)) / answer.exact, 2)} %` },
            ]}
          />
        </>
      }
    >
      <Cells label={`The sky in ${4 * steps * steps} cells, by what each adds to the irradiance.`} steps={steps} values={arrays.cells} />
      <Chart
        label={`The sum over the number of steps: it comes near ${figureOf(answer?.exact) ?? "…"}.`}
        x={{ from: 1, to: 32, name: "steps in θ", ticks: [1, 8, 16, 24, 32] }}
        y={{ from: 0, to: most * 1.1, name: "sum in W m⁻²" }}
        lines={[{ name: "sum", look: "ls-0", points: sums, dots: true }]}
        levels={answer === null ? [] : [{ value: answer.exact, name: "integral" }]}
        mark={steps}
      />
    </Figure>
  );
}

export function RadiantExitance(): JSX.Element {
  const [reflectance, setReflectance] = useState(0.6);
  const [kind, setKind] = useState<"paint" | "gold" | "mirror">("paint");
  const text = { paint: `lambertian:reflectance=${reflectance}`, gold: "ggx:metal=gold,roughness=0.3", mirror: "mirror:metal=silver" }[kind];
  const { answer, complaint } = useLearn<{ irradiance: number; exitance: number[]; albedo: number[] }>({ figure: "exitance", function: text });
  const mean = (v: number[] | undefined): number | null => (v === undefined ? null : luminance(v[0]!, v[1]!, v[2]!));
  const [e, m] = [answer?.irradiance ?? null, mean(answer?.exitance)];
  return (
    <Figure
      complaint={complaint}
      caption="Under a uniform sky of unit radiance π watts arrive on each square metre; the arrows are as wide as what arrives and what leaves."
      controls={
        <>
          <Choice
            label="surface"
            value={kind}
            options={[
              ["paint", "diffuse paint"],
              ["gold", "rough gold"],
              ["mirror", "silver mirror"],
            ]}
            onValue={setKind}
          />
          {kind === "paint" ? <Slider label="reflectance ρ" value={reflectance} min={0} max={1} step={0.01} onValue={setReflectance} /> : null}
          <Numbers
            rows={[
              { name: "irradiance E", value: e === null ? null : `${figureOf(e)} W m⁻²` },
              { name: "radiant exitance M", value: m === null ? null : `${figureOf(m)} W m⁻²`, strong: true },
              { name: "M / E", value: figureOf(mean(answer?.albedo)) },
            ]}
          />
        </>
      }
    >
      <Drawing ratio={2.4} label={`Irradiance ${figureOf(e) ?? "…"} and radiant exitance ${figureOf(m) ?? "…"} watts per square metre.`}>
        {({ width, height }) => {
          const ground = height - 22;
          const wide = 0.2 * width;
          const share = e === null || m === null ? 0 : m / e;
          const broad = (x: number, w: number, up: boolean): string => {
            const [tail, tip, neck] = up ? [ground - 4, 14, 14 + 24] : [14, ground - 4, ground - 28];
            return `M${x - w / 2} ${tail}L${x + w / 2} ${tail}L${x + w / 2} ${neck}L${x + w / 2 + 9} ${neck}L${x} ${tip}L${x - w / 2 - 9} ${neck}L${x - w / 2} ${neck}Z`;
          };
          return (
            <>
              <g class="light">
                <path class="broad" d={broad(width * 0.3, wide, false)} />
              </g>
              <text class="symbol" x={width * 0.3} y={height / 2} text-anchor="middle">
                E
              </text>
              {share > 0 ? (
                <g class="ls-0">
                  <path class="broad" d={broad(width * 0.7, wide * share, true)} />
                </g>
              ) : null}
              <text class="symbol" x={width * 0.7 + (wide * share) / 2 + 18} y={height / 2} text-anchor="middle">
                M
              </text>
              <line class="ground" x1={20} x2={width - 20} y1={ground} y2={ground} />
            </>
          );
        }}
      </Drawing>
    </Figure>
  );
}
