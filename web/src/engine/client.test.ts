import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Engine as EngineType } from "./client";
import type { FromWorker, ToWorker } from "./worker";

/** A worker that answers when the test says so. */
class FakeWorker {
  static all: FakeWorker[] = [];
  onmessage: ((event: { data: FromWorker }) => void) | null = null;
  onerror: ((event: { message: string }) => void) | null = null;
  calls: Extract<ToWorker, { kind: "call" }>[] = [];
  files: string[] = [];
  ended = false;
  constructor() {
    FakeWorker.all.push(this);
  }
  postMessage(message: ToWorker): void {
    if (message.kind === "call") this.calls.push(message);
    if (message.kind === "file") this.files.push(message.name);
    if (message.kind === "start") this.files.push(...message.files.map(([name]) => name));
  }
  terminate(): void {
    this.ended = true;
  }
  asked(): unknown[] {
    return this.calls.map((call) => (call.request as { function: string }).function);
  }
  answer(answer: unknown, numbers: number[] = [], along: Extract<FromWorker, { answer: unknown }>["along"] = []): void {
    const data = Float32Array.from(numbers).buffer;
    this.onmessage!({ data: { id: this.calls.at(-1)!.id, answer, arrays: { values: [0, numbers.length] }, data, along } });
  }
  refuse(message: string): void {
    this.onmessage!({ data: { id: this.calls.at(-1)!.id, complaint: { message, help: null, place: null }, lost: false } });
  }
}

let engine: EngineType;
let Engine: typeof EngineType;

