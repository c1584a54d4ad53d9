/** One parameter: the control that its declaration asks for. */
import { useSignal } from "@preact/signals";
import type { ComponentChildren, InputHTMLAttributes, JSX } from "preact";
import { useId, useRef } from "preact/hooks";
import { colourText, parseColour, short } from "../core/text";
import { fromHex, position, toHex, value } from "../core/scales";
import type { Parameter } from "../engine/protocol";
import { Hint, IconButton } from "./ui";

/**
 * Sets the parameter to a text, or takes it away; resolves when the library has answered: to false if it refused, to null if a newer request, which holds
 * this change too, came before.
 */
export type Set = (name: string, text: string | null) => Promise<boolean | null>;

interface Props<K extends Parameter["kind"] = Parameter["kind"]> {
  parameter: Extract<Parameter, { kind: K }>;
  set: Set;
}

/**
 * What the control shows while the library hasn't answered yet: without it the thumb of a slider would jump back to the last answer on every
 * redraw.
 */
function useDraft(name: string, set: Set): Draft {
  const draft = useSignal<string | null>(null);
  const refused = useSignal(false);
  const change = (text: string): void => {
    draft.value = text;
    refused.value = false;
    void set(name, text).then((understood) => {
      if (draft.value !== text) return;
      // What the library refused stays where it was typed, marked, beside its error.
      if (understood === false) refused.value = true;
      else draft.value = null;
    });
  };
  const reset = (): void => {
    draft.value = null;
    refused.value = false;
    void set(name, null);
  };
  return { draft: draft.value, refused: refused.value, change, reset };
}

interface Draft {
  /** What was asked for and isn't answered yet, or was refused. */
  draft: string | null;
  refused: boolean;
  change: (text: string) => void;
  reset: () => void;
}

/** A slider over 0…1; arrows go a hundredth of its range, with Shift a tenth. */
function Slider({ at, change, ...rest }: { at: number; change: (at: number) => void } & InputHTMLAttributes<HTMLInputElement>): JSX.Element {
  return (
    <input
      {...(rest as object)}
      type="range"
      min={0}
      max={1}
      step={0.001}
      value={at}
      onInput={(event) => change(Number(event.currentTarget.value))}
      onKeyDown={(event) => {
        const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
        if (step === undefined) return;
        event.preventDefault();
        change(Math.min(1, Math.max(0, at + step * (event.shiftKey ? 0.1 : 0.01))));
      }}
    />
  );
}

interface RowProps {
  parameter: Parameter;
  id: string;
  reset: (() => void) | null;
  /** The value as text, at the end of the first line. */
  figure?: JSX.Element;
  children: ComponentChildren;
}

function Row({ parameter, id, reset, figure, children }: RowProps): JSX.Element {
  return (
    <div class={`parameter ${reset === null ? "" : "parameter-set"}`}>
      <div class="parameter-head">
        <label for={id}>{parameter.name}</label>
        <Hint about={parameter.name}>
          {parameter.meaning}. <span class="quiet">Expected: {parameter.expected}.</span>
        </Hint>
        <span class="spring" />
        {reset !== null ? <IconButton icon="reset" label={`${parameter.name}: back to the default`} onClick={reset} /> : null}
        {figure}
        {parameter.kind === "number" && parameter.unit !== "" ? <span class="unit">{parameter.unit}</span> : null}
      </div>
      {children}
    </div>
  );
}

function NumberControl({ parameter, set }: Props<"number">): JSX.Element {
  const id = useId();
  const { draft, refused, change, reset } = useDraft(parameter.name, set);
  const { low, high } = parameter;
  const asked = draft === null || refused || draft === "" ? NaN : Number(draft);
  const shown = Number.isFinite(asked) ? asked : (parameter.value ?? parameter.default);
  const text = draft ?? (shown === null ? "" : short(shown));
  return (
    <Row
      parameter={parameter}
      id={id}
      reset={parameter.given ? reset : null}
      figure={<Figure label={`${parameter.name}, as a number`} text={text} refused={refused} change={change} />}
    >
      <Slider
        id={id}
        at={shown === null ? 0 : position(shown, low, high)}
        aria-valuetext={shown === null ? "not given" : `${short(shown)} ${parameter.unit}`}
        data-unset={shown === null ? "" : undefined}
        change={(at) => change(short(value(at, low, high)))}
      />
    </Row>
  );
}

