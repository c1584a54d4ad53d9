/** A ball under one distant light, seen from afar: every direction of the surface at once. */
import { computed, signal } from "@preact/signals";
import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { fromDisc, nudged, onDisc } from "../plot/directions";
import { grid, type Size } from "../plot/grid";
import { continueRim } from "../plot/rim";
import { beside, csvText, pngOfCanvas, type Row } from "../plot/save";
import { picture } from "../plot/tone";
import { exposure, factors, type Shown, type ToneMap, toneMap, wi } from "../state";
import { FactorSwitches } from "./factors";
import { Complaints, Frame } from "./frame";
import { Handle, setWi } from "./handle";
import { type Answer, Live, seen, settled } from "./live";
import { paced } from "./pace";
import { Pictures } from "./pictures";
import { complaintsOf } from "./reading";
import { colour } from "./theme";
import { useDrawn } from "./timings";

/** Pixels along a side while something moves, and at most. */
const COARSE = 112;
const FINEST = 420;

/** Pixels of the screen that a ball has. */
const side = signal(200);

const balls = new Live("ball", () =>
  seen.ball.value
    ? paced.functions.value.map((f) => ({
        key: String(f.id),
        shown: f,
        request: { function: f.text, light: paced.wi.value, size: settled.value ? side.value : Math.min(side.value, COARSE), factors: factors.value },
        fine: settled.value,
      }))
    : null,
);

const since = computed(() => Math.max(0, ...[...balls.answers.value.values()].map((a) => a.since)));

export function Ball(): JSX.Element {
  const body = useRef<HTMLDivElement>(null);
  return (
    <Frame
      view="ball"
      title="Lit ball"
      about="A ball under one distant light, seen from afar. A white diffuse surface that faces the light appears as 1. Drag the light over the ball; L, f and cos θ switch the factors of the reflection equation."
      controls={<FactorSwitches />}
      saves={{
        png: () => {
          const canvases = [...(body.current?.querySelectorAll("canvas") ?? [])];
          return canvases.length > 0 ? pngOfCanvas(beside(canvases, colour("--surface"))) : null;
        },
        csv: table,
      }}
    >
      {(size) => (
        <div ref={body}>
          <Balls size={size} />
          <Complaints of={complaintsOf(balls, paced.functions.value)} />
        </div>
      )}
    </Frame>
  );
}

function Balls({ size }: { size: Size }): JSX.Element {
  useDrawn("ball", since.value);
  const { cell } = grid(paced.functions.value.length, size, 1);
  useLayoutEffect(() => {
    side.value = Math.max(16, Math.min(FINEST, Math.round(cell.width * devicePixelRatio)));
  }, [cell.width]);
  const pictures = paced.functions.value.flatMap((f) => {
    const answer = balls.answers.value.get(String(f.id));
    return answer === undefined ? [] : [painted(f, answer)];
  });
  return (
    <Pictures
      size={size}
      aspect={1}
      round
      pictures={pictures}
      over={(place) => {
        const half = place.width / 2;
        const [x, y] = onDisc("orthographic", wi.value);
        return (
          <svg class="over" viewBox={`0 0 ${place.width} ${place.height}`} width={place.width} height={place.height}>
            <Handle
              which="light"
              x={half + half * x}
              y={half - half * y}
              angles={wi.value}
              moved={(px, py) => setWi(fromDisc("orthographic", px / half - 1, 1 - py / half, wi.value.phi))}
              keyed={(key, by) => {
                const next = nudged(wi.value, key, by);
                if (next !== null) setWi(next);
                return next !== null;
              }}
            />
          </svg>
        );
      }}
    />
  );
}

function paintBall(out: Uint8ClampedArray, { arrays, request }: Answer<"ball">, factor: number, curve: ToneMap): void {
  picture(out, arrays["values"]!, factor, curve);
  continueRim(out, request.size);
}

/** The last painter of each answer: a picture is painted anew only where it changed. */
const painters = new WeakMap<Answer<"ball">, { key: string; paint: (out: Uint8ClampedArray) => void }>();

function painted(shown: Shown, answer: Answer<"ball">): { shown: Shown; width: number; height: number; paint: (out: Uint8ClampedArray) => void; words: string } {
  const key = `${exposure.value} ${toneMap.value}`;
  let painter = painters.get(answer);
  if (painter?.key !== key) {
    const [factor, curve] = [2 ** exposure.value, toneMap.value];
    painter = { key, paint: (out) => paintBall(out, answer, factor, curve) };
    painters.set(answer, painter);
  }
  const { size } = answer.request;
  return { shown, width: size, height: size, paint: painter.paint, words: `A ball of ${shown.text}, lit from ${paced.wi.value.theta}° off the line of sight` };
}

function table(): string | null {
  const rows: Row[] = [];
  paced.functions.value.forEach((f) => {
    const answer = balls.answers.value.get(String(f.id));
    if (answer === undefined) return;
    const values = answer.arrays["values"]!;
    const n = answer.request.size;
    for (let k = 0; k < n * n; k += 1) if (!Number.isNaN(values[3 * k]!)) rows.push([f.text, k % n, Math.floor(k / n), ...values.subarray(3 * k, 3 * k + 3)]);
  });
  return rows.length > 0 ? csvText(["function", "column", "row", "red", "green", "blue"], rows) : null;
}
