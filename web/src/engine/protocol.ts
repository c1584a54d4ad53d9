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
  /** Whether the description gives it; else its value is the default. */
  given: boolean;
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
  /** Descriptions of published parameters: `ward@gold-paint`. */
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
  as: { toml: string; command: string; rust: string; python: string };
}

/** The value for one pair of directions, in double precision: what `gonio brdf eval --json` prints, under the same keys. */
export interface Value {
  f_per_sr: [number, number, number];
  f_cos_per_sr: [number, number, number];
  pdf_per_sr: number;
}

/** Which factors of the reflection equation Lr = ∫ L f cosθ dω take part. */
export interface Factors {
  light: boolean;
  brdf: boolean;
  cosine: boolean;
}

export interface Requests {
  /** After a file of the engine's folder was replaced: what was read from files is read anew. */
  forget: { request: Record<string, never>; answer: Record<string, never> };
  catalogue: { request: Record<string, never>; answer: Catalogue };
  /** What a description means; the first thing to ask of any text or file. */
  describe: { request: { function: string }; answer: Description };
  /** `function` with these parameters set to these texts (null: taken away, so that the default holds). */
  set: { request: { function: string; values: Record<string, string | null> }; answer: Description };
  evaluate: { request: { function: string; wi: Angles; wo: Angles }; answer: Value };
  /**
   * The lobe: f for `wi` over outgoing directions, as a surface that is finer where it bends when drawn on `scale`. Arrays: `directions`
   * (3 a vertex), `values` (3 a vertex), `triangles` (3 vertices each), `spikes` (6 each: direction, share of the light that leaves in
   * this one direction, as of mirrors and glass).
   */
  lobe: {
    request: { function: string; wi: Angles; scale: "linear" | "cube-root" | "log"; cosine: boolean; /** For a picture that is about to change: about half the triangles. */ quick?: boolean };
    answer: { largest: [number, number, number] };
  };
  /**
   * f in the plane of incidence. Arrays: `angles` (−90…90, positive on the side away from the light, where a mirror reflects; −180…180 of
   * what transmits), `values` (3 each), `spikes` (4 each: angle, share). Steps are finer where it bends.
   */
  curve: { request: { function: string; wi: Angles; cosine: boolean }; answer: { largest: [number, number, number] } };
  /**
   * f over outgoing directions seen from above, `size`² pixels: azimuthal equidistant (radius ∝ θr, 90° at the rim), φ = 0 right, φ = 90° up, rows from
   * the top, pixel centres at (i + 0.5) / size. Array: `values` (3 a pixel, NaN outside of the disc).
   */
  hemisphere: { request: { function: string; wi: Angles; size: number; cosine: boolean }; answer: { largest: [number, number, number] } };
  /**
   * The command's slice: f over θd (row 0 is 90°, the last one 0) and θh (0…90° from left to right), both even steps of half a degree, nodes and
   * not centres: node 0 is 0°, the last one 89.9°. Array: `values` (3 each; NaN where a direction is below the horizon).
   */
  slice: { request: { function: string; phi_d: number }; answer: { side: number; largest: [number, number, number] } };
  /**
   * Directional albedo at the given angles (0…89.5°) and azimuth. Arrays: `reflected` (3 each), `total` (3 each; with what passes
   * through). Ask for a few angles at a time: each may take tens of milliseconds.
   */
  albedo: { request: { function: string; thetas: number[]; phi: number }; answer: { error: number } };
  /**
   * A ball under one distant light, seen along −z from afar; y up; `light` is from the direction of the viewer (θ) and from +x (right) towards
   * +y (up) (φ). The light's irradiance is π: a white diffuse surface that faces it appears as 1. Array: `values` (3 a pixel, rows from the top, NaN outside the ball). Factors of
   * the reflection equation that are switched off are 1.
   */
  ball: {
    request: { function: string; light: Angles; size: number; factors: Factors };
    answer: { largest: [number, number, number] };
  };
  /**
   * A part of a picture by the renderer: samples `first`…`first + count` of every pixel, which add up over workers and calls to the picture
   * that the command renders. Array: `sums` (3 a pixel: sums of `count` samples). Factors that are off: the light is uniform, of radiance 1; the
   * reflection function is 1/π; the cosine is 1. With a factor off only one reflection is followed.
   */
  render: {
    request: {
      function: string;
      object: "ball" | "preview";
      /** `files/NAME`, `sky:elevation=30`, `uniform:1`, as the command's --env; or `point`, from `direction` as for `ball`, but relative to the camera. */
      light: string;
      direction: Angles;
      /** Turned about the vertical axis, degrees. */
      turn: number;
      width: number;
      height: number;
      first: number;
      count: number;
      bounces: number;
      factors: Factors;
    };
    answer: { samples: number; rejected: number };
  };
  /** A panorama for show: array `values` (3 a pixel), rows from the zenith down. */
  panorama: { request: { light: string; width: number; height: number }; answer: { largest: [number, number, number] } };
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
      /** Of slices, degrees; 90 unless given. */
      phi_d?: number;
    };
    answer: { svg: string; notes: string[] };
  };
  /** What a measured file holds. */
  file: { request: { path: string }; answer: { format: string; summary: string; metadata: [string, string][]; notes: string[] } };
  /** Figures of the page Learn: see `crates/gonio-web/src/learn.rs`. */
  learn: { request: { figure: string; [key: string]: unknown }; answer: Record<string, unknown> };
}

export type Operation = keyof Requests;

export interface WitnessDirection {
  xyz: [number, number, number];
  theta_deg: number;
  phi_deg: number;
}

export interface Witness {
  wi: WitnessDirection | null;
  wo: WitnessDirection;
  u: [number, number, number] | null;
  values: { name: string; value: number | null }[];
}

export interface Verdict {
  property: string;
  outcome: "pass" | "fail" | "allowed" | "declared" | "information" | "not_applicable";
  /** The worst violation or the quantity looked at; `detail` says which. */
  figure: number | null;
  bound: number | null;
  p_value: number | null;
  witness: Witness | null;
  samples: number;
  false_positive_rate: number;
  detail: string;
  note: string | null;
  [key: string]: unknown;
}

export interface Report {
  passed: boolean;
  subject: string;
  effort: string;
  seed_name: string;
  verdicts: Verdict[];
}

/** An answer of the engine. */
export type Reply<K extends Operation = Operation> = { answer: Requests[K]["answer"]; arrays: Record<string, Float32Array> };

/** What is asked along with a `describe` or `set`: of the function that these answer, whatever `function` says. */
export type Along = { [K in Operation]: { operation: K; request: Requests[K]["request"] } }[Operation];

/** What the library says of a request that it can't answer: its one error, and a hint how to go on. */
export interface Complaint {
  message: string;
  help: string | null;
  /** Of a shader: line and column, from 1. */
  place: { line: number; column: number } | null;
}
