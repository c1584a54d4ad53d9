/**
 * From linear light to what a display shows: exposure, tone curve, sRGB transfer. The curves are the library's (`gonio_image::tonemap`):
 * Khronos PBR Neutral (specification of 2024), Stephen Hill's fit of ACES 1.0, and none but clipping.
 */
import type { ToneMap } from "../state";

type Colour = [number, number, number];

/** Maps linear `rgb` to display-linear in [0, 1], in place. NaN and negative values count as 0. */
type Curve = (rgb: Colour) => void;

const START = 0.76;
const neutral: Curve = (rgb) => {
  const least = Math.min(rgb[0], rgb[1], rgb[2]);
  const offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  const peak = Math.max(rgb[0], rgb[1], rgb[2]) - offset;
  for (let c = 0; c < 3; c += 1) rgb[c]! -= offset;
  if (peak < START) return;
  const room = 1 - START;
  const lowered = 1 - (room * room) / (peak + room - START);
  const fade = 1 - 1 / (0.15 * (peak - lowered) + 1);
  for (let c = 0; c < 3; c += 1) rgb[c] = (1 - fade) * ((rgb[c]! / peak) * lowered) + fade * lowered;
};

const aces: Curve = (rgb) => {
  const [r, g, b] = rgb.map((x) => Math.min(x, 1e9)) as Colour;
  const x = rational(0.59719 * r + 0.35458 * g + 0.04823 * b);
  const y = rational(0.076 * r + 0.90834 * g + 0.01566 * b);
  const z = rational(0.0284 * r + 0.13383 * g + 0.83777 * b);
  rgb[0] = 1.60475 * x - 0.53108 * y - 0.07367 * z;
  rgb[1] = -0.10208 * x + 1.10813 * y - 0.00605 * z;
  rgb[2] = -0.00327 * x - 0.07276 * y + 1.07602 * z;
};
const rational = (v: number): number => (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081);

const CURVES: Record<ToneMap, Curve> = { "pbr-neutral": neutral, aces, srgb: () => {} };

/** The sRGB code of display-linear `x`, 0…255. */
export function srgb8(x: number): number {
  if (!(x > 0)) return 0;
  if (x >= 1) return 255;
  const code = x <= 0.0031308 ? 12.92 * x : 1.055 * Math.pow(x, 1 / 2.4) - 0.055;
  return Math.round(255 * code);
}

/** `srgb8` of k / 4096, looked up: a picture has a million of them. */
const CODES = Uint8Array.from({ length: 4097 }, (_, k) => srgb8(k / 4096));
/** Below this the transfer is so steep that the table would miss codes. */
const SMALL = 1 / 32;
const quick = (x: number): number => (x < SMALL ? srgb8(x) : x >= 1 ? 255 : CODES[Math.round(x * 4096)]!);

/** One colour, as sRGB codes. */
export function shown(rgb: readonly number[], exposure: number, curve: ToneMap): [number, number, number] {
  const out = new Uint8ClampedArray(4);
  picture(out, rgb, 2 ** exposure, curve);
  return [out[0]!, out[1]!, out[2]!];
}

/**
 * Pixels of `values` (3 a pixel) times `factor`, into `out` (4 a pixel). A pixel that is not a number is left transparent: it is outside of
 * what is shown.
 */
export function picture(out: Uint8ClampedArray, values: ArrayLike<number>, factor: number, curve: ToneMap): void {
  const map = CURVES[curve];
  const rgb: Colour = [0, 0, 0];
  for (let i = 0, o = 0; i + 2 < values.length; i += 3, o += 4) {
    if (Number.isNaN(values[i]!)) {
      out[o + 3] = 0;
      continue;
    }
    for (let c = 0; c < 3; c += 1) {
      const light = values[i + c]! * factor;
      rgb[c] = light > 0 ? Math.min(light, 3.4e38) : 0;
    }
    map(rgb);
    out[o] = quick(rgb[0]);
    out[o + 1] = quick(rgb[1]);
    out[o + 2] = quick(rgb[2]);
    out[o + 3] = 255;
  }
}
