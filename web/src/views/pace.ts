/**
 * What the views that take longer than the plots are asked to show: the state itself where the machine is quick enough for all of them, else what it was
 * when there was time. Without this everything that follows a slider would share a few cores with the plots, which are looked at while it moves.
 */
import { batch, effect, signal, untracked } from "@preact/signals";
import { engine } from "../engine/client";
import { type Shown, visible, wi } from "../state";
import { pressed } from "./timings";

/** How long nothing may change until all views follow, milliseconds. */
const REST = 120;
/** How often they follow what never rests, where the plots would suffer. */
const PAUSE = 700;

export const paced = { functions: signal(visible.peek()), wi: signal(wi.peek()) };

let last = -Infinity;
let timer = 0;

effect(() => {
  const [functions, light] = [visible.value, wi.value];
  clearTimeout(timer);
  const follow = (): void => {
    last = performance.now();
    batch(() => {
      paced.functions.value = functions;
      paced.wi.value = light;
    });
    engine.hold("slow", false);
  };
  untracked(() => {
    const wait = pressed() && same(functions, paced.functions.value) ? last + PAUSE - performance.now() : 0;
    if (wait <= 0) follow();
    else {
      // What was still to be made of what is no longer there has time too.
      engine.hold("slow", true);
      timer = setTimeout(follow, Math.min(wait, REST));
    }
  });
});

/** Whether the same functions are shown, whatever their parameters are. */
function same(a: Shown[], b: Shown[]): boolean {
  return a.length === b.length && a.every((f, k) => f.id === b[k]!.id && f.revision === b[k]!.revision && f.preset === b[k]!.preset);
}
