/** The bar above the views: the directions, how values and pictures are shown, and f for the pair of directions. */
import type { ComponentChildren, JSX } from "preact";
import type { Angles } from "../engine/protocol";
import { incident, mirrored, wrap } from "../plot/directions";
import { aligned } from "../plot/scale";
import { type Channel, channel, cosine, exposure, type Scale, scale, type ToneMap, toneMap, visible, wi, wo } from "../state";
import { label } from "./label";
import { Live } from "./live";
import { complaintsOf } from "./reading";
import "./controls.css";

const values = new Live("evaluate", () => {
  const direction = wo.value;
  return direction === null ? [] : visible.value.map((f) => ({ key: String(f.id), shown: f, request: { function: f.text, wi: wi.value, wo: direction } }));
});

const SCALES: Record<Scale, string> = { linear: "Linear", "cube-root": "Cube root", log: "Log" };
const CHANNELS: Record<Channel, string> = { luminance: "Luminance", red: "Red", green: "Green", blue: "Blue", rgb: "RGB" };
const TONES: Record<ToneMap, string> = { "pbr-neutral": "Neutral", srgb: "sRGB", aces: "ACES" };

export function Controls(): JSX.Element {
  return (
    <div class="controls">
      <Group name="ωi" words="Direction of incidence, towards the light">
        <AngleField name="θi" words="Polar angle of incidence" low={0} high={89.5} value={wi.value.theta} set={(theta) => (wi.value = incident({ theta, phi: wi.value.phi }))} />
        <AngleField name="φi" words="Azimuth of incidence" low={-180} high={180} value={wi.value.phi} set={(phi) => (wi.value = incident({ theta: wi.value.theta, phi }))} />
      </Group>
      <Group name="ωo" words="Direction of view">
        {wo.value === null ? (
          <button type="button" class="control-button" onClick={() => (wo.value = mirrored(wi.value))}>
            Mirror’s direction
          </button>
        ) : (
          <Viewing angles={wo.value} />
        )}
      </Group>
      <Group words="How values are shown">
        <Select label="Scale" options={SCALES} value={scale.value} set={(value) => (scale.value = value)} />
        <Select label="Channel" options={CHANNELS} value={channel.value} set={(value) => (channel.value = value)} />
        <label class="control-check" title="Shows f times the cosine of the angle of reflection">
          <input type="checkbox" checked={cosine.value} onChange={(event) => (cosine.value = event.currentTarget.checked)} />
          × cos θr
        </label>
      </Group>
      <Group words="How pictures are shown">
        <label class="control-range" title="Exposure, in stops">
          <span>{`${exposure.value > 0 ? "+" : exposure.value < 0 ? "−" : ""}${Math.abs(exposure.value).toFixed(1)} EV`}</span>
          <input type="range" aria-label="Exposure, stops" min={-8} max={8} step={0.1} value={exposure.value} onInput={(event) => (exposure.value = event.currentTarget.valueAsNumber)} onDblClick={() => (exposure.value = 0)} />
        </label>
        <Select label="Tone curve" options={TONES} value={toneMap.value} set={(value) => (toneMap.value = value)} />
      </Group>
      <Readout />
    </div>
  );
}

function Group({ name, words, children }: { name?: string; words: string; children: ComponentChildren }): JSX.Element {
  return (
    <div class="control-group" role="group" aria-label={words}>
      {name !== undefined && (
        <span class="control-name" title={words} aria-hidden="true">
          {name}
        </span>
      )}
      {children}
    </div>
  );
}

function Viewing({ angles }: { angles: Angles }): JSX.Element {
  return (
    <>
      <AngleField name="θo" words="Polar angle of view" low={0} high={180} value={angles.theta} set={(theta) => (wo.value = { theta, phi: angles.phi })} />
      <AngleField name="φo" words="Azimuth of view" low={-180} high={180} value={angles.phi} set={(phi) => (wo.value = { theta: angles.theta, phi: wrap(phi) })} />
      <button type="button" class="control-button plain" aria-label="Look at no direction" title="Look at no direction" onClick={() => (wo.value = null)}>
        ×
      </button>
    </>
  );
}

interface AngleProps {
  name: string;
  words: string;
  low: number;
  high: number;
  value: number;
  set: (value: number) => void;
}

function AngleField({ name, words, low, high, value, set }: AngleProps): JSX.Element {
  return (
    <label class="control-field" title={`${words}, degrees`}>
      <span aria-hidden="true">{name}</span>
      <input
        type="number"
        aria-label={`${words}, degrees`}
        min={low}
        max={high}
        step={1}
        value={value}
        onInput={(event) => {
          const next = event.currentTarget.valueAsNumber;
          if (Number.isFinite(next) && next >= low && next <= high) set(next);
        }}
        // What can't be set is not kept in the field either.
        onBlur={(event) => (event.currentTarget.value = String(value))}
      />
      <span aria-hidden="true">°</span>
    </label>
  );
}

function Select<T extends string>({ label, options, value, set }: { label: string; options: Record<T, string>; value: T; set: (value: T) => void }): JSX.Element {
  return (
    <select class="control-select" aria-label={label} title={label} value={value} onChange={(event) => set(event.currentTarget.value as T)}>
      {(Object.entries(options) as [T, string][]).map(([key, text]) => (
        <option key={key} value={key}>
          {text}
        </option>
      ))}
    </select>
  );
}

/** f, f cosθi and the density for the pair of directions: all digits are in the elements' values. */
function Readout(): JSX.Element | null {
  if (wo.value === null) return null;
  return (
    <div class="readout" tabindex={0} role="region" aria-label="Values for the directions of incidence and of view">
      <table>
        <caption class="hidden">Values for the directions of incidence and of view</caption>
        <thead>
          <tr>
            <th scope="col">sr⁻¹</th>
            <th scope="col">f red</th>
            <th scope="col">green</th>
            <th scope="col">blue</th>
            <th scope="col">f cos θi red</th>
            <th scope="col">green</th>
            <th scope="col">blue</th>
            <th scope="col">pdf</th>
          </tr>
        </thead>
        <tbody>
          {visible.value.map((f) => {
            const answer = values.answers.value.get(String(f.id))?.answer;
            const complaint = complaintsOf(values).find((c) => c.colour === f.colour);
            return (
              <tr key={f.id} data-function={f.text}>
                <th scope="row" class={`series-${f.colour}`}>
                  <span class="view-dot" /> <span class="readout-name" title={f.text}>{label(f)}</span>
                </th>
                {answer !== undefined && (
                  <>
                    {answer.f_per_sr.map((x, k) => (
                      <td key={`f${k}`}>
                        <Figure of="f_per_sr" value={x} />
                      </td>
                    ))}
                    {answer.f_cos_per_sr.map((x, k) => (
                      <td key={`c${k}`}>
                        <Figure of="f_cos_per_sr" value={x} />
                      </td>
                    ))}
                    <td>
                      <Figure of="pdf_per_sr" value={answer.pdf_per_sr} />
                    </td>
                  </>
                )}
                {complaint !== undefined && (
                  <td colSpan={7} class="readout-complaint">
                    {complaint.message}
                  </td>
                )}
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}

const Figure = ({ of, value }: { of: string; value: number }): JSX.Element => (
  <data value={String(value)} data-of={of}>
    {aligned(value)}
  </data>
);
