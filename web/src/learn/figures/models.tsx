/** T14 to T18: mirror, diffuse and specular reflection, Fresnel's equations, Torrance–Sparrow. */
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { number } from "../../plot/scale";
import { Chart, Legend, luminance, pairs } from "../chart";
import { Choice, Figure, Numbers, Slider, figureOf } from "../figure";
import { Picture } from "../picture";
import { Polar } from "../polar";
import { useAnswer, useLearn } from "../use";
import { inPlane } from "./reflection";

const BALL = 150;
const ALL = { light: true, brdf: true, cosine: true };

export function Mirror(): JSX.Element {
  const [theta, setTheta] = useState(40);
  const [metal, setMetal] = useState<"silver" | "gold" | "copper" | "aluminium">("silver");
  const text = `mirror:metal=${metal}`;
  const curve = useAnswer("curve", { function: text, wi: inPlane(-theta), cosine: false });
  const beside = useAnswer("evaluate", { function: text, wi: inPlane(-theta), wo: inPlane(theta) });
  const spikes = curve.reply?.arrays.spikes;
  return (
    <Figure
      complaint={curve.complaint ?? beside.complaint}
      caption="All that is reflected goes into one direction, on the other side of the normal at the same angle. A density has no value for it: f is 0 in every direction that can be named, and the share is known to the sampling alone."
      controls={
        <>
          <Choice
            label="metal"
            value={metal}
            options={[
              ["silver", "silver"],
              ["aluminium", "aluminium"],
              ["gold", "gold"],
              ["copper", "copper"],
            ]}
            onValue={setMetal}
          />
          <Slider label="light θi" value={theta} min={0} max={89} unit="°" onValue={setTheta} />
          <Numbers
            rows={[
              { name: "direction", value: spikes === undefined || spikes.length < 4 ? null : `${figureOf(spikes[0], 4)}°` },
              { name: "share red", value: figureOf(spikes?.[1]), strong: true },
              { name: "share green", value: figureOf(spikes?.[2]), strong: true },
              { name: "share blue", value: figureOf(spikes?.[3]), strong: true },
              { name: "f, as a density", value: beside.reply === null ? null : figureOf(beside.reply.answer.f_per_sr[0]) },
            ]}
          />
        </>
      }
    >
      <Polar label={`A mirror of ${metal}: light from ${theta}° leaves at ${theta}° on the other side.`} lobes={[{ look: "ls-0", reply: curve.reply }]} lights={[{ angle: -theta }]} />
    </Figure>
  );
}

export function Diffuse(): JSX.Element {
  const [reflectance, setReflectance] = useState(0.6);
  const [theta, setTheta] = useState(40);
  const text = `lambertian:reflectance=${reflectance}`;
  const f = useAnswer("curve", { function: text, wi: inPlane(-theta), cosine: false });
  const cosine = useAnswer("curve", { function: text, wi: inPlane(-theta), cosine: true });
  const value = useAnswer("evaluate", { function: text, wi: inPlane(-theta), wo: inPlane(theta) });
  const ball = useAnswer("ball", { function: text, light: { theta: 50, phi: 140 }, size: BALL, factors: ALL });
  return (
    <Figure
      complaint={f.complaint ?? cosine.complaint ?? value.complaint ?? ball.complaint}
      layout="beside"
      caption="f is the same towards every viewer, wherever the light is. Times cosθr, the power that leaves in each direction is a sphere on the surface."
      controls={
        <>
          <Slider label="reflectance ρd" value={reflectance} min={0} max={1} step={0.01} onValue={setReflectance} />
          <Slider label="light θi" value={theta} min={0} max={89} unit="°" onValue={setTheta} />
          <Numbers rows={[{ name: "f = ρd / π", value: value.reply === null ? null : `${figureOf(value.reply.answer.f_per_sr[0])} sr⁻¹`, strong: true }]} />
        </>
      }
    >
      <div>
        <Polar
          label={`A diffuse surface of reflectance ${reflectance}.`}
          lobes={[
            { look: "ls-0", reply: f.reply },
            { look: "ls-1", reply: cosine.reply },
          ]}
          lights={[{ angle: -theta }]}
          largest={0.32}
        />
        <Legend
          lines={[
            { name: "f", look: "ls-0" },
            { name: "f cosθr", look: "ls-1" },
          ]}
        />
      </div>
      <Picture label="A diffuse ball" values={ball.reply?.arrays.values ?? null} width={BALL} height={BALL} />
    </Figure>
  );
}

export function Specular(): JSX.Element {
  const [power, setPower] = useState(4);
  const [theta, setTheta] = useState(45);
  const [form, setForm] = useState<"published" | "energy">("published");
  const exponent = Math.round(2 ** power);
  const text = `phong:diffuse=0.2,specular=0.7,exponent=${exponent},normalisation=${form}`;
  const curve = useAnswer("curve", { function: text, wi: inPlane(-theta), cosine: false });
  const albedo = useAnswer("albedo", { function: text, thetas: [theta], phi: 0 });
  const ball = useAnswer("ball", { function: text, light: { theta: 50, phi: 140 }, size: BALL, factors: ALL });
  const reflected = albedo.reply?.arrays.reflected;
  return (
    <Figure
      complaint={curve.complaint ?? albedo.complaint ?? ball.complaint}
      layout="beside"
      caption="The larger the exponent, the narrower the lobe. As published its height stays, so a narrow lobe carries hardly any light and a wide one too much; normalised, its energy stays."
      controls={
        <>
          <Choice
            label="form"
            value={form}
            options={[
              ["published", "as published"],
              ["energy", "normalised by its energy"],
            ]}
            onValue={setForm}
          />
          <Slider label="exponent p" value={power} min={0} max={9} step={0.25} text={String(exponent)} onValue={setPower} />
          <Slider label="light θi" value={theta} min={0} max={80} unit="°" onValue={setTheta} />
          <Numbers rows={[{ name: "share of the light that leaves", value: reflected === undefined ? null : figureOf(luminance(reflected[0]!, reflected[1]!, reflected[2]!), 4), strong: true }]} />
        </>
      }
    >
      <Polar label={`Phong's model with the exponent ${exponent}.`} lobes={[{ look: "ls-0", reply: curve.reply }]} lights={[{ angle: -theta }]} />
      <Picture label="A ball of it" values={ball.reply?.arrays.values ?? null} width={BALL} height={BALL} />
    </Figure>
  );
}

