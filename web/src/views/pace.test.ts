import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Shown } from "../state";

let late = false;
const held: boolean[] = [];
vi.mock("../engine/client", () => ({ engine: { hold: (_: string, on: boolean) => held.push(on) } }));
vi.mock("./timings", () => ({ pressed: () => late }));
vi.useFakeTimers();
const { functions } = await import("../state");
const { paced } = await import("./pace");

const shown = (id: number, text: string): Shown => ({ id, text, preset: null, description: {} as Shown["description"], complaint: null, colour: id, visible: true, revision: 0 });
const texts = (): string[] => paced.functions.value.map((f) => f.text);

beforeEach(() => {
  late = false;
  functions.value = [shown(1, "a")];
  vi.advanceTimersByTime(2000);
});
afterEach(() => vi.clearAllTimers());

test("where plots are in time, all views follow at once", () => {
  functions.value = [shown(1, "b")];
  expect(texts()).toEqual(["b"]);
});

test("where they are late, the others follow when nothing has changed for a while", () => {
  late = true;
  functions.value = [shown(1, "b")];
  expect(texts()).toEqual(["b"]);
  functions.value = [shown(1, "c")];
  vi.advanceTimersByTime(100);
  functions.value = [shown(1, "d")];
  vi.advanceTimersByTime(100);
  expect(texts()).toEqual(["b"]);
  expect(held.at(-1)).toBe(true);
  vi.advanceTimersByTime(30);
  expect(texts()).toEqual(["d"]);
  expect(held.at(-1)).toBe(false);
});

test("and now and then while it never rests", () => {
  late = true;
  const seen = new Set<string>();
  for (let k = 0; k < 60; k += 1) {
    functions.value = [shown(1, `x${k}`)];
    vi.advanceTimersByTime(50);
    seen.add(texts()[0]!);
  }
  expect(seen.size).toBeGreaterThan(3);
  expect(seen.size).toBeLessThan(7);
});

test("another function is shown at once", () => {
  late = true;
  functions.value = [shown(1, "b")];
  functions.value = [shown(1, "c"), shown(2, "e")];
  expect(texts()).toEqual(["c", "e"]);
});
