/**
 * Directions of the local frame (normal +z), and where views show them: in the plane of incidence, on discs and on slices.
 *
 * Only geometry of drawing and dragging is here; what a direction reflects is the library's.
 */
import type { Angles } from "../engine/protocol";

export type Vector = readonly [number, number, number];

const DEGREE = Math.PI / 180;

/** The steepest incidence that can be set: in the horizon itself no light arrives. */
export const STEEPEST = 89.5;

export const clamp = (x: number, low: number, high: number): number => Math.min(Math.max(x, low), high);

/** φ in (−180, 180]. */
export function wrap(phi: number): number {
  const turned = phi - 360 * Math.ceil((phi - 180) / 360);
  // −0 would be written as such in links.
  return turned === 0 ? 0 : turned;
}

export function toVector({ theta, phi }: Angles): Vector {
  const sin = Math.sin(theta * DEGREE);
  return [sin * Math.cos(phi * DEGREE), sin * Math.sin(phi * DEGREE), Math.cos(theta * DEGREE)];
}

/** `v` needs no unit length. Along the normal φ has no meaning, and is `phi`. */
export function toAngles(v: Vector, phi = 0): Angles {
  const across = Math.hypot(v[0], v[1]);
  return { theta: Math.atan2(across, v[2]) / DEGREE, phi: across < 1e-12 ? phi : wrap(Math.atan2(v[1], v[0]) / DEGREE) };
}

/** As a direction can be set: to a hundredth of a degree, one of incidence above the horizon. */
export function incident({ theta, phi }: Angles, steepest = STEEPEST): Angles {
  const round = (x: number): number => Math.round(x * 100) / 100;
  return { theta: clamp(round(theta), 0, steepest), phi: wrap(round(phi)) };
}

/** Where a mirror sends light from `wi`. */
export const mirrored = ({ theta, phi }: Angles): Angles => ({ theta, phi: wrap(phi + 180) });

/**
 * `w` seen in the plane of incidence of `wi`: its angle from the normal, positive on the side away from the light, in [−180, 180]; and how
 * far it leaves that plane, degrees.
 */
export function inPlane(wi: Angles, w: Angles): { angle: number; off: number } {
  const [x, y, z] = toVector(w);
  const cos = -Math.cos(wi.phi * DEGREE);
  const sin = -Math.sin(wi.phi * DEGREE);
  const along = x * cos + y * sin;
  const across = y * cos - x * sin;
  return { angle: Math.atan2(along, z) / DEGREE, off: Math.abs(Math.asin(clamp(across, -1, 1))) / DEGREE };
}

/** The direction at an angle in the plane of incidence, the inverse of `inPlane`. */
export function fromPlane(wi: Angles, angle: number): Angles {
  return { theta: Math.abs(angle), phi: wrap(angle >= 0 ? wi.phi + 180 : wi.phi) };
}

/** The angle in the plane of incidence at a place of a polar plot: `x` to the right and `y` down from its centre, in any unit. */
export const angleOnPolar = (x: number, y: number): number => Math.atan2(x, -y) / DEGREE;

/** The place of an angle on a polar plot, at `radius` from its centre; y down. */
export const onPolar = (angle: number, radius: number): [number, number] => [
  radius * Math.sin(angle * DEGREE),
  -radius * Math.cos(angle * DEGREE),
];

/** How a hemisphere is laid on a disc of radius 1: seen from afar, or with θ in proportion to the radius. */
export type Disc = "orthographic" | "equidistant";

/** The place of an upper direction on a disc; y up. */
export function onDisc(disc: Disc, { theta, phi }: Angles): [number, number] {
  const r = disc === "orthographic" ? Math.sin(theta * DEGREE) : theta / 90;
  return [r * Math.cos(phi * DEGREE), r * Math.sin(phi * DEGREE)];
}

/** The direction at a place of a disc, that of the rim for places outside; y up. At the centre φ is `phi`. */
export function fromDisc(disc: Disc, x: number, y: number, phi = 0): Angles {
  const r = Math.min(Math.hypot(x, y), 1);
  return {
    theta: disc === "orthographic" ? Math.asin(r) / DEGREE : 90 * r,
    phi: r < 1e-9 ? phi : wrap(Math.atan2(y, x) / DEGREE),
  };
}

/** Half and difference angles of a pair, degrees (Rusinkiewicz 1998); φd is folded into [0, 180], as reciprocity allows. */
export function halfDifference(wi: Angles, wo: Angles): { thetaH: number; thetaD: number; phiD: number; phiH: number } {
  const a = toVector(wi);
  const b = toVector(wo);
  const sum: Vector = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const { theta: thetaH, phi: phiH } = toAngles(sum, wi.phi);
  const thetaD = Math.acos(clamp(Math.hypot(...sum) / 2, 0, 1)) / DEGREE;
  // wi seen from the half vector's own frame: turned back about z, then about y.
  const [c, s] = [Math.cos(phiH * DEGREE), Math.sin(phiH * DEGREE)];
  const x = a[0] * c + a[1] * s;
  const y = a[1] * c - a[0] * s;
  const across = x * Math.cos(thetaH * DEGREE) - a[2] * Math.sin(thetaH * DEGREE);
  const phiD = Math.hypot(across, y) < 1e-12 ? 0 : (Math.atan2(y, across) / DEGREE + 360) % 180;
  return { thetaH, thetaD, phiD, phiH };
}

/** The pair of directions at half and difference angles; null where one of them lies below the horizon. */
export function fromHalfDifference(thetaH: number, thetaD: number, phiD: number, phiH: number): { wi: Angles; wo: Angles } | null {
  const h = toVector({ theta: thetaH, phi: 0 });
  const [dx, dy, dz] = toVector({ theta: thetaD, phi: phiD });
  const turn = (x: number, y: number): Angles => {
    const angles = toAngles([x * h[2] + dz * h[0], y, dz * h[2] - x * h[0]]);
    return { theta: angles.theta, phi: wrap(angles.phi + phiH) };
  };
  const pair = { wi: turn(dx, dy), wo: turn(-dx, -dy) };
  return pair.wi.theta < 90 && pair.wo.theta < 90 ? pair : null;
}

/**
 * A direction after a key: up and down change θ, left and right φ, by a degree, by 10 with Shift, by a tenth with Alt; Home is the normal, End
 * the steepest. Null for keys that mean nothing.
 */
export function nudged(from: Angles, key: string, by: { shift: boolean; alt: boolean }, steepest = STEEPEST): Angles | null {
  const step = by.shift ? 10 : by.alt ? 0.1 : 1;
  const { theta, phi } = from;
  const set = (t: number, p: number): Angles => incident({ theta: t, phi: p }, steepest);
  switch (key) {
    case "ArrowUp":
      return set(theta - step, phi);
    case "ArrowDown":
      return set(theta + step, phi);
    case "ArrowLeft":
      return set(theta, phi - step);
    case "ArrowRight":
      return set(theta, phi + step);
    case "PageUp":
      return set(theta - 10, phi);
    case "PageDown":
      return set(theta + 10, phi);
    case "Home":
      return set(0, phi);
    case "End":
      return set(steepest, phi);
    default:
      return null;
  }
}
