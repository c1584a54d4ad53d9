/** Small pieces that every panel is made of. */
import { useSignal } from "@preact/signals";
import type { ButtonHTMLAttributes, ComponentChildren, JSX } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import type { Complaint } from "../engine/protocol";
import { say } from "../notices";

/** Line icons on a grid of 16, drawn in the text's colour. */
const ICONS = {
  add: "M8 3v10M3 8h10",
  remove: "M4 4l8 8M12 4l-8 8",
  copy: "M6 5.5V3.5h6.5V10h-2M3.5 6H10v6.5H3.5z",
  eye: "M1.5 8c3-5.3 10-5.3 13 0-3 5.3-10 5.3-13 0zM8 10a2 2 0 1 0 0-4 2 2 0 0 0 0 4z",
  hidden: "M2.5 2.5l11 11M4 5.2C3 6 2.2 6.9 1.5 8c2 3.5 5.7 4.7 8.9 3.5M6.8 4.1C9.7 3.6 12.8 5 14.5 8c-.5.8-1 1.5-1.7 2",
  reset: "M3.5 6.5A5 5 0 1 1 3.2 9M3.5 3v3.5H7",
  open: "M2.5 12.5v-9H6L7.5 5h6v7.5z",
  share: "M6.5 9.5l3-3M7 5l1.5-1.5a2.8 2.8 0 0 1 4 4L11 9M9 11l-1.5 1.5a2.8 2.8 0 0 1-4-4L5 7",
  take: "M8 2.5v7.5M5 7.5L8 10.5l3-3M3 13.5h10",
  theme: "M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11",
  help: "M6 6a2 2 0 1 1 2.8 1.8c-.6.3-.8.7-.8 1.4M8 11.6v.1",
  down: "M4 6.5l4 4 4-4",
  check: "M3.5 8.5l3 3 6-7",
  cross: "M4 4l8 8M12 4l-8 8",
  dot: "M8 7.5v1",
  go: "M5.5 3.5L10 8l-4.5 4.5",
} as const;
export type IconName = keyof typeof ICONS;

export function Icon({ name }: { name: IconName }): JSX.Element {
  return (
    <svg class="icon" viewBox="0 0 16 16" aria-hidden="true" focusable="false">
      <path d={ICONS[name]} />
    </svg>
  );
}

type ButtonProps = Omit<ButtonHTMLAttributes<HTMLButtonElement>, "label"> & { icon: IconName; label: string };

/** A button that is an icon; its label is read aloud and shown when the pointer rests on it. */
export function IconButton({ icon, label, ...rest }: ButtonProps): JSX.Element {
  return (
    <button type="button" class="icon-button" aria-label={label} title={label} {...rest}>
      <Icon name={icon} />
    </button>
  );
}

/** The library's error, as it is. */
export function Problem({ complaint, subject, onDismiss }: { complaint: Complaint; subject?: string | null; onDismiss?: () => void }): JSX.Element {
  const { place } = complaint;
  // People know the file by its name, not by the engine's folder.
  const message = complaint.message.replace(/\bfiles\//g, "");
  const hasPlace = place === null || message.includes(`${place.line}:${place.column}`);
  return (
    <div class="problem" role="alert">
      <div>
        {subject ? <strong>{subject}: </strong> : null}
        {message}
        {hasPlace ? null : ` (line ${place.line}, column ${place.column})`}
        {complaint.help !== null ? <div class="problem-help">{complaint.help}</div> : null}
      </div>
      {onDismiss ? <IconButton icon="remove" label="Dismiss" onClick={onDismiss} /> : null}
    </div>
  );
}

/** “What is this?”: a button that unfolds a few words under it. */
export function Hint({ about, children }: { about: string; children: ComponentChildren }): JSX.Element {
  const open = useSignal(false);
  const id = useId();
  return (
    <>
      <button
        type="button"
        class="icon-button hint-button"
        aria-label={`What is this: ${about}`}
        title="What is this?"
        aria-expanded={open.value}
        aria-controls={id}
        onClick={() => (open.value = !open.value)}
      >
        <Icon name="help" />
      </button>
      <div class="hint" id={id} hidden={!open.value}>
        {children}
      </div>
    </>
  );
}

async function copy(text: string, what: string): Promise<void> {
  await navigator.clipboard.writeText(text);
  say(`${what} copied`);
}

/** Text to take away: shown, and copied by a button. */
export function Copyable({ label, text }: { label: string; text: string }): JSX.Element {
  const rows = text.trimEnd().split("\n").reduce((sum, line) => sum + Math.max(1, Math.ceil(line.length / 84)), 0);
  const field = useRef<HTMLTextAreaElement>(null);
  const id = useId();
  const copyIt = (): void => {
    copy(text, label).catch(() => {
      // Without the permission the text is at least selected.
      field.current?.focus();
      field.current?.select();
    });
  };
  return (
    <div class="copyable">
      <label class="copyable-label" for={id}>
        {label}
      </label>
      <div class="copyable-row">
        <textarea ref={field} id={id} class="code" readOnly rows={Math.min(12, rows)} value={text.trimEnd()} spellcheck={false} />
        <button type="button" class="button" onClick={copyIt} aria-label={`Copy: ${label}`}>
          <Icon name="copy" />
          Copy
        </button>
      </div>
    </div>
  );
}

/** A modal dialog; Escape, the button and a click outside close it, and the focus returns to where it was. */
export function Dialog({ title, onClose, children, wide = false }: { title: string; onClose: () => void; children: ComponentChildren; wide?: boolean }): JSX.Element {
  const dialog = useRef<HTMLDialogElement>(null);
  const id = useId();
  useEffect(() => {
    const before = document.activeElement;
    const element = dialog.current;
    element?.showModal();
    return () => {
      element?.close();
      if (before instanceof HTMLElement) before.focus();
    };
  }, []);
  return (
    <dialog
      ref={dialog}
      class={wide ? "dialog dialog-wide" : "dialog"}
      aria-labelledby={id}
      onCancel={(event) => {
        event.preventDefault();
        onClose();
      }}
      onPointerDown={(event) => {
        if (event.target === dialog.current) onClose();
      }}
    >
      <div class="dialog-body">
        <header class="dialog-head">
          <h2 id={id}>{title}</h2>
          <IconButton icon="remove" label="Close" onClick={onClose} />
        </header>
        {children}
      </div>
    </dialog>
  );
}
