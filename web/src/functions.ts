/** What can be done to the list of functions; every change of a description goes through the library. */
import { batch } from "@preact/signals";
import { engine, EngineError, type Whole } from "./engine/client";
import type { Along, Complaint, Description, Parameter, Reply } from "./engine/protocol";
import { difference, functions, selected, type Shown } from "./state";

/** As many as the palette has colours, and as the command plots together. */
export const MOST = 8;

/** A question of a function that is asked along with every change of it, and what takes the answer: then both are drawn at once. */
export interface Companion {
  along: Along;
  take(text: string, answer: Reply | EngineError, changed: number): void;
}
/** What asks along: of the function with this id, or nothing while it isn't shown. */
export const companions: ((id: number) => Companion | null)[] = [];

let nextId = 1;
/** Parameters that were asked for and not yet answered, by function: a newer request holds the older ones' changes too. */
const pending = new Map<number, Record<string, string | null>>();
/** Texts that were asked for and not yet answered, by function: parameters are set in them, not in what they replace. */
const texts = new Map<number, string>();

export function find(id: number): Shown | undefined {
  return functions.value.find((f) => f.id === id);
}

function update(id: number, change: Partial<Shown>): void {
  functions.value = functions.value.map((f) => (f.id === id ? { ...f, ...change } : f));
}

export function complaintOf(error: unknown): Complaint {
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
  functions.value = [...functions.value, { id, text, preset: null, description: null, complaint: null, colour, visible: shown.visible ?? true, revision: 0 }];
  selected.value = id;
  void setText(id, text);
  return id;
}

/** The new parameters, those that are as before as the objects that they were: their controls need not be drawn anew. */
function kept(before: Parameter[] | undefined, now: Parameter[]): Parameter[] {
  return now.map((parameter, k) => (before !== undefined && JSON.stringify(before[k]) === JSON.stringify(parameter) ? before[k]! : parameter));
}

type Question = (along: Along[]) => Promise<Whole<"describe"> | Whole<"set"> | null>;

/** Whether the library understood; null if a newer request took this one's place. */
async function settle(id: number, ask: Question, preset: string | null): Promise<boolean | null> {
  const changed = performance.now();
  const asked = companions.flatMap((companion) => companion(id) ?? []);
  try {
    const reply = await ask(asked.map((one) => one.along));
    if (reply === null) return null;
    const description: Description = { ...reply.answer, parameters: kept(find(id)?.description?.parameters, reply.answer.parameters) };
    batch(() => {
      asked.forEach((one, k) => one.take(description.text, reply.along[k]!, changed));
      update(id, { text: description.text, preset, description, complaint: null, changed });
    });
    return true;
  } catch (error) {
    update(id, { complaint: complaintOf(error) });
    return false;
  }
}

/** Describes the function by this text; if the library can't, the complaint is shown and the views keep what they have. */
export async function setText(id: number, text: string): Promise<boolean | null> {
  pending.delete(id);
  texts.set(id, text);
  const preset = /^[\w-]+@[\w-]+$/.test(text) ? text : null;
  const done = await settle(id, (along) => engine.ask("describe", { function: text }, { pool: "fast", key: `function:${id}`, along }), preset);
  if (texts.get(id) === text) texts.delete(id);
  return done;
}

/** Sets parameters, or takes them away (null). */
export async function setValues(id: number, values: Record<string, string | null>): Promise<boolean | null> {
  const shown = find(id);
  if (shown === undefined) return false;
  const all = { ...pending.get(id), ...values };
  pending.set(id, all);
  const base = texts.get(id) ?? shown.text;
  const done = await settle(id, (along) => engine.ask("set", { function: base, values: all }, { pool: "fast", key: `function:${id}`, along }), null);
  if (pending.get(id) === all) pending.delete(id);
  return done;
}

/** After a file was replaced: describes what rests on it anew. */
export async function refresh(file: string): Promise<void> {
  const path = `files/${file}`;
  for (const shown of functions.value) {
    if (!shown.text.includes(path)) continue;
    update(shown.id, { revision: shown.revision + 1 });
    await setText(shown.id, shown.text);
  }
}

export function duplicate(id: number): void {
  const shown = find(id);
  if (shown !== undefined) add(shown.preset ?? shown.text);
}

export function remove(id: number): void {
  const at = functions.value.findIndex((f) => f.id === id);
  if (difference.value?.includes(id)) difference.value = null;
  engine.drop("fast", `function:${id}`);
  functions.value = functions.value.filter((f) => f.id !== id);
  if (selected.value === id) selected.value = (functions.value[at] ?? functions.value[at - 1])?.id ?? 0;
}

export function setVisible(id: number, visible: boolean): void {
  update(id, { visible });
}

/** Takes the complaint away; what the views show was never lost. */
export function dismiss(id: number): void {
  update(id, { complaint: null });
}