beforeEach(async () => {
  FakeWorker.all = [];
  vi.useFakeTimers();
  vi.stubGlobal("Worker", FakeWorker);
  vi.stubGlobal("document", { baseURI: "https://example.org/" });
  vi.stubGlobal("navigator", { hardwareConcurrency: 3 });
  vi.stubGlobal("fetch", () => Promise.resolve({}));
  vi.stubGlobal("WebAssembly", { ...WebAssembly, compileStreaming: () => Promise.resolve({}) });
  ({ Engine } = await import("./client"));
  FakeWorker.all = [];
  engine = new Engine("https://example.org/gonio.wasm");
  await vi.advanceTimersByTimeAsync(0);
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const ask = (name: string, how: Parameters<EngineType["ask"]>[2] = { pool: "fast", key: "plot" }) =>
  engine.ask("curve", { function: name, wi: { theta: 0, phi: 0 }, cosine: false }, how);

describe("the engine's pools", () => {
  it("answer with the arrays of the reply", async () => {
    const reply = ask("a");
    FakeWorker.all[0]!.answer({ largest: [1, 1, 1] }, [1, 2, 3]);
    expect([...(await reply)!.arrays["values"]!]).toEqual([1, 2, 3]);
  });
  it("give what was asked along with it, each an answer or the library's complaint", async () => {
    const along = [1, 2].map(() => ({ operation: "curve" as const, request: { function: "", wi: { theta: 0, phi: 0 }, cosine: false } }));
    const reply = engine.ask("describe", { function: "a" }, { pool: "fast", key: "function:1", along });
    const worker = FakeWorker.all[0]!;
    expect(worker.calls[0]!.along).toEqual(along);
    worker.answer("A", [], [{ answer: "curve", arrays: { angles: [0, 2] }, data: Float32Array.from([4, 5]).buffer }, { complaint: { message: "it has no curve", help: null, place: null } }]);
    const [curve, refused] = (await reply)!.along;
    expect([...(curve as { arrays: Record<string, Float32Array> }).arrays["angles"]!]).toEqual([4, 5]);
    expect(refused).toMatchObject({ complaint: { message: "it has no curve" } });
  });
  it("let what runs run, and drop what waits for what is newer", async () => {
    const replies = [ask("a"), ask("b"), ask("c"), ask("d", { pool: "fast", key: "other" })];
    const worker = FakeWorker.all[0]!;
    expect(await replies[1]).toBeNull();
    worker.answer("A");
    expect((await replies[0])!.answer).toBe("A");
    worker.answer("C");
    expect((await replies[2])!.answer).toBe("C");
    worker.answer("D");
    expect((await replies[3])!.answer).toBe("D");
    expect(worker.asked()).toEqual(["a", "c", "d"]);
  });
  it("keep a waiting request's place when a newer one replaces it", async () => {
    const running = ask("running");
    const replies = [ask("x", { pool: "fast", key: "x" }), ask("y", { pool: "fast", key: "y" }), ask("x2", { pool: "fast", key: "x" })];
    const worker = FakeWorker.all[0]!;
    for (let i = 0; i < 3; i++) worker.answer(i);
    await Promise.all([running, ...replies]);
    expect(worker.asked()).toEqual(["running", "x2", "y"]);
  });
  it("take what is quick before what isn't", () => {
    void ask("running");
    void engine.ask("slice", { function: "slice", phi_d: 90 }, { pool: "fast" });
    void engine.ask("describe", { function: "d1" }, { pool: "fast" });
    void engine.ask("describe", { function: "d2" }, { pool: "fast" });
    const worker = FakeWorker.all[0]!;
    for (let i = 0; i < 3; i++) worker.answer(i);
    expect(worker.asked()).toEqual(["running", "d1", "d2", "slice"]);
  });
  it("work on as many calls at once as there are cores to spare, and never give an older answer after a newer one", async () => {
    expect(engine.width("render")).toBe(2);
    const older = ask("older", { pool: "render", key: "r" });
    const newer = ask("newer", { pool: "render", key: "r" });
    const [first, second] = FakeWorker.all.slice(1);
    second!.answer("newer");
    first!.answer("older");
    expect((await newer)!.answer).toBe("newer");
    expect(await older).toBeNull();
  });
  it("reject with the library's own complaint and go on", async () => {
    const reply = ask("a");
    FakeWorker.all[0]!.refuse("no such model");
    await expect(reply).rejects.toMatchObject({ complaint: { message: "no such model" } });
    const next = ask("b");
    FakeWorker.all[0]!.answer("B");
    expect((await next)!.answer).toBe("B");
  });
  it("end what runs where that is asked for", async () => {
    const old = ask("old", { pool: "check", key: "check", interrupt: true });
    const worker = FakeWorker.all[1]!;
    const replacement = ask("new", { pool: "check", key: "check", interrupt: true });
    expect(await old).toBeNull();
    expect(worker.ended).toBe(true);
    expect(FakeWorker.all[2]!.asked()).toEqual(["new"]);
    FakeWorker.all[2]!.answer("N");
    expect((await replacement)!.answer).toBe("N");
  });
  it("take back what nobody wants any more", async () => {
    const running = ask("running", { pool: "render", key: "picture:1" });
    const also = ask("also", { pool: "render", key: "picture:2" });
    const waiting = ask("waiting", { pool: "render", key: "picture:3" });
    engine.drop("render", "picture:");
    expect(await waiting).toBeNull();
    FakeWorker.all[1]!.answer(1);
    FakeWorker.all[2]!.answer(2);
    expect(await Promise.all([running, also])).toEqual([null, null]);
    const later = ask("later", { pool: "render", key: "picture:1" });
    FakeWorker.all[1]!.answer("L");
    expect((await later)!.answer).toBe("L");
  });
  it("hold back what waits, as long as they are told to", async () => {
    engine.hold("slow", true);
    const older = ask("older", { pool: "slow", key: "s" });
    const newer = ask("newer", { pool: "slow", key: "s" });
    expect(await older).toBeNull();
    expect(FakeWorker.all).toHaveLength(1);
    engine.hold("slow", false);
    FakeWorker.all[1]!.answer("N");
    expect((await newer)!.answer).toBe("N");
  });
  it("replace a worker that hangs or breaks, with the files that it had", async () => {
    engine.putFile("a.binary", new Uint8Array(3));
    const hung = expect(ask("a")).rejects.toMatchObject({ complaint: { message: expect.stringContaining("no answer after 30 seconds") } });
    await vi.advanceTimersByTimeAsync(30_000);
    await hung;
    expect(FakeWorker.all[0]!.ended).toBe(true);
    const broken = expect(ask("b")).rejects.toMatchObject({ complaint: { message: expect.stringContaining("lost") } });
    FakeWorker.all[1]!.onerror!({ message: "lost" });
    await broken;
    const next = ask("c");
    expect(FakeWorker.all[2]!.files).toEqual(["a.binary"]);
    FakeWorker.all[2]!.answer("C");
    expect((await next)!.answer).toBe("C");
  });
});
