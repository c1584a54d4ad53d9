/** A description, edited: its text, its parameters, and those of the parts of a composite, to any depth. */
import { useSignal } from "@preact/signals";
import type { ComponentChildren, JSX } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import { aliases, catalogue } from "../catalogue";
import { addPart, composite, removePart, replacePart, shortName } from "../core/text";
import { engine } from "../engine/client";
import type { Complaint, Description } from "../engine/protocol";
import { complaintOf } from "../functions";
import { ParameterControl, type Set } from "./parameter";
import { picker } from "./picker";
import { Hint, Icon, IconButton, Problem } from "./ui";

export interface Editing {
  /** Names the engine's requests of this description. */
  key: string;
  text: string;
  description: Description | null;
  /** Another text. */
  change: (text: string) => Promise<boolean | null>;
  set: Set;
}

/** The text as it is being written stays until it is left, even where it isn't understood yet. */
export function TextEditor({ editing, label }: { editing: Editing; label: string }): JSX.Element {
  const draft = useSignal<string | null>(null);
  const field = useRef<HTMLTextAreaElement>(null);
  const id = useId();
  // Once the function was changed in another way, what was left here unfinished would hide it.
  useEffect(() => {
    if (document.activeElement !== field.current) draft.value = null;
  }, [editing.text]);
  return (
    <div class="description-text">
      <label class="hidden" for={id}>
        {label}
      </label>
      <textarea
        ref={field}
        id={id}
        class="code"
        rows={Math.min(6, 1 + Math.floor(editing.text.length / 40))}
        spellcheck={false}
        autocapitalize="off"
        value={draft.value ?? editing.text}
        onInput={(event) => {
          // A description is one line.
          draft.value = event.currentTarget.value.replace(/\s*\n\s*/g, " ");
          void editing.change(draft.value.trim());
        }}
        onBlur={() => {
          const left = draft.value;
          if (left === null) return;
          void editing.change(left.trim()).then((understood) => {
            if (understood && draft.value === left) draft.value = null;
          });
        }}
      />
    </div>
  );
}

const MANY = 14;

export function Parameters({ editing }: { editing: Editing }): JSX.Element | null {
  const filter = useSignal("");
  const { description } = editing;
  if (description === null) return null;
  const own = description.parameters.filter((p) => p.kind !== "models");
  const words = filter.value.toLowerCase().trim();
  const shown = own.filter((p) => words === "" || p.name.includes(words) || p.meaning.toLowerCase().includes(words));
  return (
    <>
      {own.length > MANY ? (
        <input
          type="search"
          class="field"
          aria-label={`Search ${own.length} parameters`}
          placeholder={`Search ${own.length} parameters`}
          value={filter.value}
          onInput={(event) => (filter.value = event.currentTarget.value)}
        />
      ) : null}
      <div class="parameters">
        {shown.map((parameter) => (
          <ParameterControl key={parameter.name} parameter={parameter} set={editing.set} />
        ))}
      </div>
      {own.length > 0 && shown.length === 0 ? <p class="empty">No parameter has these letters.</p> : null}
      <Parts editing={editing} />
    </>
  );
}

/** Where presets are published for the model. */
export function PresetButton({ description, pick }: { description: Description; pick: (text: string) => void }): JSX.Element | null {
  const entry = catalogue.value?.models.find((model) => model.name === description.model);
  if (entry === undefined || entry.presets.length === 0) return null;
  return (
    <button type="button" class="button" onClick={() => (picker.value = { title: `Presets of ${entry.name}`, model: entry.name, onPick: pick })}>
      {entry.presets.length} presets
    </button>
  );
}

