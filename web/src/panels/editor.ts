/**
 * The text editor for shaders: CodeMirror, loaded when a shader is first opened. It lives in a shadow tree, where its styles are constructed sheets that the
 * content-security policy allows; `style` elements are not.
 */
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, HighlightStyle, indentUnit, StreamLanguage, type StringStream, syntaxHighlighting } from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { EditorState } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Complaint } from "../engine/protocol";

const KEYWORDS = new Set(
  "fn let var const override struct return if else for while loop break continue switch case default discard true false in out inout uniform void analytic ::begin ::end parameters shader".split(" "),
);
const TYPES = /^(f16|f32|i32|u32|bool|float|int|uint|color|(vec|mat)\d(x\d)?[fiuh]?|[biu]?vec\d|array|ptr)$/;

/** Enough of WGSL, GLSL and `.brdf` to colour them; what is right is the library's to say. */
const shaders = StreamLanguage.define<{ comment: boolean }>({
  startState: () => ({ comment: false }),
  token(stream: StringStream, state: { comment: boolean }): string | null {
    if (state.comment) {
      if (stream.skipTo("*/")) {
        stream.match("*/");
        state.comment = false;
      } else stream.skipToEnd();
      return "comment";
    }
    if (stream.eatSpace()) return null;
    if (stream.match("//")) {
      stream.skipToEnd();
      return "comment";
    }
    if (stream.match("/*")) {
      state.comment = true;
      return "comment";
    }
    if (stream.match(/^#\w+/) || stream.match(/^@\w+/)) return "meta";
    if (stream.match(/^(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?[fhiu]?/)) return "number";
    const word = stream.match(/^(::)?[A-Za-z_]\w*/) as RegExpMatchArray | null;
    if (word !== null) {
      if (KEYWORDS.has(word[0])) return "keyword";
      if (TYPES.test(word[0])) return "typeName";
      return stream.match(/^\s*\(/, false) ? "propertyName" : "variableName";
    }
    stream.next();
    return null;
  },
  languageData: { commentTokens: { line: "//", block: { open: "/*", close: "*/" } } },
});

const colours = HighlightStyle.define([
  { tag: tags.comment, color: "var(--ink-3)", fontStyle: "italic" },
  { tag: tags.keyword, color: "var(--series-5)" },
  { tag: tags.typeName, color: "var(--series-2)" },
  { tag: tags.number, color: "var(--series-1)" },
  { tag: tags.propertyName, color: "var(--series-0)" },
  { tag: tags.meta, color: "var(--series-4)" },
]);

const look = EditorView.theme({
  "&": { flex: "1", minHeight: "0", fontSize: "12px", color: "var(--ink)", backgroundColor: "var(--sunken)" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.5", overflow: "auto" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  ".cm-gutters": { backgroundColor: "var(--sunken)", color: "var(--ink-3)", border: "none" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--accent) 7%, transparent)" },
  "&.cm-focused": { outline: "none" },
  "&.cm-focused .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "var(--accent-soft) !important" },
  ".cm-tooltip": { backgroundColor: "var(--raised)", color: "var(--ink)", border: "1px solid var(--line)", maxWidth: "36em" },
  ".cm-diagnostic-error": { borderLeftColor: "var(--bad)" },
});

export interface Editor {
  /** Shows the library's error at its place, or none. */
  mark(complaint: Complaint | null): void;
  text(): string;
  destroy(): void;
}

export function createEditor(host: HTMLElement, text: string, label: string, changed: (text: string) => void): Editor {
  const root = host.shadowRoot ?? host.attachShadow({ mode: "open" });
  const view = new EditorView({
    parent: root,
    root,
    state: EditorState.create({
      doc: text,
      extensions: [
        lineNumbers(),
        lintGutter(),
        history(),
        drawSelection(),
        bracketMatching(),
        highlightActiveLine(),
        indentUnit.of("    "),
        shaders,
        syntaxHighlighting(colours),
        look,
        // Tab indents; Escape and then Tab leaves, as CodeMirror's keymap has it.
        keymap.of([...defaultKeymap, ...historyKeymap, indentWithTab]),
        EditorView.contentAttributes.of({ "aria-label": label, tabindex: "0" }),
        EditorView.updateListener.of((update) => {
          if (update.docChanged) changed(update.state.doc.toString());
        }),
      ],
    }),
  });
  return {
    mark(complaint) {
      const found: Diagnostic[] = [];
      if (complaint !== null && complaint.place !== null) {
        const line = view.state.doc.line(Math.min(Math.max(complaint.place.line, 1), view.state.doc.lines));
        const from = Math.min(line.from + Math.max(complaint.place.column - 1, 0), line.to);
        const word = /^\w+/.exec(view.state.doc.sliceString(from, line.to))?.[0].length ?? 1;
        found.push({ from, to: Math.min(from + word, line.to), severity: "error", message: complaint.message });
      }
      view.dispatch(setDiagnostics(view.state, found));
    },
    text: () => view.state.doc.toString(),
    destroy: () => view.destroy(),
  };
}
