/**
 * What the page and the library say to each other.
 *
 * Every operation is one call: a name and a JSON request in, a JSON answer and arrays of 32-bit numbers out. All of it is computed by
 * the library, compiled to WebAssembly; `crates/gonio-web` has the other side of each type here, under the same name.
 *
 * A function is named by its description, as the command reads it: `ggx:roughness=0.3,metal=gold`, `ward@gold-paint`, or the path of a
 * file that was put into the engine's folder, `files/paint.binary` or `files/mine.wgsl:tint=0.2`.
 * Directions are in the local frame (normal +z), angles in degrees, f in sr⁻¹, colours linear Rec.709.
 */

/** θ from the normal and φ around it, degrees. */
export interface Angles {
  theta: number;
  phi: number;
}

export type Parameter = {
  name: string;
  meaning: string;
  /** The allowed values in words. */
  expected: string;
} & (
  | { kind: "number"; unit: string; low: number; high: number; default: number | null; value: number | null }
  | { kind: "colour"; low: number; high: number; default: [number, number, number] | null; value: [number, number, number] | null }
  | { kind: "choice"; options: string[]; default: string | null; value: string | null }
  | { kind: "path"; value: string | null }
  | { kind: "name"; value: string | null }
  /** The descriptions of other functions. */
  | { kind: "models"; value: string[] }
);

export interface ModelEntry {
  name: string;
  summary: string;
  paper: string;
  parameters: Parameter[];
  positional: string | null;
  aliases: { name: string; sets: [string, string][] }[];
  recordable: boolean;
  /** The presets' names, as in `ward@NAME`. */
  presets: string[];
  /** A description that builds with nothing more given; null for tables and shaders, which need a file. */
  example: string | null;
}

export interface Catalogue {
  version: string;
  models: ModelEntry[];
  /** Extensions of measured files that the library reads. */
  measured: { extension: string; name: string; summary: string }[];
  /** Languages of `export`. */
  languages: { name: string; label: string; extension: string }[];
}

export interface Description {
  /** As it is written, with every given parameter. */
  text: string;
  model: string;
  summary: string;
  paper: string;
  /** With their values; those that a shader declares are among them. */
  parameters: Parameter[];
  declares: { reciprocal: boolean; energy_conserving: boolean; isotropic: boolean; albedo_bound: number | null };
  transmits: boolean;
  delta: boolean;
  recordable: boolean;
  warnings: string[];
  /** The same function for other places. */
  as: { toml: string; command: string; rust: string };
}

/** The value for one pair of directions, in double precision: what `gonio brdf eval --json` prints, under the same keys. */
export interface Value {
  f: [number, number, number];
  f_cos: [number, number, number];
  pdf: number;
}

