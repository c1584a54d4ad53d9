/**
 * The permanent link: the whole state in the address's fragment, which no server sees.
 *
 * `#f=ggx:metal=gold&f=lambertian&wi=45,180&…`: what has its initial value is left out. Texts of shaders are in it, compressed where that is shorter; measured
 * files and panoramas are too large, so the link names them, and who opens it is asked for them.
 */
import type { Angles, Factors } from "../engine/protocol";
import type { Channel, Scale, ToneMap, ViewName } from "../state";

export interface LinkedFunction {
  text: string;
  colour: number;
  visible: boolean;
}

export interface Linked {
  functions: LinkedFunction[];
  /** Index into `functions`. */
  selected: number;
  wi: Angles;
  wo: Angles | null;
  scale: Scale;
  channel: Channel;
  cosine: boolean;
  exposure: number;
  toneMap: ToneMap;
  phiD: number;
  object: "ball" | "preview";
  light: string;
  turn: number;
  factors: Factors;
  /** Two indices into `functions`. */
  difference: [number, number] | null;
  large: ViewName | null;
  /** Shaders by their name in the engine's folder. */
  shaders: Record<string, string>;
  /** Files that the link can't hold. */
  needs: string[];
}

export const INITIAL: Linked = {
  functions: [],
  selected: 0,
  wi: { theta: 45, phi: 180 },
  wo: null,
  scale: "linear",
  channel: "luminance",
  cosine: false,
  exposure: 0,
  toneMap: "pbr-neutral",
  phiD: 90,
  object: "preview",
  light: "files/sunset.hdr",
  turn: 0,
  factors: { light: true, brdf: true, cosine: true },
  difference: null,
  large: null,
  shaders: {},
  needs: [],
};

const MOST_FUNCTIONS = 8;
const MOST_SHADER = 1 << 20;
const SCALES: readonly Scale[] = ["linear", "cube-root", "log"];
const CHANNELS: readonly Channel[] = ["luminance", "red", "green", "blue", "rgb"];
const TONE_MAPS: readonly ToneMap[] = ["pbr-neutral", "srgb", "aces"];
const VIEWS: readonly ViewName[] = ["lobe", "polar", "cartesian", "slice", "albedo", "ball", "preview", "difference"];
const FACTORS = ["light", "brdf", "cosine"] as const;

