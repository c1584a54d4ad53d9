/** The lobe in space: f for one direction of incidence, as a surface that is turned by dragging. */
import { computed, effect } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Angles } from "../engine/protocol";
import { channelOf } from "../plot/colours";
import { nudged, STEEPEST, toVector } from "../plot/directions";
import type { Size } from "../plot/grid";
import { beside, csvText, pngOfCanvas, type Row } from "../plot/save";
import { type Axis, axis, degrees, number, type Tick } from "../plot/scale";
import { channel, cosine, scale, type Shown, wi, wo } from "../state";
import { Complaints, Frame } from "./frame";
import { follow, setWi, setWo } from "./handle";
import { Live, seen, settled } from "./live";
import { gestures } from "./lobe-gestures";
import type { Colours, LobeScene, Part } from "./lobe-scene";
import { paced } from "./pace";
import { complaintsOf } from "./reading";
import { colour, theme } from "./theme";
import { begun, drawn, stir } from "./timings";
import "./lobe.css";

const lobes = new Live("lobe", () =>
  seen.lobe.value
    ? paced.functions.value.map((f) => ({
        key: String(f.id),
        shown: f,
        request: { function: f.text, wi: paced.wi.value, scale: scale.value, cosine: cosine.value, quick: !settled.value },
        fine: settled.value,
      }))
    : null,
);

/** Whose lobes there are, in which colours: surfaces are made anew for nothing else of the functions. */
const cast = computed<Shown[]>((): Shown[] => {
  const now = paced.functions.value;
  const same = now.length === lastCast.length && now.every((f, k) => f.id === lastCast[k]!.id && f.colour === lastCast[k]!.colour);
  return same ? lastCast : (lastCast = now);
});
let lastCast: Shown[] = [];

/** The axis of the radius: logarithmic ones begin where nearly all of the values are above. */
const radial = computed<Axis>(() => {
  let most = 0;
  const positive: number[] = [];
  for (const { arrays } of lobes.answers.value.values()) {
    const values = arrays["values"]!;
    for (let k = 0; k + 2 < values.length; k += 3) {
      const value = channelOf(channel.value, values, k);
      if (!(value > 0) || value === Infinity) continue;
      most = Math.max(most, value);
      if (scale.value === "log") positive.push(value);
    }
  }
  positive.sort((a, b) => a - b);
  return axis(scale.value, positive[Math.floor(0.02 * positive.length)] ?? 0, most);
});

const colours = (): Colours => ({
  line: colour("--line"),
  strong: colour("--line-strong"),
  ink: colour("--ink"),
  light: colour("--light"),
});

function table(): string | null {
  const rows: Row[] = [];
  paced.functions.value.forEach((f) => {
    const { directions, values } = lobes.answers.value.get(String(f.id))?.arrays ?? {};
    for (let k = 0; k + 2 < (directions?.length ?? 0); k += 3) rows.push([f.text, ...directions!.subarray(k, k + 3), ...values!.subarray(k, k + 3)]);
  });
  return rows.length > 0 ? csvText(["function", "x", "y", "z", "red", "green", "blue"], rows) : null;
}

export function Lobe(): JSX.Element {
  const scene = useRef<LobeScene | null>(null);
  return (
    <Frame
      view="lobe"
      title="Lobe"
      about="f over all directions, for light that comes along the arrow: the distance from the centre is the value. Drag the light; drag elsewhere to turn the view, and pinch, or press + and −, to scale it. Lines on the lobe are at the values of the rings."
      saves={{
        png: () => {
          if (scene.current === null) return null;
          // What was drawn is kept for the screen only: draw, and read in the same task.
          scene.current.render();
          return pngOfCanvas(beside([scene.current.canvas], colour("--surface")));
        },
        csv: table,
      }}
    >
      {(size) => <Space size={size} scene={scene} />}
    </Frame>
  );
}

