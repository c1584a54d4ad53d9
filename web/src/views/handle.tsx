/** A direction in a drawing that is dragged with the mouse or a finger, and moved with the keys. */
import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import type { Angles } from "../engine/protocol";
import { incident } from "../plot/directions";
import { degrees } from "../plot/scale";
import { wi, wo } from "../state";

export type Which = "light" | "viewer";

/** Tells `moved` where a pointer is, in pixels from the upper left of `element`, until it is let go. */
export function follow(event: PointerEvent & { currentTarget: Element }, element: Element, moved: (x: number, y: number) => void): void {
  if (event.button !== 0) return;
  event.preventDefault();
  event.stopPropagation();
  const target = event.currentTarget;
  const box = element.getBoundingClientRect();
  const id = event.pointerId;
  target.setPointerCapture(id);
  if (target instanceof HTMLElement || target instanceof SVGElement) target.focus({ preventScroll: true });
  const move = (e: Event): void => {
    const p = e as PointerEvent;
    if (p.pointerId === id) moved(p.clientX - box.left, p.clientY - box.top);
  };
  const end = (e: Event): void => {
    if ((e as PointerEvent).pointerId !== id) return;
    target.removeEventListener("pointermove", move);
    target.removeEventListener("pointerup", end);
    target.removeEventListener("pointercancel", end);
  };
  target.addEventListener("pointermove", move);
  target.addEventListener("pointerup", end);
  target.addEventListener("pointercancel", end);
}

export function setWi(angles: Angles): void {
  const next = incident(angles);
  if (next.theta !== wi.value.theta || next.phi !== wi.value.phi) wi.value = next;
}

export function setWo(angles: Angles): void {
  const next = incident(angles, 180);
  if (next.theta !== wo.value?.theta || next.phi !== wo.value.phi) wo.value = next;
}

export interface HandleProps {
  which: Which;
  x: number;
  y: number;
  angles: Angles;
  /** Where the pointer is, in pixels of the drawing. */
  moved(x: number, y: number): void;
  /** Whether the key was understood. */
  keyed(key: string, by: { shift: boolean; alt: boolean }): boolean;
  /** Whether it is shown apart, as something that isn't in the plane of the drawing. */
  hollow?: boolean;
  /** Whether there is no such direction yet: it is seen while it has the focus, and the keys begin here. */
  unset?: boolean;
  /** What is there, beside the angles. */
  words?: string;
}

export function Handle({ which, x, y, angles, moved, keyed, hollow = false, unset = false, words }: HandleProps): JSX.Element {
  const self = useRef<SVGGElement>(null);
  return (
    <g
      ref={self}
      class={`handle handle-${which}${hollow ? " handle-hollow" : ""}${unset ? " handle-unset" : ""} aside`}
      transform={`translate(${x.toFixed(1)} ${y.toFixed(1)})`}
      tabindex={0}
      role="slider"
      aria-label={which === "light" ? "Direction of incidence" : "Direction of view"}
      aria-valuemin={0}
      aria-valuemax={which === "light" ? 89.5 : 180}
      aria-valuenow={Math.round(angles.theta * 100) / 100}
      aria-valuetext={`θ ${degrees(angles.theta)}, φ ${degrees(angles.phi)}${words === undefined ? "" : `: ${words}`}`}
      onPointerDown={(event) => follow(event, self.current!.ownerSVGElement!, moved)}
      onKeyDown={(event) => {
        if (event.ctrlKey || event.metaKey) return;
        if (keyed(event.key, { shift: event.shiftKey, alt: event.altKey })) event.preventDefault();
      }}
    >
      <circle class="handle-reach" r={22} />
      <circle class="handle-ring" r={11} />
      <circle class="handle-knob" r={which === "light" ? 6.5 : 5} />
    </g>
  );
}
