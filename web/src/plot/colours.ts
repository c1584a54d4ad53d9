/** Colours of values: one number as magma, a difference in two hues, a colour by its own. As in the command's plots. */
import type { Channel } from "../state";
import { srgb8 } from "./tone";
import type { Axis } from "./scale";

/**
 * Magma: dark for little, bright for much, even steps to the eye, readable without colour and for colour-blind people.
 * Source: van der Walt & Smith, matplotlib's default colour maps (2015), dedicated to the public domain (CC0).
 */
// prettier-ignore
const CODES =
  "00000300000400000601000701010901010b02020d02020f03031104031304041505041706051907051b08061d09071f0a07220b08240c09260d0a28" +
  "0e0a2a0f0b2c100c2f110c31120d33140d35150e38160e3a170f3c180f3f1a10411b10441c10461e10491f114b20114d221150231152251155261157" +
  "2811592a115c2b115e2d10602f1062301065321067341068350f6a370f6c390f6e3b0f6f3c0f713e0f72400f73420f74430f75450f76470f77481078" +
  "4a10794b10794d117a4f117b50127b52127c53137c55137d57147d58157e5a157e5b167e5d177e5e177f60187f61187f63197f651a80661a80681b80" +
  "691c806b1c806c1d806e1e816f1e81711f81731f817420817621817721817922817a22817c23817e24817f2481812581822581842681852681872781" +
  "8928818a28818c29808d29808f2a80912a80922b80942b80952c80972c7f992d7f9a2d7f9c2e7f9e2e7e9f2f7ea12f7ea3307ea4307da6317da7317d" +
  "a9327cab337cac337bae347bb0347bb1357ab3357ab53679b63679b83778b93778bb3877bd3977be3976c03a75c23a75c33b74c53c74c63c73c83d72" +
  "ca3e72cb3e71cd3f70ce4070d0416fd1426ed3426dd4436dd6446cd7456bd9466ada4769dc4869dd4968de4a67e04b66e14c66e24d65e44e64e55063" +
  "e65162e75262e85461ea5560eb5660ec585fed595fee5b5eee5d5def5e5df0605df1615cf2635cf3655cf3675bf4685bf56a5bf56c5bf66e5bf6705b" +
  "f7715bf7735cf8755cf8775cf9795cf97b5df97d5dfa7f5efa805efa825ffb8460fb8660fb8861fb8a62fc8c63fc8e63fc9064fc9265fc9366fd9567" +
  "fd9768fd9969fd9b6afd9d6bfd9f6cfda16efda26ffda470fea671fea873feaa74feac75feae76feaf78feb179feb37bfeb57cfeb77dfeb97ffebb80" +
  "febc82febe83fec085fec286fec488fec689fec78bfec98dfecb8efdcd90fdcf92fdd193fdd295fdd497fdd698fdd89afdda9cfddc9dfddd9ffddfa1" +
  "fde1a3fce3a5fce5a6fce6a8fce8aafceaacfcecaefceeb0fcf0b1fcf1b3fcf3b5fcf5b7fbf7b9fbf9bbfbfabdfbfcbf";
const MAGMA = Uint8Array.from({ length: 768 }, (_, k) => parseInt(CODES.slice(2 * k, 2 * k + 2), 16));

/** The colour of values that are not finite: none of the maps has it. */
export const NOT_FINITE: RGB = [0x00, 0xc8, 0xff];

/** sRGB codes. */
export type RGB = [number, number, number];

/** Magma at `t`, clamped to [0, 1]. */
export function magma(t: number): RGB {
  const k = 3 * Math.round(255 * Math.min(Math.max(t, 0), 1));
  return [MAGMA[k]!, MAGMA[k + 1]!, MAGMA[k + 2]!];
}

const LESS: RGB[] = [
  [247, 247, 247],
  [103, 169, 207],
  [5, 48, 97],
];
const MORE: RGB[] = [
  [247, 247, 247],
  [239, 138, 98],
  [103, 0, 31],
];

function mixed(share: number): RGB {
  const stops = share < 0 ? LESS : MORE;
  const at = 2 * Math.abs(share);
  const k = at < 1 ? 0 : 1;
  const mix = (c: number): number => Math.round(stops[k]![c]! + (at - k) * (stops[k + 1]![c]! - stops[k]![c]!));
  return [mix(0), mix(1), mix(2)];
}
/** In steps that nobody sees: a picture has tens of thousands of them. */
const DIFFERENCES: RGB[] = Array.from({ length: 513 }, (_, k) => mixed(k / 256 - 1));

/** A difference from −1 to 1: blue for less, white for none, red for more (after ColorBrewer's RdBu, Harrower & Brewer 2003). */
export function ofDifference(share: number): RGB {
  if (!Number.isFinite(share)) return NOT_FINITE;
  return DIFFERENCES[Math.round(256 * (Math.min(Math.max(share, -1), 1) + 1))]!;
}

/** Weights of Rec. 709's primaries in the luminance. */
const LUMINANCE = [0.2126, 0.7152, 0.0722];

/** The one number that a channel shows of a colour; the luminance where three are shown. */
export function channelOf(channel: Channel, values: ArrayLike<number>, first = 0): number {
  const [r, g, b] = [values[first]!, values[first + 1]!, values[first + 2]!];
  switch (channel) {
    case "red":
      return r;
    case "green":
      return g;
    case "blue":
      return b;
    default:
      return LUMINANCE[0]! * r + LUMINANCE[1]! * g + LUMINANCE[2]! * b;
  }
}

const decode = (code: number): number => (code <= 0.04045 ? code / 12.92 : Math.pow((code + 0.055) / 1.055, 2.4));

/**
 * The colour of f. One number has a false colour; for three the largest stands on the axis as the brightness, and the others are in
 * proportion to it.
 */
export function ofValue(channel: Channel, axis: Axis, values: ArrayLike<number>, first = 0): RGB {
  if (channel !== "rgb") {
    const value = channelOf(channel, values, first);
    return Number.isFinite(value) ? magma(axis.position(value)) : NOT_FINITE;
  }
  const [r, g, b] = [values[first]!, values[first + 1]!, values[first + 2]!];
  if (!Number.isFinite(r + g + b)) return NOT_FINITE;
  const most = Math.max(r, g, b);
  if (!(most > 0)) return [0, 0, 0];
  const brightness = decode(axis.position(most)) / most;
  return [srgb8(r * brightness), srgb8(g * brightness), srgb8(b * brightness)];
}

/** A picture of values, 3 a pixel, into `out`, 4 codes a pixel; what is NaN (a direction below the horizon) is left transparent. */
export function paintValues(out: Uint8ClampedArray, channel: Channel, axis: Axis, values: Float32Array): void {
  for (let k = 0, o = 0; k + 2 < values.length; k += 3, o += 4) {
    if (Number.isNaN(values[k]!)) continue;
    out[o + 3] = 255;
    const value = channel === "rgb" ? NaN : channelOf(channel, values, k);
    if (Number.isFinite(value)) {
      const m = 3 * Math.round(255 * axis.position(value));
      out[o] = MAGMA[m]!;
      out[o + 1] = MAGMA[m + 1]!;
      out[o + 2] = MAGMA[m + 2]!;
    } else out.set(ofValue(channel, axis, values, k), o);
  }
}