interface FresnelAnswer {
  f0: number;
  brewster: number | null;
  difference: number;
  at: number;
}

const MEDIA = [
  ["1.5 0", "glass, 1.5"],
  ["1.33 0", "water, 1.33"],
  ["2.42 0", "diamond, 2.42"],
  ["0.2 3.4", "like gold, 0.2 + 3.4 i"],
  ["1.5 7.6", "like aluminium, 1.5 + 7.6 i"],
] as const;

export function Fresnel(): JSX.Element {
  const [medium, setMedium] = useState<string>(MEDIA[0][0]);
  const [theta, setTheta] = useState(60);
  const [ior, k] = medium.split(" ").map(Number) as [number, number];
  const { answer, arrays, complaint } = useLearn<FresnelAnswer>({ figure: "fresnel", ior, k });
  const { angles, s, p, unpolarised, schlick } = arrays;
  const at = angles === undefined ? -1 : angles.findIndex((a) => a >= theta);
  return (
    <Figure
      complaint={complaint}
      caption="What a smooth boundary reflects: light that swings across the plane of incidence (s), in it (p), both as they come, and Schlick's formula with the same value at 0°."
      controls={
        <>
          <Choice label="index of refraction" value={medium} options={MEDIA} onValue={setMedium} />
          <Slider label="θ" value={theta} min={0} max={90} unit="°" onValue={setTheta} />
          <Numbers
            rows={[
              { name: "F0", value: figureOf(answer?.f0) },
              { name: "F, full equations", value: at < 0 ? null : figureOf(unpolarised?.[at]), strong: true },
              { name: "F, Schlick", value: at < 0 ? null : figureOf(schlick?.[at]), strong: true },
              { name: "largest difference", value: answer === null ? null : `${figureOf(answer.difference, 3)} at ${number(answer.at)}°` },
              { name: "Brewster's angle", value: answer === null ? null : answer.brewster === null ? "none" : `${figureOf(answer.brewster, 4)}°` },
            ]}
          />
        </>
      }
    >
      <Chart
        label={`Fresnel reflectance over the angle for the index ${ior}${k > 0 ? ` + ${k} i` : ""}.`}
        x={{ from: 0, to: 90, name: "θ in degrees", ticks: [0, 15, 30, 45, 60, 75, 90] }}
        y={{ from: 0, to: 1, name: "F" }}
        lines={[
          { name: "s", look: "ls-7", points: pairs(angles, s), dashed: true },
          { name: "p", look: "ls-3", points: pairs(angles, p), dashed: true },
          { name: "full equations", look: "ls-0", points: pairs(angles, unpolarised) },
          { name: "Schlick", look: "ls-1", points: pairs(angles, schlick) },
        ]}
        mark={theta}
      />
    </Figure>
  );
}

export function TorranceSparrow(): JSX.Element {
  const [roughness, setRoughness] = useState(0.4);
  const [theta, setTheta] = useState(50);
  const [ior, setIor] = useState(1.5);
  const { arrays, complaint } = useLearn({ figure: "torrance-sparrow", roughness, ior, theta });
  const { angles, d, g, f, value } = arrays;
  const relative = (values: Float32Array | undefined): { points: [number, number][]; most: number } => {
    const points = pairs(angles, values);
    const most = points.reduce((m, [, y]) => (Number.isFinite(y) ? Math.max(m, y) : m), 0);
    return { points: points.map(([a, y]) => [a, most > 0 ? y / most : 0]), most };
  };
  const [facets, whole] = [relative(d), relative(value)];
  return (
    <Figure
      complaint={complaint}
      caption="The factors in the plane of incidence, with D and f each as a share of its largest value. Grazing light moves the lobe away from the mirror direction, towards the horizon."
      controls={
        <>
          <Slider label="roughness" value={roughness} min={0.1} max={1} step={0.02} onValue={setRoughness} />
          <Slider label="light θi" value={theta} min={0} max={85} unit="°" onValue={setTheta} />
          <Slider label="index of refraction" value={ior} min={1.1} max={3} step={0.05} onValue={setIor} />
          <Numbers
            rows={[
              { name: "largest D", value: whole.most === 0 ? null : `${figureOf(facets.most, 4)} sr⁻¹` },
              { name: "largest f", value: whole.most === 0 ? null : `${figureOf(whole.most, 4)} sr⁻¹`, strong: true },
            ]}
          />
        </>
      }
    >
      <Chart
        label="The distribution D, the masking G, Fresnel's F and f over the angle of view."
        x={{ from: -90, to: 90, name: "viewer, degrees from the normal", ticks: [-90, -60, -30, 0, 30, 60, 90] }}
        y={{ from: 0, to: 1, name: "factor" }}
        lines={[
          { name: "D, facets that mirror there", look: "ls-1", points: facets.points },
          { name: "G, seen and lit", look: "ls-2", points: pairs(angles, g) },
          { name: "F, reflected", look: "ls-3", points: pairs(angles, f) },
          { name: "f", look: "ls-0", points: whole.points },
        ]}
        mark={theta}
      />
    </Figure>
  );
}
