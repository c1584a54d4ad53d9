/** What can be done to the list of functions; every change of a description goes through the library. */
import { engine, EngineError } from "./engine/client";
import type { Complaint, Description } from "./engine/protocol";
import { functions, selected, type Shown } from "./state";

export const MOST = 8;

let nextId = 1;

function update(id: number, change: Partial<Shown>): void {
  functions.value = functions.value.map((f) => (f.id === id ? { ...f, ...change } : f));
}

function complaint(error: unknown): Complaint {
  return error instanceof EngineError ? error.complaint : { message: String(error), help: null, place: null };
}

function freeColour(): number {
  const taken = new Set(functions.value.map((f) => f.colour));
  for (let colour = 0; colour < MOST; colour++) if (!taken.has(colour)) return colour;
  return functions.value.length % MOST;
}

/** Adds a function and selects it; null when there are as many as can be told apart. */
export function add(text: string, shown: { colour?: number; visible?: boolean } = {}): number | null {
  if (functions.value.length >= MOST) return null;
  const id = nextId++;
  const colour = shown.colour ?? freeColour();
  functions.value = [...functions.value, { id, text, description: null, complaint: null, colour, visible: shown.visible ?? true }];
  selected.value = id;
  void setText(id, text);
  return id;
}

async function settle(id: number, asked: ReturnType<typeof engine.ask<"describe" | "set">>): Promise<void> {
  try {
    const reply = await asked;
    if (reply === null) return;
    const description = reply.answer as Description;
    update(id, { text: description.text, description, complaint: null });
  } catch (error) {
    update(id, { complaint: complaint(error) });
  }
}

/** Describes the function by this text; if the library can't, the complaint is shown and the views keep what they have. */
export function setText(id: number, text: string): Promise<void> {
  return settle(id, engine.ask("describe", { function: text }, { pool: "fast", key: `function:${id}` }));
}

/** Sets parameters, or takes them away (null). */
export function setValues(id: number, values: Record<string, string | null>): Promise<void> {
  const shown = functions.value.find((f) => f.id === id);
  if (shown === undefined) return Promise.resolve();
  return settle(id, engine.ask("set", { function: shown.text, values }, { pool: "fast", key: `set:${id}:${Object.keys(values).join()}` }));
}

export function remove(id: number): void {
  const at = functions.value.findIndex((f) => f.id === id);
  functions.value = functions.value.filter((f) => f.id !== id);
  if (selected.value === id) selected.value = (functions.value[at] ?? functions.value[at - 1])?.id ?? 0;
}

export function toggle(id: number): void {
  functions.value = functions.value.map((f) => (f.id === id ? { ...f, visible: !f.visible } : f));
}
