import { beforeEach, describe, expect, test, vi } from "vitest";

interface Call {
  request: { width: number; height: number; first: number; count: number; function: string };
  resolve: (reply: unknown) => void;
  reject: (error: unknown) => void;
}
const calls: Call[] = [];

vi.mock("./timings", () => ({ stir: () => undefined }));
vi.mock("../engine/assets", () => ({ loadAssets: () => Promise.resolve(), SCENE: [] }));
vi.mock("../engine/client", () => ({
  EngineError: class extends Error {
    constructor(readonly complaint: { message: string; help: string | null; place: null }) {
      super(complaint.message);
    }
  },
  engine: {
    width: () => 2,
    drop: () => undefined,
    ask: (_: string, request: Call["request"]) => new Promise((resolve, reject) => calls.push({ request, resolve, reject })),
  },
}));

const { EngineError } = await import("../engine/client");
const { Progress } = await import("./progress");

const settle = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 0));
const motif = (text: string) => ({
  key: "a",
  version: "0",
  changed: undefined,
  motif: { function: text, object: "ball" as const, light: "point", direction: { theta: 45, phi: 180 }, turn: 0, bounces: 8, factors: { light: true, brdf: true, cosine: true } },
});
/** Answers a call with a picture whose every sample is `value`. */
const answer = async ({ request, resolve }: Call, value: number): Promise<void> => {
  resolve({ answer: { samples: request.count, rejected: 1 }, arrays: { sums: new Float32Array(3 * request.width * request.height).fill(value * request.count) } });
  await settle();
};

beforeEach(() => calls.splice(0));

describe("pictures in progress", () => {
  test("a small picture first, then samples that add up, none twice and none left out", async () => {
    const progress = new Progress();
    progress.follow([motif("f")], { width: 8, height: 4 }, 6, true);
    await settle();
    expect(calls[0]!.request).toMatchObject({ width: 2, height: 1, first: 0, count: 1 });
    await answer(calls[0]!, 0.5);
    expect(progress.films.value.get("a")).toMatchObject({ width: 2, samples: 1 });
    for (let k = 1; k < calls.length; k += 1) await answer(calls[k]!, 0.25);
    const film = progress.films.value.get("a")!;
    expect(film).toMatchObject({ width: 8, height: 4, samples: 6 });
    expect([...film.sums].every((x) => Math.abs(x / film.samples - 0.25) < 1e-6)).toBe(true);
    const samples = calls.slice(1).flatMap(({ request: { first, count } }) => Array.from({ length: count }, (_, k) => first + k));
    expect(samples.sort((a, b) => a - b)).toEqual([0, 1, 2, 3, 4, 5]);
    expect(film.rejected).toBe(calls.length - 1);
  });

  test("while something moves there are only small pictures", async () => {
    const progress = new Progress();
    progress.follow([motif("f")], { width: 8, height: 4 }, 6, false);
    await settle();
    await answer(calls[0]!, 1);
    expect(calls).toHaveLength(1);
  });

  test("what was asked for before a change is not shown after it", async () => {
    const progress = new Progress();
    progress.follow([motif("old")], { width: 8, height: 4 }, 1, true);
    await settle();
    progress.follow([motif("new")], { width: 8, height: 4 }, 1, true);
    await settle();
    await answer(calls.find((c) => c.request.function === "old")!, 9);
    expect(progress.films.value.has("a")).toBe(false);
    await answer(calls.find((c) => c.request.function === "new")!, 2);
    expect(progress.films.value.get("a")!.sums[0]).toBe(2);
  });

  test("an error is kept with its picture, is not asked for again, and goes with a change", async () => {
    const progress = new Progress();
    progress.follow([motif("bad")], { width: 8, height: 4 }, 4, true);
    await settle();
    for (const call of [...calls]) call.reject(new EngineError({ message: "no such light", help: null, place: null }));
    await settle();
    const asked = calls.length;
    await settle();
    expect(calls).toHaveLength(asked);
    expect(progress.complaints.value.get("a")?.message).toBe("no such light");
    progress.follow([motif("good")], { width: 8, height: 4 }, 1, false);
    await settle();
    await answer(calls.at(-1)!, 1);
    expect(progress.complaints.value.size).toBe(0);
    progress.follow([], { width: 8, height: 4 }, 1, false);
    expect(progress.films.value.size).toBe(0);
  });
});
