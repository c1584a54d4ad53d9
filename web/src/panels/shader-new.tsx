/** A new shader: begun from one of the examples that come with the library. */
import { signal } from "@preact/signals";
import type { JSX } from "preact";
import { createShader } from "../files";
import { Dialog } from "./ui";

export const newShader = signal(false);

const STARTS = [
  { name: "ggx.wgsl", language: "WGSL", what: "a rough metal: microfacets with parameters, a density and its sampling", load: () => import("../../../examples/shaders/ggx.wgsl?raw") },
  { name: "blinn-phong.glsl", language: "GLSL", what: "diffuse and a highlight, with parameters", load: () => import("../../../examples/shaders/blinn-phong.glsl?raw") },
  { name: "minnaert.brdf", language: "BRDF Explorer", what: "the moon's reflection, as Disney's BRDF Explorer has its functions", load: () => import("../../../examples/shaders/minnaert.brdf?raw") },
];

export function NewShader(): JSX.Element | null {
  if (!newShader.value) return null;
  const close = (): void => void (newShader.value = false);
  return (
    <Dialog title="A new shader begins as" onClose={close}>
      <ul class="starts">
        {STARTS.map((start) => (
          <li key={start.name}>
            <button
              type="button"
              class="start"
              onClick={() => {
                close();
                void start.load().then((module) => createShader(start.name, module.default));
              }}
            >
              <strong>{start.language}</strong>
              <span>{start.what}</span>
            </button>
          </li>
        ))}
      </ul>
      <p class="quiet">It is edited in the panel and drawn while you type. A file of your own (.wgsl, .glsl, .frag, .brdf) can be dropped anywhere.</p>
    </Dialog>
  );
}
