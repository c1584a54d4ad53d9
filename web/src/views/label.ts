/** What a function is called where there is little room: its preset, or its name and what is set of it. */
import { aliases } from "../catalogue";
import { shortName } from "../core/text";
import type { Shown } from "../state";

export function label({ preset, text }: Shown): string {
  if (preset !== null) return preset;
  const [name, rest] = shortName(text, aliases.value);
  return rest === "" ? name : `${name} ${rest}`;
}
