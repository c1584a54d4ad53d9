/** T12 and T13: energy conservation, the reflection equation. */
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { Chart, luminance, pairs } from "../chart";
import { Check, Choice, Drawing, Figure, Numbers, Slider, figureOf } from "../figure";
import { Picture } from "../picture";
import { Polar } from "../polar";
import { useAnswer, useLearn } from "../use";
import { SKIES, type Sky } from "./radiometry";
import { Cells } from "./cells";
import { inPlane } from "./reflection";

const ANGLES = [0, 10, 20, 30, 40, 50, 60, 65, 70, 75, 80, 84, 87, 89];
const SURFACES = [
  ["ggx:fresnel=none,roughness=ROUGH", "white facets that light each other"],
  ["ggx:fresnel=none,roughness=ROUGH,interreflection=none", "white facets, each alone"],
  ["phong:normalisation=published,exponent=2,diffuse=0.5,specular=0.9", "Phong as published"],
] as const;
const FURNACE = 96;
const SAMPLES = 16;

export function Energy(): JSX.Element {
  const [roughness, setRoughness] = useState(0.8);
  const [which, setWhich] = useState<string>(SURFACES[1][0]);
  const text = which.replace("ROUGH", String(roughness));
  const albedo = useAnswer("albedo", { function: text, thetas: ANGLES, phi: 0 }, "slow");
  const furnace = useAnswer(
    "render",
    {
      function: text,
      object: "ball",
      light: "uniform:0.5",
      direction: { theta: 0, phi: 0 },
      turn: 0,
      width: FURNACE,
      height: FURNACE,
      first: 0,
      count: SAMPLES,
      bounces: 8,
      factors: { light: true, brdf: true, cosine: true },
    },
    "render",
  );
  const sums = furnace.reply?.arrays.sums;
  const line = pairs(ANGLES, albedo.reply?.arrays.reflected);
  const most = line.reduce((m, [, a]) => Math.max(m, a), 0);
  return (
    <Figure
      complaint={albedo.complaint ?? furnace.complaint}
      layout="beside"
      caption="The share of the light that leaves again, by the angle from which it comes; and a ball of it in a furnace, uniform light from everywhere: one that loses nothing can't be seen."
      controls={
        <>
          <Choice label="surface" value={which} options={SURFACES} onValue={setWhich} />
          {which.includes("ROUGH") ? <Slider label="roughness" value={roughness} min={0.1} max={1} step={0.05} onValue={setRoughness} /> : null}
          <Numbers
            rows={[
              { name: "largest directional albedo", value: line.length === 0 ? null : figureOf(most, 4), strong: true },
              { name: "more leaves than arrives", value: line.length === 0 ? null : most > 1.0005 ? "yes" : "no" },
            ]}
          />
        </>
      }
    >
      <Chart
        label={`Directional albedo over the angle of incidence; the largest is ${figureOf(most, 4) ?? "…"}.`}
        x={{ from: 0, to: 90, name: "θi in degrees", ticks: [0, 30, 60, 90] }}
        y={{ from: 0, to: Math.max(1.2, most * 1.1), name: "albedo" }}
        lines={[{ name: "albedo", look: "ls-0", points: line }]}
        levels={[{ value: 1, name: "all of it" }]}
      />
      <Picture label="A ball of the surface in a furnace" name="in the furnace" values={sums === undefined ? null : sums.map((s) => s / SAMPLES)} width={FURNACE} height={FURNACE} />
    </Figure>
  );
}

const LIGHTS = [
  { angle: -65, name: "1" },
  { angle: -35, name: "2" },
  { angle: 40, name: "3" },
] as const;

