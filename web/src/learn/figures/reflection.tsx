/** T8 to T11: the reflection function, linearity, reciprocity, isotropy. */
import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import type { Angles } from "../../engine/protocol";
import { Chart, luminance } from "../chart";
import { Check, Choice, Drawing, Figure, Numbers, Slider, figureOf } from "../figure";
import { Picture } from "../picture";
import { Arrow, Polar } from "../polar";
import { useAnswer, useLearn } from "../use";

/** The direction at an angle of the plane φ = 0, 180°: positive where a mirror reflects light that comes from the left. */
export const inPlane = (angle: number): Angles => ({ theta: Math.abs(angle), phi: angle < 0 ? 180 : 0 });

const first = (v: readonly number[] | undefined): number | null => (v === undefined ? null : luminance(v[0]!, v[1]!, v[2]!));

export function ReflectionFunction(): JSX.Element {
  const [light, setLight] = useState(-45);
  const [viewer, setViewer] = useState(38);
  const [half, setHalf] = useState(10);
  const text = "ggx:metal=gold,roughness=0.4";
  const wi = inPlane(light);
  const curve = useAnswer("curve", { function: text, wi, cosine: false });
  const { answer, complaint } = useLearn<{ reflected: number[]; irradiance: number; ratio: number[]; f: number[] }>({
    figure: "brdf",
    function: text,
    wi,
    wo: inPlane(viewer),
    half_angle: half,
  });
  return (
    <Figure
      complaint={complaint ?? curve.complaint}
      caption="Light from a small cone. The smaller the cone, the nearer is the ratio of reflected radiance to irradiance to f, the value of the curve towards the viewer."
      controls={
        <>
          <Slider label="half angle of the cone" value={half} min={0.5} max={30} step={0.5} unit="°" onValue={setHalf} />
          <Slider label="light θi" value={-light} min={0} max={85} unit="°" onValue={(v) => setLight(-v)} />
          <Slider label="viewer" value={viewer} min={-85} max={85} unit="°" onValue={setViewer} />
          <Numbers
            rows={[
              { name: "reflected radiance dLr", value: figureOf(first(answer?.reflected)) },
              { name: "irradiance Li cosθi dωi", value: figureOf(answer?.irradiance) },
              { name: "their ratio", value: answer === null ? null : `${figureOf(first(answer.ratio))} sr⁻¹`, strong: true },
              { name: "f(ωi→ωr)", value: answer === null ? null : `${figureOf(first(answer.f))} sr⁻¹` },
            ]}
          />
        </>
      }
    >
      <Polar
        label={`Rough gold: f in the plane of incidence, light from a cone of ${half}° around ${-light}°, viewer at ${viewer}°.`}
        lobes={[{ look: "ls-0", reply: curve.reply }]}
        lights={[{ angle: light }]}
        viewer={viewer}
        cone={half}
      />
    </Figure>
  );
}

const SIZE = 132;
const ALL = { light: true, brdf: true, cosine: true };

