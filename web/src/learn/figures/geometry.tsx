/** T2 to T4: solid angle, spherical coordinates, the differential solid angle. */
import type { ComponentChildren, JSX } from "preact";
import { useState } from "preact/hooks";
import { type Vector, toVector } from "../../plot/directions";
import { Drawing, Figure, Numbers, Slider, figureOf, type Size } from "../figure";
import { Camera, arc, ring, times } from "../space";
import { useLearn } from "../use";

const camera = ({ width, height }: Size): Camera => new Camera(32, 20, [width / 2, height * 0.52], Math.min(height, width) * 0.42);

/** The sphere as an outline and its equator, and what is drawn on it. */
function Globe({ size, radius = 1, children }: { size: Size; radius?: number; children: (camera: Camera) => ComponentChildren }): JSX.Element {
  const view = camera(size);
  const centre = view.place([0, 0, 0]);
  const equator = view.line(ring({ theta: 0, phi: 0 }, 90).map((v) => times(v, radius)), true);
  const meridian = view.line(ring({ theta: 90, phi: 90 }, 90).map((v) => times(v, radius)), true);
  return (
    <>
      <circle class="globe" cx={centre.x} cy={centre.y} r={radius * view.scale} />
      <path class="back" d={equator.back + meridian.back} />
      {children(view)}
      <path class="grid" d={equator.front + meridian.front} />
    </>
  );
}

const Segment = ({ view, from = [0, 0, 0], to, look }: { view: Camera; from?: Vector; to: Vector; look: string }): JSX.Element => {
  const [a, b] = [view.place(from), view.place(to)];
  return <line class={look} x1={a.x} y1={a.y} x2={b.x} y2={b.y} />;
};

const Name = ({ view, at, children }: { view: Camera; at: Vector; children: string }): JSX.Element => {
  const p = view.place(at);
  return (
    <text class="symbol" text-anchor="middle" x={p.x} y={p.y + 5}>
      {children}
    </text>
  );
};

const AXIS = { theta: 55, phi: 40 };

export function SolidAngle(): JSX.Element {
  const [half, setHalf] = useState(30);
  const [radius, setRadius] = useState(1);
  const { answer, complaint } = useLearn<{ steradians: number; share: number }>({ figure: "solid-angle", half_angle: half });
  const omega = answer?.steradians;
  const drawn = 0.45 + 0.55 * (radius / 2);
  return (
    <Figure
      complaint={complaint}
      caption="The area that a cone cuts out of a sphere grows as r²; the solid angle is the same at every radius."
      controls={
        <>
          <Slider label="half angle of the cone" value={half} min={1} max={180} unit="°" onValue={setHalf} />
          <Slider label="radius r" value={radius} min={0.5} max={2} step={0.05} unit=" m" onValue={setRadius} />
          <Numbers
            rows={[
              { name: "A", value: omega === undefined ? null : `${figureOf(omega * radius * radius)} m²` },
              { name: "Ω = A / r²", value: omega === undefined ? null : `${figureOf(omega)} sr`, strong: true },
              { name: "of the whole sphere", value: answer === null ? null : `${figureOf(100 * answer.share, 4)} %` },
            ]}
          />
        </>
      }
    >
      <Drawing ratio={1.35} label={`A cone of half angle ${half}° from the centre of a sphere, and the cap that it cuts out: ${figureOf(omega) ?? "…"} steradians.`}>
        {(size) => (
          <Globe size={size} radius={drawn}>
            {(view) => {
              const edge = ring(AXIS, half).map((v) => times(v, drawn));
              const path = view.line(edge, true);
              const rays = [0, 9, 18, 27, 36, 45, 54, 63].map((i) => edge[i]!);
              return (
                <g class="ls-0">
                  <path class="patch" d={view.shape(edge)} />
                  {rays.map((to, i) => (
                    <Segment key={i} view={view} to={to} look="thin" />
                  ))}
                  <path class="back" d={path.back} />
                  <path class="curve" d={path.front} />
                </g>
              );
            }}
          </Globe>
        )}
      </Drawing>
    </Figure>
  );
}

interface Spherical {
  x: number;
  y: number;
  z: number;
  back: { r: number; theta: number; phi: number };
}

