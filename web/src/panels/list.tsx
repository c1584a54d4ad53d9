/** The functions that are shown: the legend of every view. */
import type { JSX } from "preact";
import { useRef } from "preact/hooks";
import { aliases } from "../catalogue";
import { filesIn, shortName } from "../core/text";
import { held, missing, take } from "../files";
import { add, duplicate, MOST, remove, setVisible } from "../functions";
import { functions, selected, type Shown } from "../state";
import { picker } from "./picker";
import { newShader } from "./shader-new";
import { Icon, IconButton } from "./ui";

function Row({ shown }: { shown: Shown }): JSX.Element {
  const [name, rest] = shortName(shown.preset ?? shown.text, aliases.value);
  const isSelected = selected.value === shown.id;
  const isWrong = shown.complaint !== null || held.value.some((file) => file.problem !== null && filesIn(shown.text).includes(file.name));
  return (
    <li class={`function ${isSelected ? "function-selected" : ""} ${shown.visible ? "" : "function-hidden"}`} data-colour={shown.colour}>
      <button
        type="button"
        class="function-key"
        aria-label={`Show ${name}`}
        aria-pressed={shown.visible}
        title={shown.visible ? "Hide in the views" : "Show in the views"}
        onClick={() => setVisible(shown.id, !shown.visible)}
      >
        <span class="key" />
      </button>
      <button type="button" class="function-name" aria-current={isSelected ? "true" : undefined} title={shown.text} onClick={() => (selected.value = shown.id)}>
        <span class="function-model">{name}</span>
        <span class="function-rest">{rest}</span>
        {isWrong ? <span class="function-flag">error</span> : null}
      </button>
      <IconButton icon="copy" label={`Duplicate ${name}`} disabled={functions.value.length >= MOST} onClick={() => duplicate(shown.id)} />
      <IconButton icon="remove" label={`Remove ${name}`} onClick={() => remove(shown.id)} />
    </li>
  );
}

export function FunctionList(): JSX.Element {
  const chooser = useRef<HTMLInputElement>(null);
  const full = functions.value.length >= MOST;
  return (
    <section class="functions" aria-labelledby="functions-title">
      <h2 id="functions-title" class="panel-title">
        Functions
      </h2>
      {functions.value.length === 0 ? <p class="empty">Nothing is shown. Add a function, or drop a file anywhere.</p> : null}
      <ul class="function-list">
        {functions.value.map((shown) => (
          <Row key={shown.id} shown={shown} />
        ))}
      </ul>
      {missing.value.length > 0 ? (
        <p class="note" role="status">
          This link was made with {missing.value.join(", ")}, which a link can't hold. Open the file, and what needs it is shown.
        </p>
      ) : null}
      <div class="actions">
        <button type="button" class="button button-first" disabled={full} onClick={() => (picker.value = { title: "Add a function", model: null, onPick: add })}>
          <Icon name="add" />
          Add
        </button>
        <button type="button" class="button" onClick={() => chooser.current?.click()}>
          <Icon name="open" />
          Open file
        </button>
        <button type="button" class="button" disabled={full} onClick={() => (newShader.value = true)}>
          New shader
        </button>
        <input
          ref={chooser}
          type="file"
          multiple
          hidden
          aria-label="Measured files, shaders and panoramas"
          onChange={(event) => {
            const files = [...(event.currentTarget.files ?? [])];
            event.currentTarget.value = "";
            void take(files);
          }}
        />
      </div>
      {full ? <p class="quiet">{MOST} functions are shown: as many as colours that can be told apart.</p> : null}
    </section>
  );
}

/** The functions as a strip above the views, on screens that have no room for the panel beside them. */
export function Legend(): JSX.Element {
  return (
    <ul class="legend" aria-label="Functions">
      {functions.value.map((shown) => {
        const [name, rest] = shortName(shown.preset ?? shown.text, aliases.value);
        return (
          <li key={shown.id} data-colour={shown.colour}>
            <button type="button" aria-pressed={shown.visible} title={`${name} ${rest}`} onClick={() => setVisible(shown.id, !shown.visible)}>
              <span class="key" />
              {name}
            </button>
          </li>
        );
      })}
    </ul>
  );
}
