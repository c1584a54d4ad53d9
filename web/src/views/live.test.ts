import { signal } from "@preact/signals";
import { beforeEach, describe, expect, test, vi } from "vitest";
import type { Shown } from "../state";

interface Call {
  operation: string;
  request: { function: string; wi: { theta: number; phi: number }; wo: { theta: number; phi: number } };
  key: string;
  resolve: (reply: unknown) => void;
  reject: (error: unknown) => void;
}
const calls: Call[] = [];
const dropped: string[] = [];

vi.mock("./timings", () => ({ begun: { value: true }, stir: () => undefined }));
vi.mock("../engine/client", () => ({
  EngineError: class extends Error {
    constructor(readonly complaint: { message: string; help: string | null; place: null }) {
      super(complaint.message);
    }
  },
  engine: {
    drop: (_: string, key: string) => dropped.push(key),
    ask: (operation: string, request: Call["request"], how: { key: string }) => new Promise((resolve, reject) => calls.push({ operation, request, key: how.key, resolve, reject })),
  },
}));

const { EngineError } = await import("../engine/client");
const { Live } = await import("./live");
const { companions } = await import("../functions");

const settle = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 0));
const shown = (id: number, text: string, revision = 0): Shown => ({ id, text, preset: null, description: null, complaint: null, colour: id, visible: true, revision });
const make = () => {
  const wanted = signal<Shown[] | null>(null);
  const north = { theta: 0, phi: 0 };
  const live = new Live("evaluate", () => wanted.value?.map((f) => ({ key: String(f.id), shown: f, request: { function: f.text, wi: north, wo: north } })) ?? null);
  return { live, wanted };
};

beforeEach(() => {
  calls.splice(0);
  companions.splice(0);
  dropped.splice(0);
});

describe("answers that follow the state", () => {
  test("what is asked for already isn't asked for again; another revision of the same text is", () => {
    const { wanted } = make();
    wanted.value = [shown(1, "a")];
    wanted.value = [shown(1, "a")];
    expect(calls.map((c) => c.request.function)).toEqual(["a"]);
    wanted.value = [shown(1, "a", 1)];
    expect(calls).toHaveLength(2);
  });

  test("an answer stays until the next one; a superseded call changes nothing", async () => {
    const { live, wanted } = make();
    wanted.value = [shown(1, "a")];
    calls[0]!.resolve({ answer: "A", arrays: {} });
    await settle();
    expect(live.answers.value.get("1")?.answer).toBe("A");
    wanted.value = [shown(1, "b")];
    calls[1]!.resolve(null);
    await settle();
    expect(live.answers.value.get("1")?.answer).toBe("A");
  });

  test("what is taken away is dropped, and its late answer is not shown", async () => {
    const { live, wanted } = make();
    wanted.value = [shown(1, "a"), shown(2, "b")];
    wanted.value = [shown(2, "b")];
    expect(dropped).toEqual(["evaluate/1/"]);
    calls[0]!.resolve({ answer: "A", arrays: {} });
    await settle();
    expect(live.answers.value.has("1")).toBe(false);
  });

  test("a complaint takes the place of the answer, and the next answer that of the complaint", async () => {
    const { live, wanted } = make();
    wanted.value = [shown(1, "a")];
    calls[0]!.reject(new EngineError({ message: "it is 0 everywhere", help: null, place: null }));
    await settle();
    expect(live.complaints.value.get("1")?.message).toBe("it is 0 everywhere");
    wanted.value = [shown(1, "b")];
    calls[1]!.resolve({ answer: "B", arrays: {} });
    await settle();
    expect(live.complaints.value.size).toBe(0);
    expect(live.answers.value.get("1")?.answer).toBe("B");
  });

  test("is asked along with a change of the function, and not again when that is described", async () => {
    const { live, wanted } = make();
    wanted.value = [shown(1, "a")];
    const late = calls[0]!;
    const companion = companions.flatMap((of) => of(1) ?? []).at(-1)!;
    expect(companion.along).toMatchObject({ operation: "evaluate", request: { function: "a" } });
    companion.take("b", { answer: "B", arrays: {} } as never, 12.5);
    wanted.value = [{ ...shown(1, "b"), changed: 12.5 }];
    expect(calls).toHaveLength(1);
    // The answer of what was asked before comes too late to be shown.
    late.resolve({ answer: "A", arrays: {} });
    await settle();
    expect(live.answers.value.get("1")).toMatchObject({ answer: "B", since: 12.5 });
    wanted.value = [];
    expect(companions.map((of) => of(1)).filter((c) => c !== null)).toHaveLength(0);
  });

  test("a change is timed from when it was set, not from when the library had described it", async () => {
    const { live, wanted } = make();
    wanted.value = [shown(1, "a")];
    wanted.value = [{ ...shown(1, "b"), changed: 12.5 }];
    calls[1]!.resolve({ answer: "B", arrays: {} });
    await settle();
    expect(live.answers.value.get("1")?.since).toBe(12.5);
  });
});