/** Only what has a meaning in an address, or would be changed on its way, is escaped: links stay readable. */
function escape(text: string): string {
  return text.replace(/[^A-Za-z0-9._~!$'()*,;:@/?=-]/gu, (c) => encodeURIComponent(c));
}

function round(x: number): string {
  return String(Math.round(x * 1e4) / 1e4);
}

function angles(a: Angles): string {
  return `${round(a.theta)},${round(a.phi)}`;
}

export async function encode(state: Linked): Promise<string> {
  const pairs: [string, string][] = [];
  for (const f of state.functions) pairs.push(["f", f.text]);
  const colours = state.functions.map((f) => f.colour);
  if (colours.some((colour, i) => colour !== i)) pairs.push(["colours", colours.join(",")]);
  const hidden = state.functions.flatMap((f, i) => (f.visible ? [] : [i]));
  if (hidden.length > 0) pairs.push(["hidden", hidden.join(",")]);
  if (state.selected !== INITIAL.selected) pairs.push(["selected", String(state.selected)]);
  if (angles(state.wi) !== angles(INITIAL.wi)) pairs.push(["wi", angles(state.wi)]);
  if (state.wo !== null) pairs.push(["wo", angles(state.wo)]);
  for (const key of ["scale", "channel", "toneMap", "object", "light"] as const) if (state[key] !== INITIAL[key]) pairs.push([key, state[key]]);
  for (const key of ["exposure", "phiD", "turn"] as const) if (round(state[key]) !== round(INITIAL[key])) pairs.push([key, round(state[key])]);
  if (state.cosine) pairs.push(["cosine", "1"]);
  const off = FACTORS.filter((name) => !state.factors[name]);
  if (off.length > 0) pairs.push(["off", off.join(",")]);
  if (state.difference !== null) pairs.push(["difference", state.difference.join(",")]);
  if (state.large !== null) pairs.push(["large", state.large]);
  for (const [name, text] of Object.entries(state.shaders)) pairs.push(["shader", `${name}:${await pack(text)}`]);
  if (state.needs.length > 0) pairs.push(["needs", state.needs.join(",")]);
  return pairs.map(([key, value]) => `${key}=${escape(value)}`).join("&");
}

/** The state of a link, and what in it could not be used, in words. */
export async function decode(hash: string): Promise<{ state: Linked; problems: string[] }> {
  const state: Linked = { ...INITIAL, functions: [], shaders: {}, needs: [] };
  const problems: string[] = [];
  const late: (() => void)[] = [];
  for (const pair of hash.replace(/^#/, "").split("&")) {
    if (pair === "") continue;
    const at = pair.indexOf("=");
    const key = at < 0 ? pair : pair.slice(0, at);
    let value: string;
    try {
      value = decodeURIComponent(at < 0 ? "" : pair.slice(at + 1));
    } catch {
      problems.push(`‘${key}’ has an escape that is cut off`);
      continue;
    }
    const bad = (expected: string): void => void problems.push(`‘${key}=${value.slice(0, 40)}’: expected ${expected}`);
    const word = <T extends string>(words: readonly T[], set: (word: T) => void): void => {
      if ((words as readonly string[]).includes(value)) set(value as T);
      else bad(`one of ${words.join(", ")}`);
    };
    const number = (low: number, high: number, set: (x: number) => void): void => {
      const x = Number(value);
      if (value.trim() !== "" && x >= low && x <= high) set(x);
      else bad(`a number from ${low} to ${high}`);
    };
    const direction = (most: number, set: (a: Angles) => void): void => {
      const [theta, phi, ...more] = value.split(",").map((text) => (text.trim() === "" ? NaN : Number(text)));
      if (more.length === 0 && theta! >= 0 && theta! <= most && phi! >= -360 && phi! <= 360) set({ theta: theta!, phi: phi! });
      else bad(`θ,φ with θ from 0 to ${most}° and φ from -360 to 360°`);
    };
    const indices = (set: (list: number[]) => void): void => {
      const list = value.split(",").map(Number);
      if (list.every((i) => Number.isInteger(i) && i >= 0 && i < MOST_FUNCTIONS)) set(list);
      else bad("indices of functions");
    };
    switch (key) {
      case "f":
        if (state.functions.length < MOST_FUNCTIONS) state.functions.push({ text: value, colour: state.functions.length, visible: true });
        else problems.push(`only ${MOST_FUNCTIONS} functions can be shown: ‘${value.slice(0, 40)}’ is left out`);
        break;
      case "colours":
        indices((list) => late.push(() => list.forEach((colour, i) => state.functions[i] && (state.functions[i].colour = colour))));
        break;
      case "hidden":
        indices((list) => late.push(() => list.forEach((i) => state.functions[i] && (state.functions[i].visible = false))));
        break;
      case "selected":
        indices((list) => (state.selected = list[0]!));
        break;
      case "wi":
        direction(89.5, (a) => (state.wi = a));
        break;
      case "wo":
        direction(180, (a) => (state.wo = a));
        break;
      case "scale":
        word(SCALES, (w) => (state.scale = w));
        break;
      case "channel":
        word(CHANNELS, (w) => (state.channel = w));
        break;
      case "toneMap":
        word(TONE_MAPS, (w) => (state.toneMap = w));
        break;
      case "object":
        word(["ball", "preview"] as const, (w) => (state.object = w));
        break;
      case "large":
        word(VIEWS, (w) => (state.large = w));
        break;
      case "light":
        state.light = value;
        break;
      case "exposure":
        number(-20, 20, (x) => (state.exposure = x));
        break;
      case "phiD":
        number(0, 180, (x) => (state.phiD = x));
        break;
      case "turn":
        number(-360, 360, (x) => (state.turn = x));
        break;
      case "cosine":
        state.cosine = value === "1";
        break;
      case "off": {
        const off = value.split(",");
        state.factors = { light: !off.includes("light"), brdf: !off.includes("brdf"), cosine: !off.includes("cosine") };
        break;
      }
      case "difference":
        indices((list) => {
          if (list.length === 2) late.push(() => list.every((i) => i < state.functions.length) && (state.difference = [list[0]!, list[1]!]));
          else bad("two indices of functions");
        });
        break;
      case "shader": {
        const colon = value.indexOf(":");
        const name = value.slice(0, colon);
        if (colon <= 0 || !/^[\w.-]+$/.test(name)) {
          bad("NAME:TEXT");
          break;
        }
        try {
          state.shaders[name] = await unpack(value.slice(colon + 1));
        } catch (error) {
          problems.push(`the shader ‘${name}’ can't be read: ${error instanceof Error ? error.message : String(error)}`);
        }
        break;
      }
      case "needs":
        state.needs = value.split(",").filter((name) => /^[\w.-]+$/.test(name));
        break;
      default:
        problems.push(`‘${key}’ is not known`);
    }
  }
  for (const step of late) step();
  if (state.selected >= state.functions.length) state.selected = 0;
  return { state, problems };
}

/** Text as `t…` (plain) or `z…` (deflated), whichever is shorter. */
export async function pack(text: string): Promise<string> {
  const bytes = new TextEncoder().encode(text);
  const plain = `t${base64(bytes)}`;
  if (bytes.length < 100) return plain;
  const deflated = `z${base64(await through(bytes, new CompressionStream("deflate-raw"), Infinity))}`;
  return deflated.length < plain.length ? deflated : plain;
}

export async function unpack(packed: string): Promise<string> {
  const bytes = unbase64(packed.slice(1));
  if (packed[0] === "t") return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  if (packed[0] !== "z") throw new Error("expected text or deflated text");
  const inflated = await through(bytes, new DecompressionStream("deflate-raw"), MOST_SHADER).catch((error: unknown) => {
    throw error instanceof RangeError ? error : new Error("the compressed text is damaged");
  });
  return new TextDecoder("utf-8", { fatal: true }).decode(inflated);
}

async function through(bytes: Uint8Array<ArrayBuffer>, stream: CompressionStream | DecompressionStream, most: number): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const chunks: Uint8Array[] = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > most) {
      void reader.cancel();
      throw new RangeError(`it is longer than ${most} bytes`);
    }
    chunks.push(value);
  }
  const all = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) {
    all.set(chunk, at);
    at += chunk.length;
  }
  return all;
}

function base64(bytes: Uint8Array): string {
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return btoa(binary).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

function unbase64(text: string): Uint8Array<ArrayBuffer> {
  if (!/^[\w-]*$/.test(text)) throw new Error("it holds letters that base64 doesn't have");
  const binary = atob(text.replace(/-/g, "+").replace(/_/g, "/"));
  return Uint8Array.from(binary, (c) => c.charCodeAt(0));
}