export function SphericalCoordinates(): JSX.Element {
  const [theta, setTheta] = useState(50);
  const [phi, setPhi] = useState(60);
  const [r, setR] = useState(1);
  const { answer, complaint } = useLearn<Spherical>({ figure: "spherical", theta, phi, r });
  const tip = times(toVector({ theta, phi }), r);
  const foot: Vector = [tip[0], tip[1], 0];
  return (
    <Figure
      complaint={complaint}
      caption="θ is measured from the normal z, φ around it from x towards y. On the normal itself φ has no meaning."
      controls={
        <>
          <Slider label="θ" value={theta} min={0} max={180} unit="°" onValue={setTheta} />
          <Slider label="φ" value={phi} min={-180} max={180} unit="°" onValue={setPhi} />
          <Slider label="r" value={r} min={0.2} max={1} step={0.05} onValue={setR} />
          <Numbers
            rows={[
              { name: "x", value: figureOf(answer?.x) },
              { name: "y", value: figureOf(answer?.y) },
              { name: "z", value: figureOf(answer?.z) },
              { name: "back: θ", value: answer === null ? null : `${figureOf(answer.back.theta)}°` },
              { name: "back: φ", value: answer === null ? null : `${figureOf(answer.back.phi)}°` },
              { name: "back: r", value: figureOf(answer?.back.r) },
            ]}
          />
        </>
      }
    >
      <Drawing ratio={1.35} label={`The point at θ ${theta}°, φ ${phi}°, r ${r}, with its angles and its coordinates.`}>
        {(size) => (
          <Globe size={size}>
            {(view) => {
              const polar = view.line(arc({ theta: 0, phi }, { theta, phi }).map((v) => times(v, 0.5 * r)));
              const around = view.line(arc({ theta: 90, phi: 0 }, { theta: 90, phi }).map((v) => times(v, 0.4)));
              return (
                <>
                  {(["x", "y", "z"] as const).map((name, i) => {
                    const end = [0, 0, 0].map((_, k) => (k === i ? 1.12 : 0)) as unknown as Vector;
                    return (
                      <g key={name}>
                        <Segment view={view} to={end} look="axis" />
                        <Name view={view} at={times(end, 1.09)}>
                          {name}
                        </Name>
                      </g>
                    );
                  })}
                  <g class="ls-0">
                    <path class="curve" d={polar.front + polar.back} />
                    <Name view={view} at={times(toVector({ theta: theta / 2, phi }), 0.6 * r + 0.05)}>
                      θ
                    </Name>
                  </g>
                  <g class="ls-1">
                    <path class="curve" d={around.front + around.back} />
                    <Name view={view} at={times(toVector({ theta: 90, phi: phi / 2 }), 0.54)}>
                      φ
                    </Name>
                  </g>
                  <Segment view={view} to={foot} look="thin dashed" />
                  <Segment view={view} from={foot} to={tip} look="thin dashed" />
                  <Segment view={view} to={tip} look="strong" />
                  <circle class="point" cx={view.place(tip).x} cy={view.place(tip).y} r={5} />
                </>
              );
            }}
          </Globe>
        )}
      </Drawing>
    </Figure>
  );
}

interface Differential {
  differential: number;
  exact: number;
  sum: number;
  whole: number;
}

export function DifferentialSolidAngle(): JSX.Element {
  const [theta, setTheta] = useState(50);
  const [step, setStep] = useState(15);
  const { answer, complaint } = useLearn<Differential>({ figure: "differential", theta, phi: 40, dtheta: step, dphi: step });
  const edge = (t: number, from: number, to: number): Vector[] => arc({ theta: t, phi: from }, { theta: t, phi: to }, 12);
  const side = (p: number, from: number, to: number): Vector[] => arc({ theta: from, phi: p }, { theta: to, phi: p }, 12);
  return (
    <Figure
      complaint={complaint}
      caption="The same step in θ and φ covers less near the pole: its width is sinθ dφ. Smaller steps add up to the sphere more exactly."
      controls={
        <>
          <Slider label="θ of the patch" value={theta} min={0} max={180} unit="°" onValue={setTheta} />
          <Slider label="dθ = dφ" value={step} min={1} max={30} unit="°" onValue={setStep} />
          <Numbers
            rows={[
              { name: "sinθ dθ dφ", value: answer === null ? null : `${figureOf(answer.differential)} sr`, strong: true },
              { name: "the patch exactly", value: answer === null ? null : `${figureOf(answer.exact)} sr` },
              { name: "all patches together", value: answer === null ? null : `${figureOf(answer.sum, 7)} sr` },
              { name: "4π", value: answer === null ? null : `${figureOf(answer.whole, 7)} sr` },
            ]}
          />
        </>
      }
    >
      <Drawing ratio={1.35} label={`A patch of the sphere at θ ${theta}°, ${step}° wide in θ and in φ: ${figureOf(answer?.differential) ?? "…"} steradians.`}>
        {(size) => (
          <Globe size={size}>
            {(view) => {
              const [t0, t1, p0, p1] = [theta - step / 2, theta + step / 2, 40 - step / 2, 40 + step / 2];
              const outline = [...edge(t0, p0, p1), ...side(p1, t0, t1), ...edge(t1, p1, p0), ...side(p0, t1, t0)];
              const path = view.line(outline, true);
              const pole = view.line(arc({ theta: 0, phi: 40 }, { theta, phi: 40 }));
              return (
                <>
                  <path class="thin" d={pole.front} />
                  <Segment view={view} to={[0, 0, 1]} look="axis" />
                  <g class="ls-0">
                    <path class="patch strong-patch" d={view.shape(outline)} />
                    <path class="back" d={path.back} />
                    <path class="curve" d={path.front} />
                    {[outline[0]!, outline[12]!, outline[26]!, outline[38]!].map((to, i) => (
                      <Segment key={i} view={view} to={to} look="thin" />
                    ))}
                  </g>
                </>
              );
            }}
          </Globe>
        )}
      </Drawing>
    </Figure>
  );
}
