/** What the figures are made of: a frame, sliders, choices, and figures in numbers. */
import type { ComponentChildren, JSX } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import type { Complaint } from "../engine/protocol";
import { Problem } from "../panels/ui";
import { aligned } from "../plot/scale";

export interface Size {
  width: number;
  height: number;
}

/** A drawing that fills the width there is; its height follows by `ratio`, width to height. */
export function Drawing({ ratio, label, children }: { ratio: number | ((width: number) => number); label: string; children: (size: Size) => ComponentChildren }): JSX.Element {
  const element = useRef<HTMLDivElement>(null);
  const [width, setWidth] = useState(0);
  useEffect(() => {
    const observer = new ResizeObserver(() => setWidth(element.current?.clientWidth ?? 0));
    observer.observe(element.current!);
    return () => observer.disconnect();
  }, []);
  const height = Math.round(width / (typeof ratio === "number" ? ratio : ratio(width)));
  return (
    <div ref={element} class="learn-drawing">
      {width > 0 ? (
        <svg width={width} height={height} viewBox={`0 0 ${width} ${height}`} role="img" aria-label={label}>
          {children({ width, height })}
        </svg>
      ) : null}
    </div>
  );
}

interface FigureProps {
  caption: string;
  complaint?: Complaint | null;
  controls?: ComponentChildren;
  /** Where there is room: two drawings of one width, or a drawing with a small picture beside it. */
  layout?: "halves" | "beside";
  children: ComponentChildren;
}

/** Around each figure: its drawings, the controls under them, and what the library says if it can't answer. */
export function Figure({ caption, complaint, controls, layout, children }: FigureProps): JSX.Element {
  return (
    <figure class="learn-figure">
      <div class="learn-drawings" data-layout={layout}>
        {children}
      </div>
      {complaint != null ? <Problem complaint={complaint} /> : null}
      {controls !== undefined ? <div class="learn-controls">{controls}</div> : null}
      <figcaption>{caption}</figcaption>
    </figure>
  );
}

interface SliderProps {
  label: string;
  value: number;
  min: number;
  max: number;
  step?: number;
  unit?: string;
  /** How the value is written, where not as a number with its unit. */
  text?: string;
  onValue: (value: number) => void;
}

export function Slider({ label, value, min, max, step = 1, unit = "", text, onValue }: SliderProps): JSX.Element {
  const id = useId();
  const shown = text ?? `${value}${unit}`;
  return (
    <div class="learn-slider">
      <label for={id}>{label}</label>
      <input
        id={id}
        type="range"
        min={min}
        max={max}
        step={step}
        value={value}
        aria-valuetext={shown}
        onInput={(event) => onValue(Number(event.currentTarget.value))}
      />
      <output for={id}>{shown}</output>
    </div>
  );
}

export function Choice<V extends string>({ label, value, options, onValue }: { label: string; value: V; options: readonly (readonly [V, string])[]; onValue: (value: V) => void }): JSX.Element {
  const id = useId();
  return (
    <div class="learn-choice">
      <label for={id}>{label}</label>
      <select id={id} value={value} onChange={(event) => onValue(event.currentTarget.value as V)}>
        {options.map(([option, name]) => (
          <option key={option} value={option}>
            {name}
          </option>
        ))}
      </select>
    </div>
  );
}

export function Check({ label, value, onValue }: { label: string; value: boolean; onValue: (value: boolean) => void }): JSX.Element {
  return (
    <label class="learn-check">
      <input type="checkbox" checked={value} onChange={(event) => onValue(event.currentTarget.checked)} />
      {label}
    </label>
  );
}

/** Names and what they are now; a dash where nothing was answered yet. `look` is the class of a line in the drawing. */
export function Numbers({ rows }: { rows: readonly { name: string; value: string | null; look?: string; strong?: boolean }[] }): JSX.Element {
  return (
    <dl class="learn-numbers">
      {rows.map(({ name, value, look, strong }) => (
        <div key={name} class={strong ? "learn-numbers-strong" : undefined}>
          <dt>
            {look !== undefined ? <span class={`learn-numbers-key ${look}`} /> : null}
            {name}
          </dt>
          <dd>{value ?? "–"}</dd>
        </div>
      ))}
    </dl>
  );
}

/** A number of the library as the page writes it; null stays null. */
export const figureOf = (x: number | undefined | null, digits = 5): string | null => (x === undefined || x === null ? null : x === 0 ? "0" : aligned(x, digits));
