/** A picture by the renderer: an object under a point light or a panorama, path traced in workers. */
import { effect, signal } from "@preact/signals";
import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { held } from "../files";
import { fromDisc, nudged, onDisc, wrap } from "../plot/directions";
import { grid, type Size } from "../plot/grid";
import { beside, pngOfCanvas } from "../plot/save";
import { picture } from "../plot/tone";
import { exposure, factors, large, light, object, toneMap, turn, wi } from "../state";
import { FactorSwitches } from "./factors";
import { Complaints, Frame } from "./frame";
import { follow, Handle, setWi } from "./handle";
import { seen, settled } from "./live";
import { paced } from "./pace";
import { type Picture, Pictures } from "./pictures";
import { type Film, Progress } from "./progress";
import { colour } from "./theme";
import { begun, pressed, useDrawn } from "./timings";

interface Choice {
  value: string;
  name: string;
  /** Stops beside the exposure that is set: daylight in its true units is far brighter than what else there is. */
  stops: number;
}

const LIGHTS: Choice[] = [
  { value: "files/sunset.hdr", name: "Sunset", stops: 0 },
  { value: "sky:elevation=30", name: "Clear sky", stops: -5 },
  { value: "uniform:1", name: "Furnace", stops: 0 },
  { value: "point", name: "Point light", stops: 0 },
];

const own = (): number => LIGHTS.find((l) => l.value === light.value)?.stops ?? 0;
const stops = (): number => exposure.value + own();

const ASPECT = { ball: 1, preview: 1.5 } as const;
/** Pixels of a picture at most: a sample of each takes some microseconds. */
const MOST_PIXELS = 260_000;
/** Samples of a pixel: until the eye sees no more noise in a small picture, and in a large one. */
const SAMPLES = { tile: 64, large: 512 };
const BOUNCES = 8;

const progress = new Progress();
const pixels = signal<Size>({ width: 0, height: 0 });

effect(() => {
  // On a slow machine pictures wait until nothing moves.
  if (!begun.value || !seen.preview.value || pixels.value.width === 0 || (!settled.value && pressed())) {
    progress.rest();
    return;
  }
  const point = light.value === "point";
  const motifs = paced.functions.value.map((f) => ({
    key: `preview-${f.id}`,
    version: String(f.revision),
    changed: f.changed,
    motif: {
      function: f.text,
      object: object.value,
      light: light.value,
      direction: point ? paced.wi.value : { theta: 0, phi: 0 },
      turn: point ? 0 : turn.value,
      bounces: BOUNCES,
      factors: factors.value,
    },
  }));
  progress.follow(motifs, pixels.value, large.value === "preview" ? SAMPLES.large : SAMPLES.tile, settled.value);
});

export function Preview(): JSX.Element {
  const body = useRef<HTMLDivElement>(null);
  const brought = held.value.filter((file) => file.kind === "panorama");
  return (
    <Frame
      view="preview"
      title="Preview"
      about="An object, path traced by the renderer: the more samples, the less noise. Drag to turn the panorama, or the point light, which is the direction of incidence. L, f and cos θ switch the factors of the reflection equation."
      many
      controls={
        <>
          <select class="view-select" aria-label="Object of the preview" value={object.value} onChange={(event) => (object.value = event.currentTarget.value as typeof object.value)}>
            <option value="preview">Object</option>
            <option value="ball">Ball</option>
          </select>
          <select class="view-select" aria-label="Light of the preview" value={light.value} onChange={(event) => (light.value = event.currentTarget.value)}>
            {LIGHTS.map(({ value, name }) => (
              <option key={value} value={value}>
                {name}
              </option>
            ))}
            {brought.map((file) => (
              <option key={file.name} value={`files/${file.name}`}>
                {file.name}
              </option>
            ))}
          </select>
          <FactorSwitches />
        </>
      }
      saves={{
        png: () => {
          const canvases = [...(body.current?.querySelectorAll("canvas") ?? [])];
          return canvases.length > 0 ? pngOfCanvas(beside(canvases, colour("--surface"))) : null;
        },
      }}
    >
      {(size) => (
        <div ref={body}>
          <Rendered size={size} />
          <Complaints of={complaints()} />
        </div>
      )}
    </Frame>
  );
}

function complaints(): { colour: number; message: string; help: string | null }[] {
  return paced.functions.value.flatMap((f) => {
    const complaint = progress.complaints.value.get(`preview-${f.id}`);
    return complaint === undefined ? [] : [{ colour: f.colour, message: complaint.message, help: complaint.help }];
  });
}

