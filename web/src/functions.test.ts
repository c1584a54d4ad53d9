import { beforeEach, describe, expect, it, vi } from "vitest";

/** The library, as far as these tests need it: `model:key=value,…`. */
const asked: { operation: string; request: { function: string; values?: Record<string, string | null> }; answer: () => void }[] = [];
vi.mock("./engine/client", () => {
  class EngineError extends Error {
    constructor(readonly complaint: { message: string; help: null; place: null }) {
      super(complaint.message);
    }
  }
  const engine = {
    drop: () => undefined,
    ask: (operation: string, request: { function: string; values?: Record<string, string | null> }) =>
      new Promise((resolve, reject) => {
        asked.push({
          operation,
          request,
          answer: () => {
            if (JSON.stringify(request).includes("bad")) {
              reject(new EngineError({ message: "bad", help: null, place: null }));
              return;
            }
            const [model, settings = ""] = request.function.split(":") as [string, string?];
            const values = new Map(settings.split(",").filter((s) => s !== "").map((s) => s.split("=") as [string, string]));
            for (const [key, value] of Object.entries(request.values ?? {})) if (value === null) values.delete(key);
              else values.set(key, value);
            const text = `${model.replace("@p", "")}${values.size > 0 ? ":" : ""}${[...values].map(([k, v]) => `${k}=${v}`).join(",")}`;
            resolve({ answer: { text, parameters: [] }, arrays: {} });
          },
        });
      }),
  };
  return { engine, EngineError };
});

const { add, find, remove, setText, setValues, duplicate, MOST } = await import("./functions");
const { functions, selected, difference } = await import("./state");

/** Answers everything that was asked, in order. */
async function answer(): Promise<void> {
  while (asked.length > 0) asked.shift()!.answer();
  await new Promise((resolve) => setTimeout(resolve, 0));
}

beforeEach(async () => {
  await answer();
  for (const f of functions.value) remove(f.id);
});

describe("the list of functions", () => {
  it("gives each its own colour, and a freed one again", async () => {
    const ids = ["a", "b", "c"].map((text) => add(text)!);
    expect(functions.value.map((f) => f.colour)).toEqual([0, 1, 2]);
    remove(ids[1]!);
    add("d");
    expect(functions.value.map((f) => f.colour)).toEqual([0, 2, 1]);
    await answer();
  });
  it("selects a neighbour of what is removed, and forgets its difference", () => {
    const [a, b] = [add("a")!, add("b")!];
    difference.value = [a, b];
    remove(b);
    expect(selected.value).toBe(a);
    expect(difference.value).toBeNull();
  });
  it("ends where colours do", () => {
    for (let i = 0; i < MOST; i++) expect(add("a")).not.toBeNull();
    expect(add("a")).toBeNull();
    duplicate(functions.value[0]!.id);
    expect(functions.value).toHaveLength(MOST);
  });
});

describe("changes of a description", () => {
  it("keep what is shown when the library refuses", async () => {
    const id = add("a:x=1")!;
    await answer();
    const refused = setText(id, "bad");
    await answer();
    expect(await refused).toBe(false);
    expect(find(id)).toMatchObject({ text: "a:x=1", complaint: { message: "bad" } });
    void setValues(id, { x: "2" });
    await answer();
    expect(find(id)).toMatchObject({ text: "a:x=2", complaint: null });
  });
  it("add up while the library hasn't answered", async () => {
    const id = add("a")!;
    await answer();
    void setValues(id, { x: "1" });
    void setValues(id, { y: "2" });
    void setValues(id, { x: "3" });
    // Of requests that wait only the newest is computed.
    asked.splice(0, 2);
    await answer();
    expect(find(id)!.text).toBe("a:x=3,y=2");
  });
  it("are made in the newest text, even if it isn't understood yet", async () => {
    const id = add("a:x=1")!;
    await answer();
    void setText(id, "b:y=1");
    void setValues(id, { y: "2" });
    asked.shift();
    await answer();
    expect(find(id)!.text).toBe("b:y=2");
  });
  it("keep a preset's name until a parameter is set", async () => {
    const id = add("ward@p")!;
    await answer();
    expect(find(id)).toMatchObject({ preset: "ward@p", text: "ward" });
    void setValues(id, { x: "1" });
    await answer();
    expect(find(id)).toMatchObject({ preset: null, text: "ward:x=1" });
  });
});
