import { describe, expect, test } from "vitest";
import { channelOf, magma, NOT_FINITE, ofDifference, ofValue } from "./colours";
import * as directions from "./directions";
import { grid } from "./grid";
import { outline } from "./outline";
import { continueRim } from "./rim";
import { csvText } from "./save";
import { aligned, axis, degrees, number, roundUp } from "./scale";
import { spread } from "./spread";
import { picture, shown, srgb8 } from "./tone";

describe("directions", () => {
  test("angles and vectors are inverse", () => {
    for (const angles of [
      { theta: 30, phi: 180 },
      { theta: 89, phi: -90 },
      { theta: 120, phi: 17 },
    ]) {
      const back = directions.toAngles(directions.toVector(angles));
      expect(back.theta).toBeCloseTo(angles.theta, 9);
      expect(back.phi).toBeCloseTo(angles.phi, 9);
    }
    expect(directions.wrap(-180)).toBe(180);
    expect(directions.wrap(540)).toBe(180);
    expect(directions.wrap(-360)).toBe(0);
  });

  test("the mirror's direction is at +θ in the plane of incidence, the light at −θ", () => {
    const wi = { theta: 40, phi: 110 };
    const mirror = directions.inPlane(wi, directions.mirrored(wi));
    expect(mirror.angle).toBeCloseTo(40, 9);
    expect(mirror.off).toBeCloseTo(0, 6);
    expect(directions.inPlane(wi, wi).angle).toBeCloseTo(-40, 9);
    expect(directions.inPlane(wi, { theta: 50, phi: 20 }).off).toBeCloseTo(50, 9);
    const back = directions.fromPlane(wi, -25);
    expect(back).toEqual({ theta: 25, phi: 110 });
  });

  test("places of the polar plot", () => {
    const [x, y] = directions.onPolar(-30, 2);
    expect(directions.angleOnPolar(x, y)).toBeCloseTo(-30, 9);
    expect(x).toBeLessThan(0);
    expect(y).toBeLessThan(0);
  });

  test("places on discs", () => {
    for (const disc of ["orthographic", "equidistant"] as const) {
      const angles = { theta: 63, phi: -150 };
      const back = directions.fromDisc(disc, ...directions.onDisc(disc, angles));
      expect(back.theta).toBeCloseTo(63, 9);
      expect(back.phi).toBeCloseTo(-150, 9);
      expect(directions.fromDisc(disc, 3, 0).theta).toBeCloseTo(90, 9);
      expect(directions.fromDisc(disc, 0, 0, 77).phi).toBe(77);
    }
  });

  test("half and difference angles are inverse, and a mirror's pair has θh = 0", () => {
    const pair = directions.fromHalfDifference(20, 35, 60, -40)!;
    const back = directions.halfDifference(pair.wi, pair.wo);
    expect(back.thetaH).toBeCloseTo(20, 6);
    expect(back.thetaD).toBeCloseTo(35, 6);
    expect(back.phiD).toBeCloseTo(60, 6);
    expect(back.phiH).toBeCloseTo(-40, 6);
    const wi = { theta: 50, phi: 30 };
    const mirror = directions.halfDifference(wi, directions.mirrored(wi));
    expect(mirror.thetaH).toBeCloseTo(0, 6);
    expect(mirror.thetaD).toBeCloseTo(50, 6);
    expect(directions.fromHalfDifference(80, 80, 0, 0)).toBeNull();
  });

  test("keys", () => {
    const from = { theta: 45, phi: 180 };
    const plain = { shift: false, alt: false };
    expect(directions.nudged(from, "ArrowUp", plain)).toEqual({ theta: 44, phi: 180 });
    expect(directions.nudged(from, "ArrowRight", { shift: true, alt: false })).toEqual({ theta: 45, phi: -170 });
    expect(directions.nudged(from, "End", plain)).toEqual({ theta: 89.5, phi: 180 });
    expect(directions.nudged(from, "q", plain)).toBeNull();
  });
});

