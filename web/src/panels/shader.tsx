/** A shader's text beside what it draws: every change is tried, and what works replaces what is shown. */
import { useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Complaint } from "../engine/protocol";
import { editShader, type Held, sourceOf } from "../files";
import type { Editor } from "./editor";
import { hand } from "../plot/save";
import { Icon, Problem } from "./ui";

export function ShaderEditor({ file, complaint }: { file: Held; complaint: Complaint | null }): JSX.Element {
  const { name } = file;
  const host = useRef<HTMLDivElement>(null);
  const editor = useRef<Editor | null>(null);
  const loading = useSignal(true);
  // A shader that never worked has no draft: then the function's own complaint is about this text.
  const problem = file.problem ?? complaint;
  const latest = useRef(problem);
  latest.current = problem;
  useEffect(() => editor.current?.mark(problem), [problem]);

  useEffect(() => {
    let gone = false;
    let timer = 0;
    void import("./editor").then(({ createEditor }) => {
      if (gone || host.current === null) return;
      loading.value = false;
      editor.current = createEditor(host.current, sourceOf(name) ?? "", `Source of ${name}`, (text) => {
        clearTimeout(timer);
        timer = setTimeout(() => void editShader(name, text), 60);
      });
      editor.current.mark(latest.current);
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
        <button type="button" class="button" onClick={() => hand(name, editor.current?.text() ?? sourceOf(name) ?? "")}>
          <Icon name="take" />
          Save {name}
        </button>
      </div>
    </div>
  );
}
