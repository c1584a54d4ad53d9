/** T19 to T21: measured tables, non-photorealistic reflection, environment maps. */
import type { JSX } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { shown } from "../../plot/tone";
import { ofValue } from "../../plot/colours";
import { halfDifference } from "../../plot/directions";
import { axis } from "../../plot/scale";
import { luminance } from "../chart";
import { Choice, Figure, Numbers, Slider, figureOf } from "../figure";
import { Picture } from "../picture";
import { useAnswer, useAssets, useLearn } from "../use";
import { inPlane } from "./reflection";

const TABLES = [
  ["ward@gold-paint", "gold paint, a fit"],
  ["ggx:metal=copper,roughness=0.35", "rough copper"],
  ["oren-nayar:reflectance=0.5,sigma_deg=30", "rough plaster"],
  ["retro-reflective", "a road sign"],
] as const;

/** Five decades, as the explorer's slices have them; what is below the horizon is left out. */
function falseColours(top: number): (out: Uint8ClampedArray, values: ArrayLike<number>) => void {
  const scale = axis("log", top * 1e-5, top);
  return (out, values) => {
    for (let i = 0; i < out.length / 4; i += 1) {
      const colour = ofValue("luminance", scale, values, 3 * i);
      out.set(colour, 4 * i);
      out[4 * i + 3] = Number.isNaN(values[3 * i]!) ? 0 : 255;
    }
  };
}

export function Measured(): JSX.Element {
  const [text, setText] = useState<string>(TABLES[0][0]);
  const [light, setLight] = useState(-50);
  const [viewer, setViewer] = useState(40);
  const [wi, wo] = [inPlane(light), inPlane(viewer)];
  const slice = useAnswer("slice", { function: text, phi_d: 90 });
  const value = useAnswer("evaluate", { function: text, wi, wo });
  const { thetaH, thetaD } = halfDifference(wi, wo);
  const { side = 1, largest = [1, 1, 1] } = slice.reply?.answer ?? {};
  const top = Math.max(...largest);
  const paint = useMemo(() => falseColours(top), [top]);
  const place = (angle: number): number => (100 * angle) / 90;
  return (
    <Figure
      complaint={slice.complaint ?? value.complaint}
      caption="A table holds a value for each pair of directions. By half and difference angle the highlight lies along the left edge, what returns to the light along the bottom, and grazing light at the top: 90 rows and columns say nearly everything of an isotropic material. A measured file that is dropped on the explorer is shown the same way."
      controls={
        <>
          <Choice label="material" value={text} options={TABLES} onValue={setText} />
          <Slider label="light θi" value={-light} min={0} max={85} unit="°" onValue={(v) => setLight(-v)} />
          <Slider label="viewer" value={viewer} min={-85} max={85} unit="°" onValue={setViewer} />
          <Numbers
            rows={[
              { name: "half angle θh", value: `${figureOf(thetaH, 4)}°` },
              { name: "difference angle θd", value: `${figureOf(thetaD, 4)}°` },
              { name: "f", value: value.reply === null ? null : `${figureOf(luminance(...value.reply.answer.f_per_sr))} sr⁻¹`, strong: true },
            ]}
          />
        </>
      }
    >
      <div class="learn-slice">
        <Picture label="f by half angle, from left to right, and difference angle, from below to above." values={slice.reply?.arrays.values ?? null} width={side} height={side} paint={paint} />
        <svg class="learn-slice-mark" viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">
          <path d={`M${place(thetaH)} 0V100M0 ${100 - place(thetaD)}H100`} />
        </svg>
        <span class="learn-slice-x">θh, 0 to 90°</span>
        <span class="learn-slice-y">θd, 0 to 90°</span>
      </div>
    </Figure>
  );
}

const BALL = 150;

