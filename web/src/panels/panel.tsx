/** The panel beside the views: the functions, and all about the one that is selected. */
import { computed } from "@preact/signals";
import type { JSX } from "preact";
import { useCallback } from "preact/hooks";
import { aliases } from "../catalogue";
import { filesIn, shortName } from "../core/text";
import { held } from "../files";
import { dismiss, setText, setValues } from "../functions";
import { current, type Shown } from "../state";
import { Declarations, type Editing, Parameters, PresetButton, TextEditor } from "./description";
import { FileFacts } from "./file-facts";
import { FunctionList } from "./list";
import type { Set } from "./parameter";
import { ShaderEditor } from "./shader";
import { type Tab, tab } from "./tab";
import { Hint, Problem } from "./ui";
import { Verdicts } from "./verdicts";

/** The file of the selected function that can be edited. */
const shader = computed(() => {
  const shown = current.value;
  return shown === null ? undefined : held.value.find((file) => file.source !== null && filesIn(shown.text).includes(file.name));
});

/** What the panel shows of the selected function: the source of what has none is its parameters. */
export const openTab = computed<Tab>(() => (tab.value === "source" && shader.value === undefined ? "parameters" : tab.value));

export function Panel(): JSX.Element {
  const shown = current.value;
  return (
    <section class="panel" id="panel" aria-label="Functions and parameters">
      <FunctionList />
      {shown !== null ? <Selected key={shown.id} shown={shown} /> : null}
    </section>
  );
}

function Selected({ shown }: { shown: Shown }): JSX.Element {
  const tabs: { id: Tab; name: string }[] = [
    { id: "parameters", name: "Parameters" },
    ...(shader.value !== undefined ? [{ id: "source" as const, name: "Source" }] : []),
    { id: "verdicts", name: "Verdicts" },
  ];
  const open = openTab.value;
  const keys = (event: KeyboardEvent): void => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const next = tabs[(tabs.findIndex((t) => t.id === open) + step + tabs.length) % tabs.length]!;
    tab.value = next.id;
    document.getElementById(`tab-${next.id}`)?.focus();
  };
  return (
    <section class="selected" data-open={open} data-colour={shown.colour} aria-label={`Selected: ${shortName(shown.preset ?? shown.text, aliases.value)[0]}`}>
      <div class="tabs" role="tablist" aria-label="About the selected function" onKeyDown={keys}>
        {tabs.map((t) => (
          <button
            key={t.id}
            id={`tab-${t.id}`}
            type="button"
            role="tab"
            class="tab"
            aria-selected={open === t.id}
            aria-controls="tab-panel"
            tabIndex={open === t.id ? 0 : -1}
            onClick={() => (tab.value = t.id)}
          >
            {t.name}
          </button>
        ))}
      </div>
      <div class="tab-panel" id="tab-panel" role="tabpanel" aria-labelledby={`tab-${open}`}>
        {open === "parameters" ? <ParametersTab shown={shown} /> : null}
        {open === "source" && shader.value !== undefined ? <ShaderEditor key={shader.value.name} file={shader.value} complaint={shown.complaint} /> : null}
        {open === "verdicts" ? <Verdicts shown={shown} /> : null}
      </div>
    </section>
  );
}

function ParametersTab({ shown }: { shown: Shown }): JSX.Element {
  const { description } = shown;
  const measured = held.value.filter((file) => file.kind === "measured" && filesIn(shown.text).includes(file.name));
  // The same one as long as it can be, so that controls whose parameter is as before stay as they are.
  const set = useCallback<Set>((name, text) => setValues(shown.id, { [name]: text }), [shown.id]);
  const editing: Editing = {
    key: String(shown.id),
    text: shown.text,
    description,
    change: (text) => setText(shown.id, text),
    set,
  };
  return (
    <>
      <TextEditor editing={editing} label="Description of the function" />
      {shown.complaint !== null ? <Problem complaint={shown.complaint} onDismiss={() => dismiss(shown.id)} /> : null}
      {description !== null ? (
        <div class="about">
          <div class="about-head">
            <p class="about-summary">{description.summary}</p>
            {description.paper !== "" ? (
              <Hint about="where it was published">
                {description.paper}
              </Hint>
            ) : null}
          </div>
          <Declarations description={description} />
          {description.warnings.map((warning) => (
            <p class="note" key={warning}>
              {warning}
            </p>
          ))}
          <div class="actions">
            <PresetButton description={description} pick={(text) => void setText(shown.id, text)} />
          </div>
        </div>
      ) : null}
      {measured.map((file) => (
        <FileFacts key={file.name} name={file.name} />
      ))}
      <Parameters editing={editing} />
    </>
  );
}