function Space({ size, scene }: { size: Size; scene: { current: LobeScene | null } }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const overlay = useRef<HTMLDivElement>(null);
  const [there, setThere] = useState(false);
  const [problem, setProblem] = useState<string | null>(null);

  useEffect(() => {
    let gone = false;
    // A frame may be done between the moment when the page no longer has these and the end of this effect.
    const [surface, names] = [canvas.current!, overlay.current!];
    const stops: (() => void)[] = [];
    const first = new Promise<void>((resolve) => stops.push(effect(() => (begun.value ? resolve() : undefined))));
    first
      .then(() => import("./lobe-scene"))
      .then(({ LobeScene, REACH }) => {
        if (gone) return;
        let newest = 0;
        const made = new LobeScene(surface, () => {
          // Until there is something to show the page need not wait for the graphics card.
          surface.hidden = false;
          place(made, names, REACH);
          if (newest > 0) drawn("lobe", newest);
          newest = 0;
          stir();
        });
        scene.current = made;
        stops.push(
          effect(() => {
            theme.value;
            made.setStage(radial.value, colours());
          }),
          effect(() => made.setShown(seen.lobe.value)),
          effect(() => {
            theme.value;
            made.setLight(wi.value, colours());
            place(made, names, REACH);
          }),
          effect(() => {
            theme.value;
            made.setViewer(wo.value, colours());
          }),
          effect(() => {
            theme.value;
            const parts = cast.value.flatMap((f): Part[] => {
              const answer = lobes.answers.value.get(String(f.id));
              if (answer === undefined) return [];
              newest = Math.max(newest, answer.since);
              const { directions, values, triangles, spikes } = answer.arrays;
              return [{ colour: colour(`--series-${f.colour}`), directions: directions!, values: values!, triangles: triangles!, spikes: spikes ?? new Float32Array() }];
            });
            made.setLobes(parts, radial.value, channel.value);
          }),
        );
        setThere(true);
      })
      .catch((error: unknown) => setProblem(`The lobe can't be drawn: ${error instanceof Error ? error.message : String(error)}. It needs WebGL 2; the other views don't.`));
    return () => {
      gone = true;
      for (const stop of stops) stop();
      scene.current?.dispose();
      scene.current = null;
    };
  }, []);

  useEffect(() => gestures(overlay.current!, () => scene.current), []);
  useEffect(() => scene.current?.resize(size.width, size.height), [there, size.width, size.height]);

  return (
    <>
      <canvas ref={canvas} class="lobe-canvas" hidden />
      <div ref={overlay} class={there ? "lobe-overlay" : "lobe-overlay empty"} tabIndex={0} role="group" aria-label="Lobe in space: arrow keys turn it, plus and minus scale it" onKeyDown={(e) => turnByKey(e, scene.current)} onWheel={(e) => zoomByWheel(e, scene.current)}>
        <Labels />
        <Knob which="light" scene={scene} />
        <Knob which="viewer" scene={scene} />
      </div>
      <p class="view-note">
        {cosine.value ? "f cos θr" : "f"} in sr⁻¹{scale.value !== "linear" && `, ${scale.value === "log" ? "logarithmic" : "cube root"}`}
      </p>
      {problem !== null && (
        <p class="view-complaint" role="alert">
          {problem}
        </p>
      )}
      <Complaints of={complaintsOf(lobes, paced.functions.value)} />
    </>
  );
}

/** The names of axes, values and spikes; `place` puts them where they belong. */
function Labels(): JSX.Element {
  const spikes = paced.functions.value.flatMap((f) => {
    const { spikes } = lobes.answers.value.get(String(f.id))?.arrays ?? {};
    return Array.from({ length: Math.floor((spikes?.length ?? 0) / 6) }, (_, k) => ({ look: `series-${f.colour}`, at: [...spikes!.subarray(6 * k, 6 * k + 3)], share: channelOf(channel.value, spikes!, 6 * k + 3) }));
  });
  return (
    <>
      <span class="lobe-label" data-at="0 0 1.33">
        n
      </span>
      {[0, 90, 180, 270].map((phi) => (
        <span key={phi} class="lobe-label faint" data-at={`${1.11 * Math.cos((phi * Math.PI) / 180)} ${1.11 * Math.sin((phi * Math.PI) / 180)} 0`}>
          {phi}°
        </span>
      ))}
      {apart(radial.value.ticks).map((t) => (
        <span key={t.value} class="lobe-label faint" data-ring={t.position}>
          {t.label}
        </span>
      ))}
      {spikes.map(({ look, at, share }) => (
        <span key={`${look} ${at.join()}`} class={`lobe-label ${look}`} data-at={at.map((x) => 1.07 * x).join(" ")}>
          {number(share)}
        </span>
      ))}
    </>
  );
}

