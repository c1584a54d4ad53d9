/** The command, which the page's figures are held to. */
import { execFileSync } from "node:child_process";
import { resolve } from "node:path";

const ROOT = resolve(import.meta.dirname, "../..");
export const SITE = resolve(ROOT, "web/dist");
export const GONIO = process.env.GONIO ?? resolve(ROOT, process.env.CARGO_TARGET_DIR ?? "target", "debug/gonio");

/** What the command prints. */
export function gonio(...words: string[]): string {
  return execFileSync(GONIO, words, { cwd: ROOT, encoding: "utf8" });
}

export interface Evaluated {
  f_per_sr: [number, number, number];
  f_cos_per_sr: [number, number, number];
  pdf_per_sr: number;
}

/** `gonio brdf eval --json` for directions in degrees. */
export function evaluated(description: string, wi: { theta: number; phi: number }, wo: { theta: number; phi: number }): Evaluated {
  return JSON.parse(gonio("brdf", "eval", description, "--wi", `${wi.theta},${wi.phi}`, "--wo", `${wo.theta},${wo.phi}`, "--json")) as Evaluated;
}
