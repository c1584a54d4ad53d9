/** The page Learn, loaded when it is first opened. */
import { signal } from "@preact/signals";
import type { ComponentType, JSX } from "preact";
import { Problem } from "./panels/ui";

const Loaded = signal<ComponentType | null>(null);
const failed = signal(false);

export function LearnPage(): JSX.Element {
  const Component = Loaded.value;
  if (Component !== null) return <Component />;
  if (failed.value) return <Problem complaint={{ message: "the page Learn could not be loaded", help: "reload when the connection is back", place: null }} />;
  import("./learn").then(
    (module) => (Loaded.value = module.Learn),
    () => (failed.value = true),
  );
  return <main class="learn-loading" aria-busy="true" />;
}