/** The labelled ticks that don't touch, from the rim inwards. */
function apart(ticks: Tick[]): Tick[] {
  const kept: Tick[] = [];
  for (const tick of [...ticks].reverse()) if (tick.label !== "" && tick.position > 0.15 && (kept.length === 0 || kept.at(-1)!.position - tick.position > 0.13)) kept.push(tick);
  return kept;
}

/** Puts the labels and handles where the frame that was drawn has their points. */
function place(scene: LobeScene, overlay: HTMLElement, reach: number): void {
  const put = (element: HTMLElement, v: readonly number[]): void => {
    const { x, y, near } = scene.project(v[0]!, v[1]!, v[2]!);
    element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    element.classList.toggle("behind", !near);
  };
  for (const element of overlay.children as Iterable<Element> as Iterable<HTMLElement>) {
    const { at, ring, which } = element.dataset;
    if (at !== undefined) put(element, at.split(" ").map(Number));
    else if (ring !== undefined) {
      // Midway between two named spokes, about across the plane of incidence, on the side of the camera.
      const phi = ((90 * Math.round((wi.value.phi + 60) / 90) + 45) * Math.PI) / 180;
      const r = (Math.cos(scene.azimuth - phi) >= 0 ? 1 : -1) * Number(ring);
      put(element, [r * Math.cos(phi), r * Math.sin(phi), 0]);
    } else if (which !== undefined) {
      const angles = which === "light" ? wi.value : wo.value;
      if (angles !== null)
        put(
          element,
          toVector(angles).map((x) => reach * x),
        );
    }
  }
}

function Knob({ which, scene }: { which: "light" | "viewer"; scene: { current: LobeScene | null } }): JSX.Element | null {
  const angles = which === "light" ? wi.value : wo.value;
  if (angles === null) return null;
  const set = (next: Angles): void => (which === "light" ? setWi(next) : setWo(next));
  return (
    <div
      class={`lobe-knob ${which}`}
      data-which={which}
      tabIndex={0}
      role="slider"
      aria-label={which === "light" ? "Direction of incidence" : "Direction of view"}
      aria-valuemin={0}
      aria-valuemax={which === "light" ? 89.5 : 180}
      aria-valuenow={angles.theta}
      aria-valuetext={`θ ${degrees(angles.theta)}, φ ${degrees(angles.phi)}`}
      onPointerDown={(event) => {
        const box = event.currentTarget.parentElement!;
        follow(event, box, (x, y) => scene.current && set(scene.current.direction(x, y, (which === "light" ? wi.value : wo.value)!)));
      }}
      onKeyDown={(event) => {
        const next = event.ctrlKey || event.metaKey ? null : nudged(angles, event.key, { shift: event.shiftKey, alt: event.altKey }, which === "light" ? STEEPEST : 180);
        if (next === null) return;
        event.preventDefault();
        event.stopPropagation();
        set(next);
      }}
    >
      <span>{which === "light" ? "ωi" : "ωo"}</span>
    </div>
  );
}

function turnByKey(event: KeyboardEvent & { currentTarget: HTMLElement }, scene: LobeScene | null): void {
  if (scene === null || event.target !== event.currentTarget || event.ctrlKey || event.metaKey) return;
  const moves: Record<string, () => void> = {
    ArrowLeft: () => scene.turn(-0.1, 0),
    ArrowRight: () => scene.turn(0.1, 0),
    ArrowUp: () => scene.turn(0, 0.1),
    ArrowDown: () => scene.turn(0, -0.1),
    "+": () => scene.scale(1.15),
    "=": () => scene.scale(1.15),
    "-": () => scene.scale(1 / 1.15),
  };
  if (moves[event.key] === undefined) return;
  event.preventDefault();
  moves[event.key]!();
}

/** Only when the view has the focus, or by pinching: else the page must be able to scroll. */
function zoomByWheel(event: WheelEvent & { currentTarget: HTMLElement }, scene: LobeScene | null): void {
  if (scene === null || !(event.ctrlKey || event.currentTarget.contains(document.activeElement))) return;
  event.preventDefault();
  scene.scale(Math.exp(-0.0015 * event.deltaY));
}