export function ReflectionEquation(): JSX.Element {
  const [strengths, setStrengths] = useState([1, 0.6, 0.8]);
  const [on, setOn] = useState([true, true, true]);
  const [viewer, setViewer] = useState(30);
  const text = "sum(lambertian:reflectance=0.3, ggx:roughness=0.5,f0=0.3)";
  const wo = inPlane(viewer);
  const lights = LIGHTS.map(({ angle }, i) => ({ ...inPlane(angle), radiance: [0, 0, 0].map(() => (on[i] ? strengths[i]! : 0)) }));
  const { answer, arrays, complaint } = useLearn<{ sum: number[] }>({ figure: "reflection", function: text, wo, lights });
  const terms = LIGHTS.map((_, i) => (arrays.terms === undefined ? 0 : arrays.terms[3 * i]!));
  // f over the directions of the light is, by reciprocity, that over the directions of view.
  const curve = useAnswer("curve", { function: text, wi: wo, cosine: false });
  const total = answer === null ? null : luminance(answer.sum[0]!, answer.sum[1]!, answer.sum[2]!);
  return (
    <>
      <Figure
        complaint={complaint ?? curve.complaint}
        caption="Three lights. Each adds its own L f cosθ, shown as a bar; what the viewer sees is their sum."
        controls={
          <>
            {LIGHTS.map(({ name }, i) => (
              <div key={name} class="learn-pair">
                <Check label={`light ${name}`} value={on[i]!} onValue={(v) => setOn(on.map((o, k) => (k === i ? v : o)))} />
                <Slider label="as bright as" value={strengths[i]!} min={0} max={2} step={0.05} onValue={(v) => setStrengths(strengths.map((s, k) => (k === i ? v : s)))} />
              </div>
            ))}
            <Slider label="viewer" value={viewer} min={-80} max={80} unit="°" onValue={setViewer} />
            <Numbers
              rows={[
                ...LIGHTS.map((_, i) => ({ name: `L${"₁₂₃"[i]} f cosθ${"₁₂₃"[i]}`, value: answer === null ? null : figureOf(terms[i]), look: `ls-${i}` })),
                { name: "Lr, their sum", value: figureOf(total), strong: true },
              ]}
            />
          </>
        }
      >
        <Polar
          label={`Three lights in the plane, the viewer at ${viewer}°.`}
          lobes={[{ look: "ls-7", reply: curve.reply === null ? null : flipped(curve.reply, viewer) }]}
          lights={LIGHTS.filter((_, i) => on[i]).map(({ angle, name }) => ({ angle, name, strength: 0.3 + 0.35 * strengths[LIGHTS.findIndex((l) => l.name === name)]! }))}
          viewer={viewer}
        />
        <Drawing ratio={9} label={`The three terms: ${terms.map((t) => figureOf(t, 3)).join(", ")}; their sum: ${figureOf(total, 3) ?? "…"}.`}>
          {({ width, height }) => {
            const scale = (width - 16) / Math.max(1.2, total ?? 0);
            let x = 8;
            return terms.map((t, i) => {
              const bar = (
                <g key={i} class={`ls-${i}`}>
                  <rect class="term" x={x} y={6} width={Math.max(0, t * scale)} height={height - 12} />
                </g>
              );
              x += t * scale;
              return bar;
            });
          }}
        </Drawing>
      </Figure>
      <Continuous text={text} viewer={viewer} />
    </>
  );
}

/** `curve` counts angles from its own light; here they are those of the page. */
function flipped<R extends { arrays: Record<string, Float32Array> }>(reply: R, viewer: number): R {
  const { angles } = reply.arrays;
  return viewer <= 0 || angles === undefined ? reply : { ...reply, arrays: { ...reply.arrays, angles: angles.map((x) => -x) } };
}

/** The same sum over the cells of a sky, which becomes the integral. */
function Continuous({ text, viewer }: { text: string; viewer: number }): JSX.Element {
  const [sky, setSky] = useState<Sky>("low-sun");
  const [steps, setSteps] = useState(6);
  const { answer, arrays, complaint } = useLearn<{ sum: number[]; exact: number[] }>({ figure: "reflection-sky", function: text, wo: inPlane(viewer), sky, steps });
  const every3 = (a: Float32Array | undefined): number[] | undefined => (a === undefined ? undefined : Array.from({ length: a.length / 3 }, (_, i) => luminance(a[3 * i]!, a[3 * i + 1]!, a[3 * i + 2]!)));
  const sums = (every3(arrays.sums) ?? []).map((s, i): [number, number] => [i + 1, s]);
  const exact = answer === null ? null : luminance(answer.exact[0]!, answer.exact[1]!, answer.exact[2]!);
  return (
    <Figure
      layout="halves"
      complaint={complaint}
      caption="From a sum to an integral: the sky in cells, each a light and as bright as what it adds. The more there are, the nearer is their sum to the integral."
      controls={
        <>
          <Choice label="sky" value={sky} options={SKIES} onValue={setSky} />
          <Slider label="steps in θ" value={steps} min={1} max={16} text={`${steps} (${4 * steps * steps} lights)`} onValue={setSteps} />
          <Numbers
            rows={[
              { name: "sum", value: answer === null ? null : figureOf(luminance(answer.sum[0]!, answer.sum[1]!, answer.sum[2]!)), strong: true },
              { name: "integral", value: figureOf(exact) },
            ]}
          />
        </>
      }
    >
      <Cells label="The sky in cells, by what each adds to the reflected radiance." steps={steps} values={every3(arrays.terms)} />
      <Chart
        label={`The sum over the number of steps: it comes near ${figureOf(exact) ?? "…"}.`}
        x={{ from: 1, to: 32, name: "steps in θ", ticks: [1, 8, 16, 24, 32] }}
        y={{ from: 0, to: Math.max(1e-6, exact ?? 0, ...sums.map(([, s]) => s)) * 1.1, name: "Lr" }}
        lines={[{ name: "sum", look: "ls-0", points: sums, dots: true }]}
        levels={exact === null ? [] : [{ value: exact, name: "integral" }]}
        mark={steps}
      />
    </Figure>
  );
}