describe("axes", () => {
  test("end at round numbers", () => {
    expect([0.99, 1, 1.01, 4.7, 8.1, 250].map(roundUp)).toEqual([1, 1, 1.5, 5, 10, 300]);
  });

  test("positions and values are inverse, and stay inside", () => {
    for (const kind of ["linear", "cube-root", "log"] as const) {
      const a = axis(kind, 0.02, 37);
      for (const p of [0.1, 0.5, 0.9]) expect(a.position(a.value(p))).toBeCloseTo(p, 9);
      expect(a.position(1e9)).toBe(1);
      expect(a.position(0)).toBe(0);
      expect(a.position(NaN)).toBeNaN();
    }
    expect(axis("log", 0.02, 37).low).toBe(0.01);
    expect(axis("log", 0, 1).low).toBe(1e-10);
    expect(axis("linear", 0, NaN).high).toBe(1);
    expect(axis("cube-root", 0, 8).position(1)).toBeCloseTo(0.5, 12);
  });

  test("ticks", () => {
    expect(axis("linear", 0, 2.9).ticks.map((t) => t.label)).toEqual(["0", "1", "2", "3"]);
    expect(axis("cube-root", 0, 380).ticks.map((t) => t.label)).toEqual(["0", "1", "10", "100", "400"]);
    const decades = axis("log", 0.05, 3).ticks.filter((t) => t.label !== "");
    expect(decades.map((t) => t.label)).toEqual(["0.01", "0.1", "1", "10"]);
  });

  test("numbers", () => {
    expect([0.3183, 1200, 4.5e6, 1e-4, -2, 0].map((x) => number(x))).toEqual(["0.318", "1200", "4.5 × 10⁶", "10⁻⁴", "−2", "0"]);
    expect(aligned(1 / Math.PI)).toBe("0.31831");
    expect(aligned(-1.5e-7)).toBe("−1.5000 × 10⁻⁷");
    expect(degrees(-0.04)).toBe("0.0°");
    expect(degrees(-12)).toBe("−12.0°");
  });
});

describe("colours", () => {
  test("magma grows brighter", () => {
    expect(magma(-1)).toEqual([0, 0, 3]);
    expect(magma(2)).toEqual([0xfb, 0xfc, 0xbf]);
    const brightness = (t: number): number => channelOf("luminance", magma(t));
    for (let k = 1; k < 64; k += 1) expect(brightness(k / 63)).toBeGreaterThan(brightness((k - 1) / 63));
  });

  test("differences have opposite colours", () => {
    expect(ofDifference(0)).toEqual([247, 247, 247]);
    expect(ofDifference(-1)).toEqual([5, 48, 97]);
    expect(ofDifference(3)).toEqual(ofDifference(1));
    expect(ofDifference(NaN)).toEqual(NOT_FINITE);
  });

  test("a colour keeps its proportions, its largest stands on the axis", () => {
    const [r, g, b] = ofValue("rgb", axis("log", 0.01, 99), [1, 0.5, 0]);
    // Half of the way.
    expect(Math.abs(r - 127.5)).toBeLessThan(1);
    expect(g).toBeGreaterThan(80);
    expect(g).toBeLessThan(100);
    expect(b).toBe(0);
  });
});

describe("tone curves", () => {
  test("the sRGB transfer", () => {
    expect([0, 0.5, 1, 9, NaN].map(srgb8)).toEqual([0, 188, 255, 255, 0]);
  });

  test("PBR Neutral leaves middle colours, less the reflection of a dielectric, and compresses bright ones", () => {
    expect(shown([0.54, 0.34, 0.24], 0, "pbr-neutral")).toEqual([0.5, 0.3, 0.2].map(srgb8));
    const bright = shown([20, 10, 10], 0, "pbr-neutral");
    expect(bright[0]).toBeGreaterThan(bright[1]);
    expect(bright[0]).toBeLessThanOrEqual(255);
  });

  test("exposure is a factor 2 a stop", () => {
    expect(shown([0.1, 0.2, 0.3], 1, "srgb")).toEqual(shown([0.2, 0.4, 0.6], 0, "srgb"));
  });

  test("ACES darkens black and bounds white", () => {
    expect(shown([0, 0, 0], 0, "aces")).toEqual([0, 0, 0]);
    // (1.0) by hand: the rows of the first matrix sum to 1, so every channel is (1 + 0.0245786 − 0.000090537) / 1.654761 = 0.619098.
    expect(shown([1, 1, 1], 0, "aces")).toEqual([0.619098, 0.619098, 0.619098].map(srgb8));
  });
});