export function Linearity(): JSX.Element {
  const [left, setLeft] = useState(1);
  const [right, setRight] = useState(0.5);
  const paint = "lambertian:reflectance=0.5/0.12/0.1";
  const gloss = "ggx:roughness=0.3,f0=0.06";
  const sum = `sum(${paint}, ${gloss})`;
  const a = useAnswer("ball", { function: sum, light: { theta: 50, phi: 150 }, size: SIZE, factors: ALL });
  const b = useAnswer("ball", { function: sum, light: { theta: 60, phi: 20 }, size: SIZE, factors: ALL });
  const light = { theta: 50, phi: 150 };
  const parts = [useAnswer("ball", { function: paint, light, size: SIZE, factors: ALL }), useAnswer("ball", { function: gloss, light, size: SIZE, factors: ALL })];
  const [va, vb] = [a.reply?.arrays.values ?? null, b.reply?.arrays.values ?? null];
  const both = useMemo(() => (va === null || vb === null ? null : va.map((x, i) => left * x + right * vb[i]!)), [va, vb, left, right]);
  const [vp, vg] = [parts[0]!.reply?.arrays.values ?? null, parts[1]!.reply?.arrays.values ?? null];
  // How far the picture of the sum is from the sum of the pictures, where it is farthest.
  const apart = useMemo(() => {
    if (va === null || vp === null || vg === null) return null;
    return va.reduce((most, x, i) => (Number.isNaN(x) ? most : Math.max(most, Math.abs(x - vp[i]! - vg[i]!))), 0);
  }, [va, vp, vg]);
  return (
    <Figure
      complaint={a.complaint ?? b.complaint ?? parts[0]!.complaint ?? parts[1]!.complaint}
      caption="Above: two lights, each alone and both together, as bright as they are set; no light needs to be computed again. Below: diffuse paint and a gloss, and their sum."
      controls={
        <>
          <Slider label="light from the left" value={left} min={0} max={2} step={0.05} onValue={setLeft} />
          <Slider label="light from the right" value={right} min={0} max={2} step={0.05} onValue={setRight} />
          <Numbers rows={[{ name: "f₁ + f₂ against their sum, largest difference of a pixel", value: figureOf(apart, 2) }]} />
        </>
      }
    >
      <div class="learn-pictures">
        <Picture label="A ball under the light from the left" name="a" values={va} width={SIZE} height={SIZE} exposure={Math.log2(Math.max(left, 1e-3))} />
        <span class="sign">+</span>
        <Picture label="A ball under the light from the right" name="b" values={vb} width={SIZE} height={SIZE} exposure={Math.log2(Math.max(right, 1e-3))} />
        <span class="sign">=</span>
        <Picture label="The ball under both lights" name="a + b" values={both} width={SIZE} height={SIZE} />
      </div>
      <div class="learn-pictures">
        <Picture label="A ball of diffuse paint" name="f₁, paint" values={vp} width={SIZE} height={SIZE} />
        <span class="sign">+</span>
        <Picture label="A black ball with a gloss" name="f₂, gloss" values={vg} width={SIZE} height={SIZE} />
        <span class="sign">=</span>
        <Picture label="A ball of glossy paint" name="f₁ + f₂" values={va} width={SIZE} height={SIZE} />
      </div>
    </Figure>
  );
}

const RECIPROCAL = [
  ["toon:bands=3,highlight_deg=12", "cartoon shader"],
  ["gooch", "technical illustration"],
  ["ggx:metal=copper,roughness=0.4", "rough copper"],
  ["oren-nayar:sigma_deg=30", "rough plaster"],
] as const;

export function Reciprocity(): JSX.Element {
  const [text, setText] = useState<string>(RECIPROCAL[0][0]);
  const [a, setA] = useState(-60);
  const [b, setB] = useState(20);
  const [wa, wb] = [inPlane(a), inPlane(b)];
  const there = useAnswer("curve", { function: text, wi: wa, cosine: false });
  const back = useAnswer("curve", { function: text, wi: wb, cosine: false });
  const forward = useAnswer("evaluate", { function: text, wi: wa, wo: wb });
  const swapped = useAnswer("evaluate", { function: text, wi: wb, wo: wa });
  const [f, g] = [first(forward.reply?.answer.f_per_sr), first(swapped.reply?.answer.f_per_sr)];
  const differ = f !== null && g !== null && Math.abs(f - g) > 1e-9 * Math.max(Math.abs(f), Math.abs(g));
  // `curve` has positive angles away from its light; the second plot is drawn as the first one.
  const largest = Math.max(...[there, back].map(({ reply }) => (reply === null ? 0 : luminance(...reply.answer.largest))));
  return (
    <Figure
      complaint={there.complaint ?? back.complaint ?? forward.complaint ?? swapped.complaint}
      layout="halves"
      caption="The light at a seen from b, and the light at b seen from a."
      controls={
        <>
          <Choice label="function" value={text} options={RECIPROCAL} onValue={setText} />
          <Slider label="direction a" value={a} min={-85} max={0} unit="°" onValue={setA} />
          <Slider label="direction b" value={b} min={0} max={85} unit="°" onValue={setB} />
          <Numbers
            rows={[
              { name: "f(a→b)", value: f === null ? null : `${figureOf(f)} sr⁻¹` },
              { name: "f(b→a)", value: g === null ? null : `${figureOf(g)} sr⁻¹` },
              { name: "reciprocal here", value: f === null || g === null ? null : differ ? "no" : "yes", strong: true },
            ]}
          />
        </>
      }
    >
      <Polar label={`Light from a, ${a}°; viewer at b, ${b}°: ${figureOf(f) ?? "…"} per steradian.`} lobes={[{ look: "ls-0", reply: there.reply }]} lights={[{ angle: a, name: "a" }]} viewer={b} largest={largest} />
      <Polar label={`Light from b, ${b}°; viewer at a, ${a}°: ${figureOf(g) ?? "…"} per steradian.`} lobes={[{ look: "ls-1", reply: mirrorOf(back.reply) }]} lights={[{ angle: b, name: "b" }]} viewer={a} largest={largest} />
    </Figure>
  );
}

