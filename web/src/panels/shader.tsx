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
  const problem = useSignal<Complaint | null>(complaint);
  const loading = useSignal(true);

  useEffect(() => {
    let gone = false;
    let timer = 0;
    const tried = async (text: string): Promise<void> => {
      const found = await editShader(name, text);
      if (gone || found === undefined) return;
      problem.value = found;
      editor.current?.mark(found);
    };
    void import("./editor").then(({ createEditor }) => {
      if (gone || host.current === null) return;
      loading.value = false;
      editor.current = createEditor(host.current, sourceOf(name) ?? "", `Source of ${name}`, (text) => {
        clearTimeout(timer);
        timer = setTimeout(() => void tried(text), 60);
      });
      editor.current.mark(problem.value);
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
        {problem.value !== null ? <Problem complaint={problem.value} /> : <p class="quiet">Drawn while you type. Tab indents; Escape, then Tab, leaves the editor.</p>}
        <button type="button" class="button" onClick={() => save(name, editor.current?.text() ?? sourceOf(name) ?? "", "text/plain")}>
          <Icon name="take" />
          Save {name}
        </button>
      </div>
    </div>
  );
}
