/** One parameter: the control that its declaration asks for. */
import { useSignal } from "@preact/signals";
import type { ComponentChildren, JSX } from "preact";
import { useId, useRef } from "preact/hooks";
import { colourText, short } from "../core/text";
import { fromHex, position, toHex, value } from "../core/scales";
import type { Parameter } from "../engine/protocol";
import { Hint, IconButton } from "./ui";

/** Sets the parameter to a text, or takes it away; resolves when the library has answered. */
export type Set = (name: string, text: string | null) => Promise<unknown>;

interface Props<K extends Parameter["kind"] = Parameter["kind"]> {
  parameter: Extract<Parameter, { kind: K }>;
  set: Set;
}

/**
 * What the control shows while the library hasn't answered yet: without it the thumb of a slider would jump back to the last answer on every
 * redraw.
 */
function useDraft(name: string, set: Set): { draft: string | null; change: (text: string) => void; reset: () => void } {
  const draft = useSignal<string | null>(null);
  const change = (text: string): void => {
    draft.value = text;
    void set(name, text).then(() => {
      if (draft.value === text) draft.value = null;
    });
  };
  const reset = (): void => {
    draft.value = null;
    void set(name, null);
  };
  return { draft: draft.value, change, reset };
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
  const { draft, change, reset } = useDraft(parameter.name, set);
  const { low, high } = parameter;
  const shown = draft !== null ? Number(draft) : (parameter.value ?? parameter.default);
  const text = draft ?? (shown === null ? "" : short(shown));
  return (
    <Row
      parameter={parameter}
      id={id}
      reset={parameter.given ? reset : null}
      figure={<Figure label={`${parameter.name}, as a number`} text={text} change={change} />}
    >
      <input
        id={id}
        type="range"
        min={0}
        max={1}
        step={0.001}
        value={shown === null ? 0 : position(shown, low, high)}
        aria-valuetext={shown === null ? "not given" : `${short(shown)} ${parameter.unit}`}
        data-unset={shown === null ? "" : undefined}
        onInput={(event) => change(short(value(Number(event.currentTarget.value), low, high)))}
      />
    </Row>
  );
}

/** A value as text. What isn't understood stays until it is left, beside the library's complaint. */
function Figure({ id, label, text, change, colour = false }: { id?: string; label?: string; text: string; change: (text: string) => void; colour?: boolean }): JSX.Element {
  return (
    <input
      id={id}
      type="text"
      class={colour ? "figure figure-colour" : "figure"}
      aria-label={label}
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
  const { draft, change, reset } = useDraft(parameter.name, set);
  const shown = parameter.value ?? parameter.default;
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
      figure={<Figure id={id} text={draft ?? (shown === null ? "" : colourText(shown))} change={change} colour />}
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
          <input
            type="range"
            min={0}
            max={1}
            step={0.001}
            value={position(largest, low, high)}
            aria-label={`${parameter.name}, its largest component`}
            aria-valuetext={short(largest)}
            data-unset={shown === null ? "" : undefined}
            onInput={(event) => change(scaled(value(Number(event.currentTarget.value), low, high)))}
          />
        </div>
      ) : null}
    </Row>
  );
}

function ChoiceControl({ parameter, set }: Props<"choice">): JSX.Element {
  const id = useId();
  const { draft, change, reset } = useDraft(parameter.name, set);
  const shown = draft ?? parameter.value ?? parameter.default ?? "";
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
  const { draft, change, reset } = useDraft(parameter.name, set);
  return (
    <Row parameter={parameter} id={id} reset={null}>
      <input
        id={id}
        type="text"
        class="field"
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