/** The curve with its angles seen from the other side. */
function mirrorOf<R extends { arrays: Record<string, Float32Array> } | null>(reply: R): R {
  if (reply === null) return reply;
  const { angles } = reply.arrays;
  return angles === undefined ? reply : { ...reply, arrays: { ...reply.arrays, angles: angles.map((x) => -x) } };
}

const STEPS = 72;

export function Isotropy(): JSX.Element {
  const [brushed, setBrushed] = useState(true);
  const [turn, setTurn] = useState(30);
  const text = brushed ? "ggx:metal=aluminium,alpha_x=0.08,alpha_y=0.35" : "ggx:metal=aluminium,alpha=0.17";
  const [wi, wo] = [
    { theta: 45, phi: 180 },
    { theta: 52, phi: 14 },
  ];
  const { answer, arrays, complaint } = useLearn<{ least: number; largest: number }>({ figure: "turn", function: text, wi, wo, steps: STEPS });
  const { values } = arrays;
  const points = values === undefined ? [] : Array.from({ length: STEPS + 1 }, (_, k): [number, number] => [(360 * k) / STEPS, luminance(values[3 * k]!, values[3 * k + 1]!, values[3 * k + 2]!)]);
  const now = points[Math.round((turn / 360) * STEPS)]?.[1];
  return (
    <Figure
      complaint={complaint}
      layout="halves"
      caption="The light and the viewer stay, the surface turns about its normal. What depends on how it lies is anisotropic."
      controls={
        <>
          <Check label="brushed" value={brushed} onValue={setBrushed} />
          <Slider label="turned by" value={turn} min={0} max={360} step={5} unit="°" onValue={setTurn} />
          <Numbers
            rows={[
              { name: "f now", value: now === undefined ? null : `${figureOf(now)} sr⁻¹`, strong: true },
              { name: "least", value: figureOf(answer?.least) },
              { name: "largest", value: figureOf(answer?.largest) },
            ]}
          />
        </>
      }
    >
      <Drawing ratio={1.9} label={`The surface from above, turned by ${turn}°${brushed ? ", with the strokes of the brush" : ""}.`}>
        {({ width, height }) => {
          const [cx, cy, r] = [width / 2, height / 2, height / 2 - 10];
          const at = (phi: number, d: number): [number, number] => [cx + d * Math.cos((phi * Math.PI) / 180), cy - d * Math.sin((phi * Math.PI) / 180)];
          return (
            <>
              <circle class="globe" cx={cx} cy={cy} r={r} />
              {brushed ? (
                <g transform={`rotate(${-turn} ${cx} ${cy})`}>
                  {Array.from({ length: 13 }, (_, i) => (i - 6) / 7).map((y) => {
                    const half = r * Math.sqrt(1 - y * y);
                    return <line key={y} class="stroke" y1={cy - half} y2={cy + half} x1={cx + y * r} x2={cx + y * r} />;
                  })}
                </g>
              ) : null}
              <g class="light">
                <Arrow from={at(wi.phi, r + 6)} to={at(wi.phi, 0.25 * r)} />
              </g>
              <g class="viewer">
                <Arrow from={at(wo.phi, 0.25 * r)} to={at(wo.phi, r + 6)} />
              </g>
            </>
          );
        }}
      </Drawing>
      <Chart
        label="f over the angle by which the surface is turned."
        x={{ from: 0, to: 360, name: "turned by, degrees", ticks: [0, 90, 180, 270, 360] }}
        y={{ from: 0, to: Math.max(1e-6, (answer?.largest ?? 1) * 1.15), name: "f in sr⁻¹" }}
        lines={[{ name: "f", look: "ls-0", points }]}
        mark={turn}
      />
    </Figure>
  );
}
