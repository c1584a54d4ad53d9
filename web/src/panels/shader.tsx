/** A shader's text beside what it draws: every change is tried, and what works replaces what is shown. */
import { useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Complaint } from "../engine/protocol";
import { editShader, sourceOf } from "../files";
import type { Editor } from "./editor";
import { Icon, Problem, save } from "./ui";

export function ShaderEditor({ name, complaint }: { name: string; complaint: Complaint | null }): JSX.Element {
  const host = useRef<HTMLDivElement>(null);
  const editor = useRef<Editor | null>(null);
  /** Of the text as it is in the editor; undefined before it was edited: then the function's own complaint is about this text. */
  const edited = useSignal<Complaint | null | undefined>(undefined);
  const problem = edited.value === undefined ? complaint : edited.value;
  const loading = useSignal(true);
  const shownProblem = useRef(problem);
  shownProblem.current = problem;
  useEffect(() => editor.current?.mark(problem), [problem]);

  useEffect(() => {
    let gone = false;
    let timer = 0;
    const tried = async (text: string): Promise<void> => {
      const found = await editShader(name, text);
      if (gone || found === undefined) return;
      edited.value = found;
    };
    void import("./editor").then(({ createEditor }) => {
      if (gone || host.current === null) return;
      loading.value = false;
      editor.current = createEditor(host.current, sourceOf(name) ?? "", `Source of ${name}`, (text) => {
        clearTimeout(timer);
        timer = setTimeout(() => void tried(text), 60);
      });
      editor.current.mark(shownProblem.current);
    });
    return () => {
      gone = true;
      clearTimeout(timer);
      // What was typed last is not lost with the editor.
      const last = editor.current?.text();
      if (last !== undefined && last !== sourceOf(name)) void editShader(name, last);
      editor.current?.destroy();
      editor.current = null;
    };
  }, [name]);

  return (
    <div class="shader">
      <div ref={host} class="shader-host" data-loading={loading.value ? "" : undefined} />
      <div class="shader-foot" aria-live="polite">
        {problem !== null ? <Problem complaint={problem} /> : <p class="quiet">Drawn while you type. Tab indents; Escape, then Tab, leaves the editor.</p>}
        <button type="button" class="button" onClick={() => save(name, editor.current?.text() ?? sourceOf(name) ?? "", "text/plain")}>
          <Icon name="take" />
          Save {name}
        </button>
      </div>
    </div>
  );
}
