/** Which of the two pages is shown, by the address's fragment: `#learn`, `#learn/T8`, or else the explorer's state. */
import { signal } from "@preact/signals";

export interface Route {
  page: "explore" | "learn";
  /** Of the page Learn: the row of the theory. */
  section: string | null;
  /** The explorer's fragment, to go back to. */
  back: string;
}

export function isLearn(hash: string): boolean {
  return /^#learn($|\/)/.test(hash);
}

function read(before: string): Route {
  const hash = location.hash;
  return isLearn(hash) ? { page: "learn", section: hash.split("/")[1] ?? null, back: before } : { page: "explore", section: null, back: hash === "" ? "#" : hash };
}

export const route = signal<Route>(read("#"));

addEventListener("hashchange", (event) => {
  const before = new URL(event.oldURL).hash;
  route.value = read(isLearn(before) ? route.value.back : before === "" ? "#" : before);
});
