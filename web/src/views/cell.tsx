/** The cell of a slice that the present pair of directions is in: shown, moved with the keys, and read aloud. */
import type { JSX } from "preact";
import { clamp, fromHalfDifference, halfDifference, mirrored, STEEPEST } from "../plot/directions";
import { degrees } from "../plot/scale";
import { phiD, wi, wo } from "../state";
import { setWi, setWo } from "./handle";

/** The angle of a slice's last node, degrees. */
export const LAST = 89.9;

/** The pair as a place of the slice that is shown; null where it lies in another slice. */
function chosen(): { thetaH: number; thetaD: number } | null {
  if (wo.value === null) return null;
  const { thetaH, thetaD, phiD: phi } = halfDifference(wi.value, wo.value);
  return thetaH < 0.1 || thetaD < 0.1 || apart(phi, phiD.value) < 1 ? { thetaH, thetaD } : null;
}

/** How far two φd are apart: they are the same after half a turn. */
function apart(a: number, b: number): number {
  const d = (((a - b) % 180) + 180) % 180;
  return Math.min(d, 180 - d);
}

/** Takes every view to these half and difference angles; false where one of the directions would be below the horizon. */
export function goTo(thetaH: number, thetaD: number): boolean {
  const before = wo.value === null ? null : halfDifference(wi.value, wo.value);
  // The half vector stays where it is turned to, so that a step of the cell is a small step of both directions. At θh = 0 it has no azimuth.
  const azimuth = before !== null && before.thetaH > 0.3 && chosen() !== null ? before.phiH : wi.value.phi - phiD.value;
  const pair = fromHalfDifference(thetaH, thetaD, phiD.value, azimuth);
  if (pair === null || pair.wi.theta > STEEPEST) return false;
  setWi(pair.wi);
  setWo(pair.wo);
  return true;
}

/** Where keys lead: steps to the right and upwards, in nodes. */
const STEPS: Record<string, [number, number]> = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1], Home: [-Infinity, 0], End: [Infinity, 0] };
/** Nodes of a large step, with Shift: 10°. */
const LARGE = 20;

export interface CellProps {
  /** Pixels along the picture's side. */
  size: number;
  /** Nodes along it. */
  nodes: number;
  /** Of what it is. */
  name: string;
  /** The value at a node, in words. */
  read(index: number): string;
}

export function Cell({ size, nodes, name, read }: CellProps): JSX.Element {
  const here = chosen();
  // Without a direction of view the keys begin at the mirror's, where most functions are largest.
  const from = here ?? halfDifference(wi.value, mirrored(wi.value));
  const node = (angle: number): number => clamp(Math.round((angle / LAST) * (nodes - 1)), 0, nodes - 1);
  const [column, row] = [node(from.thetaH), node(from.thetaD)];
  const at = (angle: number): number => (clamp(angle, 0, LAST) / LAST) * size;
  const move = (key: string, large: boolean): boolean => {
    const step = STEPS[key];
    if (step === undefined) return false;
    const [right, up] = step.map((s) => clamp(s * (large ? LARGE : 1), -nodes, nodes)) as [number, number];
    // As far towards it as both directions are above the horizon.
    for (let k = Math.max(Math.abs(right), Math.abs(up)); k > 0; k -= 1) {
      const [c, r] = [column + Math.sign(right) * Math.min(k, Math.abs(right)), row + Math.sign(up) * Math.min(k, Math.abs(up))];
      if (c < 0 || c >= nodes || r < 0 || r >= nodes) continue;
      if (goTo((c * LAST) / (nodes - 1), (r * LAST) / (nodes - 1))) break;
    }
    return true;
  };
  return (
    <g
      class={here === null ? "cell cell-unset" : "cell"}
      transform={`translate(${at(from.thetaH).toFixed(1)} ${(size - at(from.thetaD)).toFixed(1)})`}
      tabindex={0}
      role="slider"
      aria-label={`Cell of the ${name}`}
      aria-valuemin={0}
      aria-valuemax={90}
      aria-valuenow={Math.round(from.thetaH * 10) / 10}
      aria-valuetext={`θh ${degrees(from.thetaH)}, θd ${degrees(from.thetaD)}: ${read((nodes - 1 - row) * nodes + column)}`}
      onKeyDown={(event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (move(event.key, event.shiftKey)) event.preventDefault();
      }}
    >
      <circle class="cell-halo" r={10} />
      <circle class="cell-ring" r={10} />
      <circle class="cell-edge" r={5} />
      <circle class="cell-mark" r={5} />
    </g>
  );
}
