/** Colours of the page's style for what is drawn without style sheets: canvases and WebGL. */
import { signal } from "@preact/signals";

/** Counts changes between light and dark; what draws on a canvas reads it. */
export const theme = signal(0);

const changed = (): void => {
  theme.value += 1;
};
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
new MutationObserver(changed).observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });

/** A custom property of the page, as `--line`. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
