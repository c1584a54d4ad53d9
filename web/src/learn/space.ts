/** A small view into space, for drawings of lines: directions of the local frame (z up) onto paper. */
import { toVector, type Vector } from "../plot/directions";

const DEGREE = Math.PI / 180;

export interface Placed {
  x: number;
  y: number;
  /** Towards the viewer. */
  depth: number;
}

/** Seen from an azimuth and an elevation, by parallel rays. */
export class Camera {
  private readonly right: Vector;
  private readonly up: Vector;
  private readonly towards: Vector;

  constructor(
    azimuth: number,
    elevation: number,
    private readonly centre: readonly [number, number],
    /** Pixels of a unit length that is seen from the side. */
    readonly scale: number,
  ) {
    const [ca, sa] = [Math.cos(azimuth * DEGREE), Math.sin(azimuth * DEGREE)];
    const [ce, se] = [Math.cos(elevation * DEGREE), Math.sin(elevation * DEGREE)];
    this.right = [-sa, ca, 0];
    this.up = [-ca * se, -sa * se, ce];
    this.towards = [ca * ce, sa * ce, se];
  }

  place(v: Vector): Placed {
    const along = (axis: Vector): number => v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2];
    return { x: this.centre[0] + this.scale * along(this.right), y: this.centre[1] - this.scale * along(this.up), depth: along(this.towards) };
  }

  /** A path through points; those at the back of a sphere around the origin are in the second one. */
  line(points: readonly Vector[], closed = false): { front: string; back: string } {
    const placed = (closed ? [...points, points[0]!] : points).map((p) => this.place(p));
    const paths = { front: "", back: "" };
    let last: "front" | "back" | null = null;
    placed.forEach((p, i) => {
      const side = p.depth >= -1e-9 ? "front" : "back";
      const at = `${p.x.toFixed(1)} ${p.y.toFixed(1)}`;
      if (side === last) paths[side] += `L${at}`;
      else {
        // The piece that crosses the rim belongs to both.
        const before = placed[i - 1];
        if (before !== undefined && last !== null) paths[last] += `L${at}`;
        paths[side] += before === undefined ? `M${at}` : `M${before.x.toFixed(1)} ${before.y.toFixed(1)}L${at}`;
      }
      last = side;
    });
    return paths;
  }

  /** A filled shape. */
  shape(points: readonly Vector[]): string {
    return `${points.map((p, i) => `${i === 0 ? "M" : "L"}${this.place(p).x.toFixed(1)} ${this.place(p).y.toFixed(1)}`).join("")}Z`;
  }
}

/** The circle of directions at an angle from the axis (θ, φ). */
export function ring(axis: { theta: number; phi: number }, angle: number, steps = 72): Vector[] {
  const w = toVector(axis);
  const u = toVector({ theta: axis.theta + 90, phi: axis.phi });
  const v: Vector = [w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]];
  const [c, s] = [Math.cos(angle * DEGREE), Math.sin(angle * DEGREE)];
  return Array.from({ length: steps }, (_, i) => {
    const [ct, st] = [Math.cos((i / steps) * 2 * Math.PI), Math.sin((i / steps) * 2 * Math.PI)];
    return [0, 1, 2].map((k) => c * w[k]! + s * (ct * u[k]! + st * v[k]!)) as unknown as Vector;
  });
}

/** Directions along an arc of θ or of φ. */
export function arc(from: { theta: number; phi: number }, to: { theta: number; phi: number }, steps = 24): Vector[] {
  return Array.from({ length: steps + 1 }, (_, i) => {
    const t = i / steps;
    return toVector({ theta: from.theta + t * (to.theta - from.theta), phi: from.phi + t * (to.phi - from.phi) });
  });
}

export const times = (v: Vector, r: number): Vector => [v[0] * r, v[1] * r, v[2] * r];
