/** How long it takes from a change to what is drawn of it, for every view: `window.__gonio.timings`. */
import { signal } from "@preact/signals";
import { useLayoutEffect } from "preact/hooks";
import type { ViewName } from "../state";

export interface Timing {
  /** When the state was set, on the clock of `performance.now()`. */
  since: number;
  /** Milliseconds from there until the drawing was in the document. */
  drawn: number;
  /** Milliseconds until the frame that has it was handed to the screen. */
  painted: number;
}

/** Enough for the statistics of a long drag. */
const KEPT = 500;

const timings: Partial<Record<ViewName, Timing[]>> = {};

declare global {
  interface Window {
    __gonio?: { timings: typeof timings };
  }
}
window.__gonio = { timings };

export function drawn(view: ViewName, since: number): void {
  const timing: Timing = { since, drawn: performance.now() - since, painted: NaN };
  const list = (timings[view] ??= []);
  list.push(timing);
  if (list.length > KEPT) list.shift();
  const crowded = performance.now() - stirred < 100;
  // A task that is queued in a frame's callback runs after that frame.
  requestAnimationFrame(() =>
    setTimeout(() => {
      timing.painted = performance.now() - since;
      begun.value = true;
      if ((view === "polar" || view === "cartesian") && crowded) latency = Math.max(0.95 * latency, timing.painted);
    }),
  );
}

/** Whether the first plots are on the screen: everything else begins then, or when they don't come. */
export const begun = signal(false);
setTimeout(() => (begun.value = true), 2000);

/** How late plots were that were drawn while other views were at work: the worst of late. */
let latency = 0;
let stirred = -Infinity;

/** To be called when a view other than the plots begins or ends something. */
export function stir(): void {
  stirred = performance.now();
}

/** Whether the plots come later than they should while other views are at work: then these must wait. */
export const pressed = (): boolean => latency > 33;

/** To be called by a view with the time of the newest change that it draws; 0 where it draws nothing. */
export function useDrawn(view: ViewName, since: number): void {
  useLayoutEffect(() => {
    if (since > 0) drawn(view, since);
  }, [view, since]);
}
