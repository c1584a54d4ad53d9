/** The registry, asked for once; among the slow work, for the first plots don't need it. */
import { computed, signal } from "@preact/signals";
import { engine } from "./engine/client";
import type { Catalogue } from "./engine/protocol";
import { complaintOf } from "./functions";
import { complain } from "./notices";

export const catalogue = signal<Catalogue | null>(null);

/** Names that stand for a model with parameters set, for `shortName`. */
export const aliases = computed(() =>
  (catalogue.value?.models ?? []).flatMap((model) => model.aliases.filter((alias) => alias.sets.length > 0).map((alias) => ({ name: alias.name, model: model.name, sets: alias.sets }))),
);

let asked: Promise<Catalogue | null> | null = null;

export function loadCatalogue(): Promise<Catalogue | null> {
  asked ??= engine
    .ask("catalogue", {}, { pool: "slow" })
    .then((reply) => (catalogue.value = reply?.answer ?? null))
    .catch((error: unknown) => {
      asked = null;
      complain(complaintOf(error));
      return null;
    });
  return asked;
}
