/** Which side of the selected function the panel shows. */
import { signal } from "@preact/signals";

export type Tab = "parameters" | "source" | "verdicts";
export const tab = signal<Tab>("parameters");