interface FigureProps {
  id?: string;
  label?: string;
  text: string;
  refused: boolean;
  change: (text: string) => void;
  colour?: boolean;
}

/** A value as text. */
function Figure({ id, label, text, refused, change, colour = false }: FigureProps): JSX.Element {
  return (
    <input
      id={id}
      type="text"
      class={colour ? "figure figure-colour" : "figure"}
      aria-label={label}
      aria-invalid={refused}
      placeholder="–"
      spellcheck={false}
      autocomplete="off"
      value={text}
      onChange={(event) => change(event.currentTarget.value.trim())}
    />
  );
}

function ColourControl({ parameter, set }: Props<"colour">): JSX.Element {
  const id = useId();
  const { draft, refused, change, reset } = useDraft(parameter.name, set);
  const shown = (draft === null || refused ? null : parseColour(draft)) ?? parameter.value ?? parameter.default;
  const ratio = useRef<[number, number, number]>([1, 1, 1]);
  const { low, high } = parameter;
  const displayable = low >= 0 && high <= 1;
  const largest = shown === null ? 0 : Math.max(...shown);
  if (largest > 0 && draft === null) ratio.current = shown!.map((x) => x / largest) as [number, number, number];
  const scaled = (x: number): string => colourText(ratio.current.map((r) => r * x) as [number, number, number]);
  return (
    <Row
      parameter={parameter}
      id={id}
      reset={parameter.given ? reset : null}
      figure={<Figure id={id} text={draft ?? (shown === null ? "" : colourText(shown))} refused={refused} change={change} colour />}
    >
      {low >= 0 ? (
        <div class="slider">
          {displayable ? (
            <input
              type="color"
              class="swatch"
              aria-label={`${parameter.name}, chosen by eye`}
              value={toHex(shown ?? [0, 0, 0])}
              onInput={(event) => change(colourText(fromHex(event.currentTarget.value)))}
            />
          ) : null}
          <Slider
            at={position(largest, low, high)}
            aria-label={`${parameter.name}, its largest component`}
            aria-valuetext={short(largest)}
            data-unset={shown === null ? "" : undefined}
            change={(at) => change(scaled(value(at, low, high)))}
          />
        </div>
      ) : null}
    </Row>
  );
}

function ChoiceControl({ parameter, set }: Props<"choice">): JSX.Element {
  const id = useId();
  const { draft, refused, change, reset } = useDraft(parameter.name, set);
  const shown = (refused ? null : draft) ?? parameter.value ?? parameter.default ?? "";
  return (
    <Row parameter={parameter} id={id} reset={parameter.given ? reset : null}>
      <select id={id} class="select" value={shown} onChange={(event) => (event.currentTarget.value === "" ? reset() : change(event.currentTarget.value))}>
        {parameter.default === null ? <option value="">not given</option> : null}
        {parameter.options.map((option) => (
          <option key={option} value={option}>
            {option}
          </option>
        ))}
      </select>
    </Row>
  );
}

function TextControl({ parameter, set }: Props<"path" | "name">): JSX.Element {
  const id = useId();
  const { draft, refused, change, reset } = useDraft(parameter.name, set);
  return (
    <Row parameter={parameter} id={id} reset={null}>
      <input
        id={id}
        type="text"
        class="field"
        aria-invalid={refused}
        spellcheck={false}
        value={draft ?? parameter.value ?? ""}
        onChange={(event) => (event.currentTarget.value.trim() === "" ? reset() : change(event.currentTarget.value.trim()))}
      />
    </Row>
  );
}

/** Parts of composites are edited elsewhere, in `composite.tsx`. */
export function ParameterControl({ parameter, set }: { parameter: Parameter; set: Set }): JSX.Element | null {
  switch (parameter.kind) {
    case "number":
      return <NumberControl parameter={parameter} set={set} />;
    case "colour":
      return <ColourControl parameter={parameter} set={set} />;
    case "choice":
      return <ChoiceControl parameter={parameter} set={set} />;
    case "path":
    case "name":
      return <TextControl parameter={parameter} set={set} />;
    case "models":
      return null;
  }
}
