/** The page: the bar, the panel of functions, and a grid with a slot for each view. */
import { signal } from "@preact/signals";
import type { ComponentType, JSX } from "preact";
import { useEffect } from "preact/hooks";
import { failure } from "./engine/client";
import { LearnPage } from "./learn-page";
import { Bar, Notices } from "./panels/bar";
import { Drop } from "./panels/drop";
import { Help } from "./panels/help";
import { Legend } from "./panels/list";
import { openTab, Panel } from "./panels/panel";
import { Picker } from "./panels/picker";
import { NewShader } from "./panels/shader-new";
import { Take } from "./panels/take";
import { Problem } from "./panels/ui";
import { route } from "./route";
import { large, type ViewName } from "./state";
import { Albedo } from "./views/albedo";
import { Ball } from "./views/ball";
import { Cartesian } from "./views/cartesian";
import { Controls } from "./views/controls";
import { Difference } from "./views/difference";
import { Lobe } from "./views/lobe";
import { Polar } from "./views/polar";
import { Preview } from "./views/preview";
import { Slice } from "./views/slice";

/** In the order of the grid; the name labels the slot's region for screen readers. */
const VIEWS: { view: ViewName; name: string; Component: ComponentType }[] = [
  { view: "lobe", name: "Lobe in space", Component: Lobe },
  { view: "polar", name: "Polar plot", Component: Polar },
  { view: "cartesian", name: "Cartesian plot", Component: Cartesian },
  { view: "ball", name: "Lit ball", Component: Ball },
  { view: "preview", name: "Preview", Component: Preview },
  { view: "slice", name: "Slice by half and difference angle", Component: Slice },
  { view: "albedo", name: "Directional albedo", Component: Albedo },
  { view: "difference", name: "Difference", Component: Difference },
];

/** Narrow screens show the views or the panel. */
const pane = signal<"views" | "panel">("views");

function Explore(): JSX.Element {
  useEffect(() => {
    const escape = (event: KeyboardEvent): void => {
      if (event.key === "Escape" && !event.defaultPrevented && document.querySelector("dialog[open]") === null) large.value = null;
    };
    addEventListener("keydown", escape);
    return () => removeEventListener("keydown", escape);
  }, []);
  return (
    <main class="explore" data-pane={pane.value} data-wide={openTab.value === "source" ? "" : undefined}>
      <Panel />
      <div class="main" id="views">
        <Legend />
        <div class="toolbar">
          <Controls />
        </div>
        {failure.value !== null ? <Problem complaint={failure.value} /> : null}
        <div class="views" data-large={large.value ?? undefined}>
          {VIEWS.map(({ view, name, Component }) => (
            <section key={view} class="slot" data-view={view} data-state={large.value === view ? "large" : large.value === null ? "tile" : "behind"} aria-label={name}>
              <Component />
            </section>
          ))}
        </div>
      </div>
      <nav class="panes" aria-label="Parts of the page">
        {(["views", "panel"] as const).map((name) => (
          <button key={name} type="button" aria-pressed={pane.value === name} onClick={() => (pane.value = name)}>
            {name === "views" ? "Views" : "Functions"}
          </button>
        ))}
      </nav>
    </main>
  );
}

export function App(): JSX.Element {
  return (
    <div class="app">
      <a class="skip" href="#views" onClick={skip}>
        Skip to the views
      </a>
      <Bar />
      {route.value.page === "learn" ? <LearnPage /> : <Explore />}
      <Picker />
      <NewShader />
      <Take />
      <Help />
      <Drop />
      <Notices />
    </div>
  );
}

/** The fragment of the address holds the state: the link must not write there. */
function skip(event: MouseEvent): void {
  event.preventDefault();
  const views = document.getElementById("views");
  if (views === null) return;
  views.tabIndex = -1;
  views.focus();
}
