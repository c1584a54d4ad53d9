/**
 * The whole state of the explorer, as signals: every view draws what they hold, and every control sets them. The permanent link is made
 * of the same (`link.ts`).
 */
import { computed, signal } from "@preact/signals";
import type { Angles, Complaint, Description, Factors } from "./engine/protocol";

/** A function that is shown. */
export interface Shown {
  /** Stays the same while the description changes. */
  id: number;
  /** The last description that the library understood: what the views draw. */
  text: string;
  /** The published parameters that it still is, as `ward@gold-paint`; its `text` has them written out. */
  preset: string | null;
  /** What it means; null until the library has answered. */
  description: Description | null;
  /** What was wrong with what was asked for last; the views keep what they have. */
  complaint: Complaint | null;
  /** Index into the palette, which is the same in every view. */
  colour: number;
  visible: boolean;
  /** Grows when a file behind the description changed (a shader was edited): the same text is another function then. */
  revision: number;
  /** When what `text` says was set, on the clock of `performance.now()`: for the measurement of what a slider takes. */
  changed?: number;
}

export type Scale = "linear" | "cube-root" | "log";
export type Channel = "luminance" | "red" | "green" | "blue" | "rgb";
export type ToneMap = "pbr-neutral" | "srgb" | "aces";

export type ViewName = "lobe" | "polar" | "cartesian" | "slice" | "albedo" | "ball" | "preview" | "difference";

export const functions = signal<Shown[]>([]);
/** The one whose parameters are edited, by id. */
export const selected = signal<number>(0);
/** Towards the light; every view shows it and lets it be dragged. θ in [0, 89.5], φ in (−180, 180]. */
export const wi = signal<Angles>({ theta: 45, phi: 180 });
/** A direction that is looked at, towards the viewer: a witness, or where the pointer is. */
export const wo = signal<Angles | null>(null);

export const scale = signal<Scale>("linear");
export const channel = signal<Channel>("luminance");
/** Whether f is shown times the cosine of the outgoing direction. */
export const cosine = signal(false);
/** Stops: brightness of pictures is 2^exposure. */
export const exposure = signal(0);
export const toneMap = signal<ToneMap>("pbr-neutral");

/** φd of the slice, degrees. */
export const phiD = signal(90);
/** Of the rendered picture. */
export const object = signal<"ball" | "preview">("preview");
/** `point`, or a panorama as the engine names it. */
export const light = signal("files/sunset.hdr");
export const turn = signal(0);
/** The reflection equation's factors that take part in the ball and the picture. */
export const factors = signal<Factors>({ light: true, brdf: true, cosine: true });
/** Two ids whose difference is shown (second − first), or null. */
export const difference = signal<[number, number] | null>(null);

/** The view that is shown large, over the others. */
export const large = signal<ViewName | null>(null);

export const visible = computed(() => functions.value.filter((f) => f.visible && f.description !== null));
export const current = computed(() => functions.value.find((f) => f.id === selected.value) ?? null);
