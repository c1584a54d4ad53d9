/** The bar above everything: where one is, and what concerns the whole page. */
import { computed, effect, signal } from "@preact/signals";
import type { JSX } from "preact";
import { busy } from "../engine/client";
import { complain, dismissNotice, notices, say } from "../notices";
import { permanentLink } from "../persist";
import { route } from "../route";
import { helping } from "./help";
import { taking } from "./take";
import { Icon, IconButton, Problem } from "./ui";

type Theme = "auto" | "light" | "dark";
const THEMES: readonly Theme[] = ["auto", "light", "dark"];

function stored(): Theme {
  try {
    const found = localStorage.getItem("theme");
    return THEMES.find((theme) => theme === found) ?? "auto";
  } catch {
    return "auto";
  }
}

const theme = signal<Theme>(stored());

effect(() => {
  if (theme.value === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme.value;
});

function nextTheme(): void {
  theme.value = THEMES[(THEMES.indexOf(theme.value) + 1) % THEMES.length]!;
  try {
    localStorage.setItem("theme", theme.value);
  } catch {
    // Where storage is refused the choice holds for this visit.
  }
}

function copyLink(): void {
  const made = permanentLink();
  const text = made.then(({ address }) => new Blob([address], { type: "text/plain" }));
  // The text may come later, but Safari takes only what is offered within the click.
  const copied =
    typeof ClipboardItem === "function" ? navigator.clipboard.write([new ClipboardItem({ "text/plain": text })]) : made.then(({ address }) => navigator.clipboard.writeText(address));
  copied
    .then(async () => {
      say("Permanent link copied");
      const { needs } = await made;
      if (needs.length > 0) complain({ message: `the link names ${needs.join(", ")}, which a link can't hold`, help: "send the file along: the page asks for it", place: null });
    })
    // Without the permission the address is shown, to be copied by hand.
    .catch(() => (taking.value = true));
}

/** Whether the engine has been at work for a while: what is short shows nothing, for a dot that flickers would be restless. */
const long = signal(false);
const atWork = computed(() => busy.value > 0);
let patience = 0;
effect(() => {
  clearTimeout(patience);
  if (atWork.value) patience = setTimeout(() => (long.value = true), 400);
  else long.value = false;
});

function Busy(): JSX.Element {
  return <span class="busy" hidden={!long.value} aria-hidden="true" />;
}

export function Bar(): JSX.Element {
  return (
    <header class="bar">
      <h1 class="brand">
        <svg class="brand-mark" viewBox="0 0 32 32" aria-hidden="true">
          <path class="brand-ground" d="M3 25h26" />
          <path class="brand-lobe" d="M16 25C13.5 19.5 19 9.5 26 8c2.5 5.5-4 14-10 17z" />
          <path class="brand-ray" d="M5.5 10 16 25" />
        </svg>
        Gonio <span class="brand-what">explorer</span>
      </h1>
      <nav class="nav" aria-label="Pages">
        <a href={route.value.page === "explore" ? "#" : route.value.back} aria-current={route.value.page === "explore" ? "page" : undefined} onClick={(event) => route.value.page === "explore" && event.preventDefault()}>
          Explore
        </a>
        <a href="#learn" aria-current={route.value.page === "learn" ? "page" : undefined}>
          Learn
        </a>
      </nav>
      <Busy />
      <span class="spring" />
      <button type="button" class="button bar-button" onClick={copyLink}>
        <Icon name="share" />
        <span class="bar-word">Copy link</span>
      </button>
      <button type="button" class="button bar-button" onClick={() => (taking.value = true)}>
        <Icon name="take" />
        <span class="bar-word">Take away</span>
      </button>
      <IconButton icon="theme" label={`Colours: ${theme.value}`} onClick={nextTheme} />
      <IconButton icon="help" label="What this is, and the keyboard" onClick={() => (helping.value = true)} />
    </header>
  );
}

export function Notices(): JSX.Element {
  return (
    <div class="notices" aria-live="polite">
      {notices.value.map((notice) =>
        notice.tone === "error" ? (
          <Problem key={notice.id} complaint={notice} subject={notice.subject} onDismiss={() => dismissNotice(notice.id)} />
        ) : (
          <p key={notice.id} class="done" role="status">
            <Icon name="check" />
            {notice.message}
          </p>
        ),
      )}
    </div>
  );
}
