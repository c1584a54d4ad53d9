/** What a function is called where there is little room: its name and what is set of it. */
import { aliases } from "../catalogue";
import { shortName } from "../core/text";

export function label(text: string): string {
  const [name, rest] = shortName(text, aliases.value);
  return rest === "" ? name : `${name} ${rest}`;
}
