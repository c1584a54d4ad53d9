/** What can be chosen from the registry, and a search in it. */
import type { Catalogue } from "../engine/protocol";

export interface Choice {
  /** The description that is taken. */
  text: string;
  name: string;
  summary: string;
  kind: "model" | "alias" | "preset";
}

/** Every model, alias and preset, in the registry's order; what needs a file isn't among them. `model`: only its presets. */
export function choices(catalogue: Catalogue, model: string | null): Choice[] {
  const found: Choice[] = [];
  for (const entry of catalogue.models) {
    if (model !== null && entry.name !== model) continue;
    if (model === null && entry.example !== null) {
      found.push({ text: entry.example, name: entry.name, summary: entry.summary, kind: "model" });
      for (const alias of entry.aliases) {
        const sets = alias.sets.map(([key, value]) => `${key}=${value}`).join(", ");
        found.push({ text: alias.name, name: alias.name, summary: sets === "" ? `another name of ${entry.name}` : `${entry.name} with ${sets}`, kind: "alias" });
      }
    }
    for (const preset of entry.presets) found.push({ text: preset, name: preset, summary: "", kind: "preset" });
  }
  return found;
}

/** Those in which every word occurs, names that begin with the first word before others. Presets only when something is searched for, or `all`. */
export function search(list: Choice[], query: string, all: boolean): Choice[] {
  const words = query.toLowerCase().split(/\s+/).filter((word) => word !== "");
  if (words.length === 0) return all ? list : list.filter((choice) => choice.kind !== "preset");
  const rank = (choice: Choice): number => {
    const name = choice.name.toLowerCase();
    const text = `${name} ${choice.summary.toLowerCase()}`;
    if (!words.every((word) => text.includes(word))) return -1;
    const by = name === words[0] ? 0 : name.startsWith(words[0]!) ? 1 : words.every((word) => name.includes(word)) ? 2 : 3;
    return by * 2 + (choice.kind === "preset" ? 1 : 0);
  };
  return list
    .map((choice) => ({ choice, rank: rank(choice) }))
    .filter((found) => found.rank >= 0)
    .sort((a, b) => a.rank - b.rank)
    .map((found) => found.choice);
}
