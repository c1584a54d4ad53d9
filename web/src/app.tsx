/** The page: the bar, the panel of functions, and a grid with a slot for each view. */
import type { ComponentType, JSX } from "preact";
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

export function App(): JSX.Element {
  return (
    <div class="app">
      <header class="bar">
        <h1>Gonio explorer</h1>
      </header>
      <aside class="panel" aria-label="Functions" />
      <div class="toolbar">
        <Controls />
      </div>
      <main class="views" data-large={large.value}>
        {VIEWS.map(({ view, name, Component }) => (
          <section key={view} class="slot" data-view={view} data-state={large.value === view ? "large" : large.value === null ? "tile" : "behind"} aria-label={name}>
            <Component />
          </section>
        ))}
      </main>
    </div>
  );
}
