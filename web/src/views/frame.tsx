/** What every view has around its drawing: its name, its controls, what it can be saved as, and a button that makes it large. */
import { effect, signal } from "@preact/signals";
import type { ComponentChildren, JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Size } from "../plot/grid";
import { hand, pngOfSvg } from "../plot/save";
import { large, type ViewName } from "../state";
import { seen } from "./live";
import "./views.css";
import "./plots.css";

/** What a view can be saved as; each is made when it is asked for. */
export interface Saves {
  svg?: () => string | null;
  png?: () => Promise<Blob> | null;
  csv?: () => string | null;
}

/** Pixels below which nothing can be drawn that could be read. */
const SMALLEST = 80;

export interface FrameProps {
  view: ViewName;
  title: string;
  /** What it shows and how it is read, one or two sentences. */
  about: string;
  controls?: ComponentChildren;
  /** Whether the controls need a row of their own where the view is narrow. */
  many?: boolean;
  saves?: Saves;
  children: (size: Size) => ComponentChildren;
}

async function save(view: ViewName, kind: keyof Saves, saves: Saves): Promise<void> {
  const nothing = new Error("nothing has been drawn yet");
  if (kind === "png") {
    const text = saves.png === undefined ? saves.svg?.() : undefined;
    const blob = await (text ? pngOfSvg(text) : saves.png?.());
    if (!blob) throw nothing;
    hand(`gonio-${view}.png`, blob);
    return;
  }
  const text = saves[kind]?.();
  if (!text) throw nothing;
  hand(`gonio-${view}.${kind}`, text, kind === "csv" ? "text/csv" : "image/svg+xml");
}

export function Frame({ view, title, about, controls, many = false, saves = {}, children }: FrameProps): JSX.Element {
  const body = useRef<HTMLDivElement>(null);
  const [size, setSize] = useState<Size>({ width: 0, height: 0 });
  const [problem, setProblem] = useState<string | null>(null);

  useEffect(() => {
    const element = body.current!;
    const onScreen = signal(false);
    const sizes = new ResizeObserver(() => setSize({ width: element.clientWidth, height: element.clientHeight }));
    const crossings = new IntersectionObserver((entries) => (onScreen.value = entries.at(-1)!.isIntersecting), { rootMargin: "100px" });
    sizes.observe(element);
    crossings.observe(element);
    const stop = effect(() => {
      seen[view].value = onScreen.value && (large.value === null || large.value === view);
    });
    return () => {
      stop();
      sizes.disconnect();
      crossings.disconnect();
      seen[view].value = false;
    };
  }, [view]);

  const isLarge = large.value === view;
  const kinds = (["svg", "png", "csv"] as const).filter((kind) => saves[kind] !== undefined || (kind === "png" && saves.svg !== undefined));
  return (
    <div
      class="view"
      onKeyDown={(event) => {
        if (event.key === "Escape" && isLarge) large.value = null;
      }}
    >
      <header class={many ? "view-head many" : "view-head"}>
        <h2>{title}</h2>
        <Menu label={`What the ${title.toLowerCase()} shows`} icon={<path d="M6 6.2a2 2 0 1 1 2.9 1.8c-.6.3-.9.7-.9 1.4v.2m0 2v.4" />}>
          <p class="view-about">{about}</p>
        </Menu>
        <div class="view-controls">{controls}</div>
        {kinds.length > 0 && (
          <Menu label={`Save the ${title.toLowerCase()}`} icon={<path d="M8 2.5v7m-3-2.8 3 3 3-3M3 13h10" />}>
            {kinds.map((kind) => (
              <button
                key={kind}
                type="button"
                class="view-item"
                onClick={(event) => {
                  event.currentTarget.closest("details")!.open = false;
                  setProblem(null);
                  save(view, kind, saves).catch((error: unknown) => setProblem(`It could not be saved: ${error instanceof Error ? error.message : String(error)}`));
                }}
              >
                {kind.toUpperCase()}
              </button>
            ))}
          </Menu>
        )}
        <button
          type="button"
          class="view-button"
          aria-label={isLarge ? `Make the ${title.toLowerCase()} small again` : `Make the ${title.toLowerCase()} large`}
          aria-pressed={isLarge}
          onClick={() => (large.value = isLarge ? null : view)}
        >
          <Icon>{isLarge ? <path d="M6.5 2.5v4h-4m11 3h-4v4m0-11v4h4m-11 3h4v4" /> : <path d="M2.5 6v-3.5H6m4 0h3.5V6m0 4v3.5H10m-4 0H2.5V10" />}</Icon>
        </button>
      </header>
      <div class="view-body" ref={body}>
        {size.width >= SMALLEST && size.height >= SMALLEST && children(size)}
        {problem !== null && (
          <p class="view-complaint" role="alert">
            {problem}
          </p>
        )}
      </div>
    </div>
  );
}

export function Icon({ children }: { children: ComponentChildren }): JSX.Element {
  return (
    <svg class="view-icon" viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
      {children}
    </svg>
  );
}

/** A button that opens a small panel, which closes with Escape and when the focus leaves it. */
function Menu({ label, icon, children }: { label: string; icon: ComponentChildren; children: ComponentChildren }): JSX.Element {
  return (
    <details
      class="view-menu"
      onFocusOut={(event) => {
        const to = event.relatedTarget as Node | null;
        if (to === null || !event.currentTarget.contains(to)) event.currentTarget.open = false;
      }}
      onKeyDown={(event) => {
        if (event.key !== "Escape" || !event.currentTarget.open) return;
        event.stopPropagation();
        event.currentTarget.open = false;
        event.currentTarget.querySelector("summary")!.focus();
      }}
    >
      <summary class="view-button" aria-label={label}>
        <Icon>{icon}</Icon>
      </summary>
      <div class="view-panel" tabIndex={-1}>
        {children}
      </div>
    </details>
  );
}

/** What the library says of what it could not draw; nothing where there is no complaint. */
export function Complaints({ of }: { of: { colour: number; message: string; help: string | null }[] }): JSX.Element | null {
  if (of.length === 0) return null;
  return (
    <div class="view-complaints" role="status">
      {of.map((c) => (
        <p key={c.colour} class={`series-${c.colour}`}>
          <span class="view-dot" />
          <span>
            {c.message}
            {c.help !== null && ` – ${c.help}`}
          </span>
        </p>
      ))}
    </div>
  );
}
