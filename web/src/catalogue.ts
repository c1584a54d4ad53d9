/** The registry, asked for once. */
import { signal } from "@preact/signals";
import { engine } from "./engine/client";
import type { Catalogue } from "./engine/protocol";
import { complaintOf } from "./functions";
import { complain } from "./notices";

export const catalogue = signal<Catalogue | null>(null);

let asked: Promise<Catalogue | null> | null = null;

export function loadCatalogue(): Promise<Catalogue | null> {
  asked ??= engine
    .ask("catalogue", {}, { pool: "fast" })
    .then((reply) => (catalogue.value = reply?.answer ?? null))
    .catch((error: unknown) => {
      asked = null;
      complain(complaintOf(error));
      return null;
    });
  return asked;
}