function Parts({ editing }: { editing: Editing }): JSX.Element | null {
  const whole = composite(editing.text);
  if (whole === null) return null;
  return (
    <div class="parts">
      {whole.parts.map((part, index) => (
        <PartEditor
          key={index}
          editorKey={`${editing.key}/${index}`}
          text={part.text}
          number={index + 1}
          change={(text) => editing.change(replacePart(editing.text, index, text))}
          remove={whole.name === "sum" && whole.parts.length > 1 ? () => void editing.change(removePart(editing.text, index)) : null}
        />
      ))}
      {whole.name === "sum" ? (
        <button type="button" class="button" onClick={() => (picker.value = { title: "Add to the sum", model: null, onPick: (text) => void editing.change(addPart(editing.text, text)) })}>
          <Icon name="add" />
          Add a part
        </button>
      ) : null}
    </div>
  );
}

interface PartProps {
  editorKey: string;
  text: string;
  number: number;
  change: (text: string) => Promise<boolean | null>;
  remove: (() => void) | null;
}

function PartEditor({ editorKey, text, number, change, remove }: PartProps): JSX.Element {
  const description = useSignal<Description | null>(null);
  const problem = useSignal<Complaint | null>(null);
  const values = useRef<Record<string, string | null>>({});
  useEffect(() => {
    engine
      .ask("describe", { function: text }, { pool: "fast", key: `part:${editorKey}` })
      .then((reply) => {
        if (reply === null) return;
        description.value = reply.answer;
        problem.value = null;
      })
      .catch((error: unknown) => (problem.value = complaintOf(error)));
  }, [text, editorKey]);
  const set: Set = async (name, value) => {
    values.current = { ...values.current, [name]: value };
    const asked = values.current;
    try {
      const reply = await engine.ask("set", { function: text, values: asked }, { pool: "fast", key: `set-part:${editorKey}` });
      if (reply === null) return null;
      problem.value = null;
      return await change(reply.answer.text);
    } catch (error) {
      problem.value = complaintOf(error);
      return false;
    } finally {
      if (values.current === asked) values.current = {};
    }
  };
  const editing: Editing = { key: editorKey, text, description: description.value, change, set };
  return (
    <details class="part" open>
      <summary>
        <span class="part-number">{number}</span>
        <span class="part-name">{shortName(description.value?.text ?? text, aliases.value)[0]}</span>
      </summary>
      <div class="part-body">
        <div class="actions">
          <button type="button" class="button" onClick={() => (picker.value = { title: `Part ${number} becomes`, model: null, onPick: (chosen) => void change(chosen) })}>
            Replace
          </button>
          {description.value !== null ? <PresetButton description={description.value} pick={(chosen) => void change(chosen)} /> : null}
          <span class="spring" />
          {remove !== null ? <IconButton icon="remove" label={`Remove part ${number}`} onClick={remove} /> : null}
        </div>
        {problem.value !== null ? <Problem complaint={problem.value} /> : null}
        <Parameters editing={editing} />
      </div>
    </details>
  );
}

/** What the library declares of the function. */
export function Declarations({ description }: { description: Description }): JSX.Element {
  const { declares } = description;
  const words: [boolean, string, string][] = [
    [declares.reciprocal, "reciprocal", "not reciprocal"],
    [declares.energy_conserving, "conserves energy", "may gain energy"],
    [declares.isotropic, "isotropic", "anisotropic"],
  ];
  return (
    <div class="declares">
      <ul class="badges" aria-label="Declared properties">
        {words.map(([holds, yes, no]) => (
          <li key={yes} class={`badge ${holds ? "" : "badge-no"}`}>
            {holds ? yes : no}
          </li>
        ))}
        {description.transmits ? <li class="badge">transmits</li> : null}
        {description.delta ? <li class="badge">Dirac delta</li> : null}
      </ul>
      <Hint about="declared properties">
        What the model's author declares for these parameters. The verdicts test it: a declaration that doesn't hold fails with a pair of directions as its witness.
      </Hint>
    </div>
  );
}

export function Section({ title, hint, children }: { title: string; hint?: string; children: ComponentChildren }): JSX.Element {
  return (
    <section class="section">
      <div class="section-head">
        <h3>{title}</h3>
        {hint !== undefined ? <Hint about={title}>{hint}</Hint> : null}
      </div>
      {children}
    </section>
  );
}