function Rendered({ size }: { size: Size }): JSX.Element {
  const films = progress.films.value;
  useDrawn("preview", Math.max(0, ...[...films.values()].map((f) => f.since)));
  const aspect = ASPECT[object.value];
  const room = { width: size.width, height: size.height - 18 };
  const { cell } = grid(paced.functions.value.length, room, aspect);
  useLayoutEffect(() => {
    const density = Math.min(devicePixelRatio, Math.sqrt(MOST_PIXELS / Math.max(1, cell.width * cell.height)));
    const next = { width: Math.round(cell.width * density), height: Math.round(cell.height * density) };
    if (next.width > 8 && (next.width !== pixels.value.width || next.height !== pixels.value.height)) pixels.value = next;
  });
  const pictures = paced.functions.value.flatMap((f): Picture[] => {
    const film = films.get(`preview-${f.id}`);
    if (film === undefined) return [];
    return [{ shown: f, width: film.width, height: film.height, paint: painted(film), words: `${f.text}, rendered with ${film.samples} samples a pixel` }];
  });
  const all = [...films.values()];
  const least = Math.min(...all.map((f) => f.samples));
  const rejected = all.reduce((sum, f) => sum + f.rejected, 0);
  return (
    <>
      <div class="pictures-room" style={{ bottom: "18px" }}>
        <Pictures size={room} aspect={aspect} pictures={pictures} over={(place) => (light.value === "point" ? <Point place={place} /> : <Turn place={place} />)} />
      </div>
      {all.length > 0 && (
        <p class="view-note" data-samples={least}>
          {least} {least === 1 ? "sample" : "samples"} a pixel
          {own() !== 0 && `; ${own() < 0 ? "−" : "+"}${Math.abs(own())} EV for this light`}
          {rejected > 0 && `; ${rejected} samples were not finite and are left out`}
        </p>
      )}
    </>
  );
}

const painters = new WeakMap<Film, { key: string; paint: (out: Uint8ClampedArray) => void }>();

function painted(film: Film): (out: Uint8ClampedArray) => void {
  const key = `${stops()} ${toneMap.value}`;
  const before = painters.get(film);
  if (before?.key === key) return before.paint;
  const [factor, curve] = [2 ** stops() / film.samples, toneMap.value];
  const paint = (out: Uint8ClampedArray): void => picture(out, film.sums, factor, curve);
  painters.set(film, { key, paint });
  return paint;
}

/** The light is dragged as over a ball in the middle of the picture. */
function Point({ place: { width, height } }: { place: Size }): JSX.Element {
  const half = Math.min(width, height) / 2;
  const [x, y] = onDisc("orthographic", wi.value);
  return (
    <svg class="over" viewBox={`0 0 ${width} ${height}`} width={width} height={height}>
      <Handle
        which="light"
        x={width / 2 + half * x}
        y={height / 2 - half * y}
        angles={wi.value}
        moved={(px, py) => setWi(fromDisc("orthographic", (px - width / 2) / half, (height / 2 - py) / half, wi.value.phi))}
        keyed={(key, by) => {
          const next = nudged(wi.value, key, by);
          if (next !== null) setWi(next);
          return next !== null;
        }}
      />
    </svg>
  );
}

/** A picture's width is half a turn of the panorama. */
function Turn({ place: { width, height } }: { place: Size }): JSX.Element {
  const set = (degrees: number): void => {
    turn.value = Math.round(wrap(degrees) * 10) / 10;
  };
  return (
    <div
      class="over turn"
      tabIndex={0}
      role="slider"
      aria-label="Turn of the panorama, degrees"
      aria-valuemin={-180}
      aria-valuemax={180}
      aria-valuenow={turn.value}
      style={{ width: `${width}px`, height: `${height}px` }}
      onPointerDown={(event) => {
        let last: number | null = null;
        follow(event, event.currentTarget, (x) => {
          // The background goes with the pointer: a positive turn takes it to the left.
          if (last !== null) set(turn.value - ((x - last) / width) * 180);
          last = x;
        });
      }}
      onKeyDown={(event) => {
        const step = { ArrowLeft: 1, ArrowDown: 1, ArrowRight: -1, ArrowUp: -1 }[event.key];
        if (step === undefined || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        set(turn.value + step * (event.shiftKey ? 30 : 5));
      }}
    />
  );
}