export interface Requests {
  catalogue: { request: Record<string, never>; answer: Catalogue };
  /** What a description means; the first thing to ask of any text or file. */
  describe: { request: { function: string }; answer: Description };
  /** `function` with these parameters set to these texts (null: taken away, so that the default holds). */
  set: { request: { function: string; values: Record<string, string | null> }; answer: Description };
  evaluate: { request: { function: string; wi: Angles; wo: Angles }; answer: Value };
  /**
   * The lobe: f for `wi` over outgoing directions. Arrays: `directions` (3 a vertex), `values` (3 a vertex), `triangles` (3 vertices each,
   * as numbers). Vertices are denser around the peaks. With `below` also the lower hemisphere of what transmits.
   * `spikes` (7 each): direction, weight (3), probability of what goes into single directions (mirrors, glass).
   */
  lobe: { request: { function: string; wi: Angles; rings: number; cosine: boolean }; answer: { peak: number; largest: number; finite: boolean } };
  /**
   * f in the plane of incidence. Arrays: `angles` (−90…90, positive on the side away from the light, where a mirror reflects; −180…180 of what transmits),
   * `values` (3 each). Steps are finer around peaks.
   */
  curve: { request: { function: string; wi: Angles; cosine: boolean }; answer: { largest: number } };
  /** f over θd (down, 0…90°) and θh (right, linear in √θh as for MERL's pictures), `size`² pixels. Array: `values` (3 each). */
  slice: { request: { function: string; phi_d: number; size: number }; answer: { largest: number } };
  /** Directional albedo at angles 0…89.5°. Arrays: `angles`, `reflected` (3 each), `total` (3 each; with what passes through). */
  albedo: { request: { function: string; phi: number; steps: number }; answer: { error: number } };
  /**
   * A ball under one distant light of radiance-free unit irradiance, seen along −z from afar; y up. Array: `values` (3 a pixel, NaN outside
   * the ball). `part`: the whole of the reflection equation, or one factor of it.
   */
  ball: {
    request: { function: string; light: Angles; size: number; part: "all" | "brdf" | "cosine" | "light" };
    answer: { largest: number };
  };
  /**
   * A part of a picture by the renderer: samples `first`…`first + count` of every pixel, which add up over workers and calls.
   * Array: `sums` (3 a pixel: sums of `count` samples). `part`: which factors of the reflection equation take part.
   */
  render: {
    request: {
      function: string;
      object: "ball" | "preview";
      /** A panorama: a file of the engine's folder, or `sky:SUN_ELEVATION`, or `uniform:RADIANCE`; or `point` with `direction`. */
      light: string;
      direction: Angles;
      /** Turned about the vertical axis, degrees. */
      turn: number;
      width: number;
      height: number;
      first: number;
      count: number;
      bounces: number;
      part: "all" | "no-brdf" | "no-cosine" | "no-light";
    };
    answer: { samples: number; rejected: number };
  };
  /** A panorama for show: array `values` (3 a pixel), rows from the zenith down. */
  panorama: { request: { light: string; width: number; height: number }; answer: { largest: number } };
  /** The laboratory's verdicts: what `gonio brdf check --json` prints for one function. */
  check: { request: { function: string; effort: "quick" | "standard" }; answer: Report };
  /** Shader code. */
  export: { request: { function: string; language: string }; answer: { text: string } };
  /** The command's own plot of up to eight functions, as SVG. */
  plot: {
    request: {
      functions: string[];
      kind: "polar" | "cartesian" | "albedo" | "slice" | "lobe3d" | "sphere" | "difference";
      theta: number[];
      phi: number;
      scale: "auto" | "linear" | "cube-root" | "log";
      channel: "luminance" | "red" | "green" | "blue" | "rgb";
      cosine: boolean;
    };
    answer: { svg: string; notes: string[] };
  };
  /** What a measured file holds. */
  file: { request: { path: string }; answer: { format: string; summary: string; metadata: [string, string][]; notes: string[] } };
  /** Figures of the page Learn: see `crates/gonio-web/src/learn.rs`. */
  learn: { request: { figure: string; [key: string]: unknown }; answer: Record<string, unknown> };
}

export type Operation = keyof Requests;

export interface Witness {
  wi: Angles0 | null;
  wo: Angles0 | null;
  values: { name: string; value: number }[];
}
interface Angles0 {
  theta_deg: number;
  phi_deg: number;
}

export interface Verdict {
  property: string;
  outcome: "pass" | "fail" | "declared" | "not_applicable";
  figure: number | null;
  bound: number | null;
  evaluations: number;
  note?: string | null;
  witness: Witness | null;
  [key: string]: unknown;
}

export interface Report {
  subject: string;
  effort: string;
  seed_name: string;
  verdicts: Verdict[];
}

/** An answer of the engine. */
export type Reply<K extends Operation = Operation> = { answer: Requests[K]["answer"]; arrays: Record<string, Float32Array> };

/** What the library says of a request that it can't answer: its one error, and a hint how to go on. */
export interface Complaint {
  message: string;
  help: string | null;
  /** Of a shader: line and column, from 1. */
  place: { line: number; column: number } | null;
}