export function NonPhotorealistic(): JSX.Element {
  const [bands, setBands] = useState(3);
  const [theta, setTheta] = useState(50);
  const light = { theta, phi: 140 };
  const factors = { light: true, brdf: true, cosine: true };
  const texts = ["lambertian:reflectance=0.7/0.2/0.1", `toon:reflectance=0.7/0.2/0.1,bands=${bands},rim=0.4`, "gooch:reflectance=0.7/0.2/0.1"];
  const balls = [
    useAnswer("ball", { function: texts[0]!, light, size: BALL, factors }),
    useAnswer("ball", { function: texts[1]!, light, size: BALL, factors }),
    useAnswer("ball", { function: texts[2]!, light, size: BALL, factors }),
  ];
  const said = [useAnswer("describe", { function: texts[0]! }), useAnswer("describe", { function: texts[1]! }), useAnswer("describe", { function: texts[2]! })];
  const names = ["diffuse", "cartoon", "technical"];
  return (
    <Figure
      complaint={[...balls, ...said].find(({ complaint }) => complaint !== null)?.complaint ?? null}
      caption="The same colour and light. What such a function lacks is declared, measured and printed, not hidden."
      controls={
        <>
          <Slider label="bands of the cartoon" value={bands} min={1} max={8} onValue={setBands} />
          <Slider label="light from the viewer" value={theta} min={0} max={120} unit="°" onValue={setTheta} />
          <Numbers
            rows={said.map(({ reply }, i) => ({
              name: names[i]!,
              value: reply === null ? null : `${reply.answer.declares.reciprocal ? "reciprocal" : "not reciprocal"}, ${reply.answer.declares.energy_conserving ? "conserves energy" : "may gain energy"}`,
            }))}
          />
        </>
      }
    >
      <div class="learn-pictures">
        {balls.map(({ reply }, i) => (
          <Picture key={names[i]} label={`The ${names[i]} ball`} name={names[i]!} values={reply?.arrays.values ?? null} width={BALL} height={BALL} />
        ))}
      </div>
    </Figure>
  );
}

const SIZE = 160;

export function EnvironmentMap(): JSX.Element {
  const assets = useAssets(["sunset.hdr"]);
  const [unwrapped, setUnwrapped] = useState(0);
  const { answer, arrays, complaint } = useLearn<{ largest: number[] }>(assets.ready ? { figure: "mirror-ball", light: "files/sunset.hdr", size: SIZE } : null);
  return (
    <Figure
      complaint={complaint ?? assets.complaint}
      caption="A photograph of a mirrored ball shows light from nearly every direction; at its rim, from behind it. Each of its points is a direction, and has a place in the panorama."
      controls={
        <>
          <Slider label="unwrapped" value={unwrapped} min={0} max={100} unit=" %" onValue={setUnwrapped} />
          {answer !== null ? <Numbers rows={[{ name: "brightest radiance", value: figureOf(Math.max(...answer.largest), 4) }]} /> : null}
        </>
      }
    >
      <Unwrapping mesh={arrays.mesh} share={unwrapped / 100} />
      <div class="learn-pictures">
        <Picture label="The mirrored ball" name="mirrored ball" values={arrays.ball ?? null} width={SIZE} height={SIZE} />
        <Picture label="The panorama" name="panorama" values={arrays.panorama ?? null} width={2 * SIZE} height={SIZE} />
      </div>
    </Figure>
  );
}

/** Of the mesh; its rows follow each other. */
const COLUMNS = 128;

/** Points of the ball on their way to the panorama. */
function Unwrapping({ mesh, share }: { mesh: Float32Array | undefined; share: number }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const colours = useMemo(() => {
    if (mesh === undefined) return [];
    return Array.from({ length: mesh.length / 7 }, (_, i) => `rgb(${shown(Array.from(mesh.subarray(7 * i + 4, 7 * i + 7)), 0, "pbr-neutral").join(" ")})`);
  }, [mesh]);
  useEffect(() => {
    const element = canvas.current;
    const context = element?.getContext("2d");
    if (element == null || context == null || mesh === undefined) return;
    const { width, height } = element;
    context.clearRect(0, 0, width, height);
    const radius = height * 0.47;
    // Slow at both ends, so that one sees where it begins and ends.
    const t = share * share * (3 - 2 * share);
    const rows = colours.length / COLUMNS;
    // Columns go on beyond the last one: there the panorama closes.
    const at = (row: number, column: number): [number, number] => {
      const i = 7 * (row * COLUMNS + (column % COLUMNS));
      const u = mesh[i + 2]! + (column >= COLUMNS ? 1 : 0);
      return [(1 - t) * (width / 2 + radius * mesh[i]!) + t * (u * width), (1 - t) * (height / 2 - radius * mesh[i + 1]!) + t * (mesh[i + 3]! * height)];
    };
    const apart = (a: [number, number], b: [number, number]): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
    for (let row = 0; row + 1 < rows; row += 1) {
      for (let column = 0; column < COLUMNS; column += 1) {
        const corners = [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)] as const;
        // The direction behind the ball is its whole rim: what lies around it belongs to no one place.
        if (apart(corners[0], corners[2]) > radius / 2 || apart(corners[1], corners[3]) > radius / 2) continue;
        context.fillStyle = context.strokeStyle = colours[row * COLUMNS + column]!;
        context.beginPath();
        for (const [x, y] of corners) context.lineTo(x, y);
        context.closePath();
        context.fill();
        // Without it the seams between smooth edges shine through.
        context.stroke();
      }
    }
  }, [mesh, colours, share]);
  return <canvas ref={canvas} class="learn-unwrapping" width={640} height={320} role="img" aria-label={`The mirrored ball, ${Math.round(100 * share)} % unwrapped into a panorama.`} />;
}
