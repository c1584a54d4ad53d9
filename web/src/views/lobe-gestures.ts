/** The lobe under a mouse and fingers: one turns it, two scale it. */
import type { LobeScene } from "./lobe-scene";

/** Radians that a pixel turns. */
const TURN = 0.008;

type Place = [number, number];
const between = (a: Place, b: Place): number => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** Follows the pointers that go down on the element itself; gives back what ends it. */
export function gestures(element: HTMLElement, scene: () => LobeScene | null): () => void {
  const fingers = new Map<number, Place>();
  const down = (event: PointerEvent): void => {
    if (event.button !== 0 || event.target !== element) return;
    event.preventDefault();
    element.setPointerCapture(event.pointerId);
    element.focus({ preventScroll: true });
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  };
  const move = (event: PointerEvent): void => {
    const before = fingers.get(event.pointerId);
    if (before === undefined) return;
    const now: Place = [event.clientX, event.clientY];
    fingers.set(event.pointerId, now);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other === undefined) scene()?.turn(-TURN * (now[0] - before[0]), TURN * (now[1] - before[1]));
    else if (between(before, other) > 0) scene()?.scale(between(now, other) / between(before, other));
  };
  const up = (event: PointerEvent): void => void fingers.delete(event.pointerId);
  // One finger that goes up or down scrolls the page; two are for the lobe alone.
  const hold = (event: TouchEvent): void => {
    if (event.touches.length > 1 && event.cancelable) event.preventDefault();
  };
  element.addEventListener("pointerdown", down);
  element.addEventListener("pointermove", move);
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", up);
  element.addEventListener("touchmove", hold, { passive: false });
  return () => {
    element.removeEventListener("pointerdown", down);
    element.removeEventListener("pointermove", move);
    element.removeEventListener("pointerup", up);
    element.removeEventListener("pointercancel", up);
    element.removeEventListener("touchmove", hold);
  };
}
