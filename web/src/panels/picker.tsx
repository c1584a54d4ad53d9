/** Choosing from the registry: models, aliases and presets, with a search. */
import { signal, useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import { catalogue } from "../catalogue";
import { choices, search } from "../core/search";
import { Dialog } from "./ui";

export interface Picking {
  title: string;
  /** Only this model's presets. */
  model: string | null;
  onPick: (text: string) => void;
}

export const picker = signal<Picking | null>(null);

const MOST = 120;
/** Apart, since the types know this role only beside a `datalist`. */
const COMBOBOX: object = { role: "combobox" };

export function Picker(): JSX.Element | null {
  const now = picker.value;
  return now === null ? null : <Open key={now.title} picking={now} />;
}

function Open({ picking }: { picking: Picking }): JSX.Element {
  const query = useSignal("");
  const active = useSignal(0);
  const list = useRef<HTMLUListElement>(null);
  const input = useRef<HTMLInputElement>(null);
  const all = useMemo(() => (catalogue.value === null ? [] : choices(catalogue.value, picking.model)), [catalogue.value, picking.model]);
  const found = search(all, query.value, picking.model !== null);
  const shown = found.slice(0, MOST);
  const at = Math.min(active.value, shown.length - 1);
  const close = (): void => void (picker.value = null);
  const pick = (index: number): void => {
    const choice = shown[index];
    if (choice === undefined) return;
    close();
    picking.onPick(choice.text);
  };
  useEffect(() => input.current?.focus(), []);
  useEffect(() => list.current?.children[at]?.scrollIntoView({ block: "nearest" }), [at]);
  const move = (event: KeyboardEvent): void => {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 }[event.key];
    if (step !== undefined) active.value = Math.min(Math.max(at + step, 0), shown.length - 1);
    else if (event.key === "Enter") pick(at);
    else return;
    event.preventDefault();
  };
  return (
    <Dialog title={picking.title} onClose={close}>
      <input
        ref={input}
        type="text"
        class="field picker-search"
        {...COMBOBOX}
        aria-label="Search models, aliases and presets"
        aria-expanded="true"
        aria-controls="picker-list"
        aria-activedescendant={at >= 0 ? `picker-${at}` : undefined}
        aria-autocomplete="list"
        placeholder={picking.model === null ? "Search: ggx, diffuse, gold, 2012 …" : "Search the presets"}
        autocomplete="off"
        spellcheck={false}
        value={query.value}
        onInput={(event) => {
          query.value = event.currentTarget.value;
          active.value = 0;
        }}
        onKeyDown={move}
      />
      <ul ref={list} id="picker-list" class="picker-list" role="listbox" aria-label="Found">
        {shown.map((choice, index) => (
          <li
            key={choice.name}
            id={`picker-${index}`}
            role="option"
            aria-selected={index === at}
            class={`picker-item ${index === at ? "picker-active" : ""}`}
            onClick={() => pick(index)}
            onPointerMove={() => (active.value = index)}
          >
            <span class="picker-name">{choice.name}</span>
            <span class="picker-kind">{choice.kind === "model" ? "" : choice.kind}</span>
            {choice.summary !== "" ? <span class="picker-summary">{choice.summary}</span> : null}
          </li>
        ))}
      </ul>
      <p class="quiet picker-count" role="status">
        {catalogue.value === null
          ? "The registry is loading."
          : found.length === 0
            ? "Nothing has these words. Measured files and shaders are opened with “Open file”."
            : found.length > shown.length
              ? `The first ${shown.length} of ${found.length}: more letters narrow it down.`
              : `${found.length} found${query.value === "" && picking.model === null ? "; type to search the presets too" : ""}.`}
      </p>
    </Dialog>
  );
}