describe("pictures and tables", () => {
  test("pixels that are not a number are transparent, infinite ones are white", () => {
    const out = new Uint8ClampedArray(8);
    picture(out, [NaN, NaN, NaN, Infinity, Infinity, Infinity], 1, "srgb");
    expect([...out]).toEqual([0, 0, 0, 0, 255, 255, 255, 255]);
  });

  test("a disc goes on beyond its rim, and no further", () => {
    const side = 16;
    const out = new Uint8ClampedArray(4 * side * side);
    for (let k = 0; k < side * side; k += 1) {
      const [x, y] = [(k % side) - 7.5, Math.floor(k / side) - 7.5];
      if (Math.hypot(x, y) <= 8) out.set([x < 0 ? 200 : 10, 0, 0, 255], 4 * k);
    }
    const inside = out.slice(4 * (8 * side + 8), 4 * (8 * side + 8) + 4);
    continueRim(out, side);
    expect([...out.slice(4 * (side + 1), 4 * (side + 1) + 4)]).toEqual([200, 0, 0, 255]);
    expect(out[3]).toBe(0);
    expect(out.slice(4 * (8 * side + 8), 4 * (8 * side + 8) + 4)).toEqual(inside);
  });

  test("a grid makes its cells as large as can be", () => {
    expect(grid(1, { width: 216, height: 116 }, 1)).toEqual({ columns: 1, cell: { width: 100, height: 100 } });
    expect(grid(2, { width: 216, height: 136 }, 1)).toEqual({ columns: 2, cell: { width: 96, height: 96 } });
    expect(grid(2, { width: 116, height: 400 }, 1).columns).toBe(1);
    expect(grid(3, { width: 10, height: 10 }, 1).cell.width).toBe(0);
  });

  test("a table quotes texts, keeps nine digits and leaves out what is no number", () => {
    expect(csvText(["a,b", "c"], [[1 / 3, NaN], ['x "y"', -2e-8]])).toBe('"a,b",c\r\n0.333333333,\r\n"x ""y""",-2e-8\r\n');
  });
});

describe("labels", () => {
  test("are spread where they would overlap, and only there", () => {
    expect(spread([100, 50], 14)).toEqual([100, 50]);
    expect(spread([100, 104, 30], 14)).toEqual([90, 104, 30]);
    expect(spread([50, 50, 50], 10)).toEqual([50, 40, 30]);
    expect(spread([NaN, 20], 10)).toEqual([NaN, 20]);
  });
});

describe("outlines", () => {
  const points = (path: string): number[][] => path.slice(1).split(/[LM]/).map((p) => p.split(" ").map(Number));

  test("pass every point within a tenth of a pixel, with far fewer pieces", () => {
    const xs = Float64Array.from({ length: 1000 }, (_, k) => 0.35 * k);
    const ys = xs.map((x) => 200 - 150 * Math.exp(-(((x - 190) / 9) ** 2)));
    const kept = points(outline(xs, ys));
    expect(kept.length).toBeLessThan(150);
    expect(kept[0]).toEqual([0, 200]);
    expect(kept.at(-1)![0]).toBeCloseTo(349.7, 1);
    xs.forEach((x, k) => {
      const next = kept.findIndex((p, i) => i > 0 && p[0]! >= x - 0.06);
      const [a, b] = [kept[next - 1]!, kept[next]!];
      const share = (x - a[0]!) / (b[0]! - a[0]!);
      const [dx, dy] = [b[0]! - a[0]!, b[1]! - a[1]!];
      expect((Math.abs(a[1]! + share * dy - ys[k]!) * dx) / Math.hypot(dx, dy)).toBeLessThan(0.15);
    });
  });

  test("keep a peak of one point, and break where a value is not finite", () => {
    const xs = Float64Array.from([0, 1, 2, 3, 4, 5, 6, 7]);
    expect(outline(xs, Float64Array.from([5, 5, 5, 1, 5, 5, NaN, 5]))).toBe("M0 5L2 5L3 1L4 5L5 5M7 5");
  });
});
