/**
 * The engine, as the page sees it: pools of workers, each with its own instance of the library.
 *
 * `engine.ask(operation, request, { pool, key })` resolves to the reply, or to **null if it was superseded**: while a request waits, a newer
 * one with the same pool and key takes its place. One that runs already is let run, and its reply is given, unless a newer one was answered
 * first. It rejects with an `EngineError`, whose `complaint` is to be shown as it is.
 */
import { signal } from "@preact/signals";
import type { Along, Complaint, Operation, Reply, Requests } from "./protocol";
import type { Answered } from "./wasm";
import type { FromWorker, ToWorker } from "./worker";

/** `fast`: what is drawn while a slider moves; `slow`: albedo, exports; `check`: verdicts; `render`: parts of pictures, several at once. */
export type Pool = "fast" | "slow" | "check" | "render";

export interface Ask {
  pool: Pool;
  /** Requests with one key replace each other. */
  key?: string;
  /** Goes before what waits. */
  early?: boolean;
  /** A running request of the same key is ended, not let run: for what takes seconds. */
  interrupt?: boolean;
  /** Answered in the same call, of the function that a `describe` or `set` answers: one way to the worker and back, not two. */
  along?: Along[];
}

/** An answer, and those of what was asked along. */
export type Whole<K extends Operation = Operation> = Reply<K> & { along: (Reply | EngineError)[] };

export class EngineError extends Error {
  override name = "EngineError";
  constructor(readonly complaint: Complaint) {
    super(complaint.message);
  }
}

interface Job {
  id: number;
  operation: Operation;
  request: unknown;
  key: string | null;
  early: boolean;
  along: Along[];
  resolve: (reply: Whole | null) => void;
  reject: (error: EngineError) => void;
}

interface Lane {
  worker: Worker;
  job: Job | null;
  watchdog: number;
}

/** Seconds after which a call is taken for hung, and its worker is replaced. */
const LIMIT: Record<Pool, number> = { fast: 30, slow: 120, check: 900, render: 120 };

/** Answered at once, while others take tens of milliseconds: they go before what waits. */
const URGENT: ReadonlySet<Operation> = new Set<Operation>(["catalogue", "describe", "set", "evaluate", "curve"]);

/** Calls that are running or waiting. */
export const busy = signal(0);
/** Set once, if the engine can't be started at all. */
export const failure = signal<Complaint | null>(null);

export class Engine {
  private readonly lanes: Record<Pool, Lane[]> = { fast: [], slow: [], check: [], render: [] };
  private readonly waiting: Record<Pool, Job[]> = { fast: [], slow: [], check: [], render: [] };
  private readonly size: Record<Pool, number>;
  private readonly answered = new Map<string, number>();
  private readonly held = new Set<Pool>();
  private readonly files = new Map<string, Uint8Array>();
  private readonly fetched = new Map<string, Promise<void>>();
  private module: WebAssembly.Module | null = null;
  private next = 1;

  constructor(private readonly address: string) {
    const cores = navigator.hardwareConcurrency || 2;
    this.size = { fast: 1, slow: 1, check: 1, render: Math.max(1, Math.min(4, cores - 1)) };
    // Its script loads while the module compiles.
    this.lanes.fast.push(this.hire("fast"));
    void this.compile();
  }

  /** How many calls the pool works on at once. */
  width(pool: Pool): number {
    return this.size[pool];
  }

  ask<K extends Operation>(operation: K, request: Requests[K]["request"], how: Ask): Promise<Whole<K> | null> {
    return new Promise<Whole | null>((resolve, reject) => {
      if (failure.value !== null) {
        reject(new EngineError(failure.value));
        return;
      }
      const job: Job = { id: this.next++, operation, request, key: how.key ?? null, early: how.early ?? URGENT.has(operation), along: how.along ?? [], resolve, reject };
      this.enqueue(how.pool, job);
      if (how.interrupt && job.key !== null) this.interrupt(how.pool, job.key);
      this.pump(how.pool);
    }) as Promise<Whole<K> | null>;
  }

  /** Takes back what waits under a key that begins so; what runs is answered with null. */
  drop(pool: Pool, prefix: string): void {
    const kept: Job[] = [];
    for (const job of this.waiting[pool]) {
      if (job.key?.startsWith(prefix)) {
        job.resolve(null);
        busy.value -= 1;
      } else kept.push(job);
    }
    this.waiting[pool] = kept;
    for (const lane of this.lanes[pool]) {
      if (lane.job?.key?.startsWith(prefix)) this.answered.set(`${pool}\n${lane.job.key}`, this.next++);
    }
  }

  /** Whether what waits goes on waiting; what runs is let run. */
  hold(pool: Pool, held: boolean): void {
    if (held) this.held.add(pool);
    else if (this.held.delete(pool)) this.pump(pool);
  }

  /** Ends what runs under this key; its promise resolves to null. */
  interrupt(pool: Pool, key: string): void {
    for (const [index, lane] of this.lanes[pool].entries()) {
      if (lane.job?.key !== key) continue;
      lane.job.resolve(null);
      this.replace(pool, index);
    }
  }

  /** Puts a file into every worker's folder; descriptions name it `files/NAME`. */
  putFile(name: string, bytes: Uint8Array): void {
    this.files.set(name, bytes);
    if (this.module === null) return;
    for (const pool of Object.values(this.lanes)) for (const lane of pool) this.send(lane, { kind: "file", name, bytes });
  }

  hasFile(name: string): boolean {
    return this.files.has(name);
  }

  /** Puts a file of the site into the folder, once; for the panoramas that come along. */
  fetchFile(name: string, address: string): Promise<void> {
    if (this.files.has(name)) return Promise.resolve();
    let going = this.fetched.get(name);
    if (going === undefined) {
      going = fetch(address)
        .then(async (response) => {
          if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
          this.putFile(name, new Uint8Array(await response.arrayBuffer()));
        })
        .catch((error: unknown) => {
          this.fetched.delete(name);
          throw new EngineError({ message: `${name} could not be loaded: ${String(error)}`, help: "try again when the connection is back", place: null });
        });
      this.fetched.set(name, going);
    }
    return going;
  }

  private async compile(): Promise<void> {
    try {
      const response = fetch(this.address, { credentials: "same-origin" });
      this.module = await WebAssembly.compileStreaming(response).catch(async () => {
        // Some servers send another media type than application/wasm, which only streaming insists on.
        const again = await fetch(this.address, { credentials: "same-origin" });
        if (!again.ok) throw new Error(`${again.status} ${again.statusText}`);
        return WebAssembly.compile(await again.arrayBuffer());
      });
    } catch (error) {
      const complaint: Complaint = {
        message: `the engine could not be started: ${error instanceof Error ? error.message : String(error)}`,
        help: "the explorer needs WebAssembly with SIMD (Chrome 91, Firefox 89, Safari 16.4 or newer) and its file gonio.wasm",
        place: null,
      };
      failure.value = complaint;
      for (const pool of Object.keys(this.waiting) as Pool[]) {
        for (const job of this.waiting[pool].splice(0)) job.reject(new EngineError(complaint));
      }
      busy.value = 0;
      return;
    }
    for (const lane of this.lanes.fast) this.begin(lane);
    for (const pool of Object.keys(this.waiting) as Pool[]) this.pump(pool);
  }

  private enqueue(pool: Pool, job: Job): void {
    const queue = this.waiting[pool];
    const old = job.key === null ? -1 : queue.findIndex((other) => other.key === job.key);
    if (old >= 0) {
      // The newer one keeps the place in the queue: a slider that moves all the time must not starve its own plot.
      queue[old]!.resolve(null);
      queue[old] = job;
      return;
    }
    busy.value += 1;
    if (job.early) {
      const place = queue.findIndex((other) => !other.early);
      queue.splice(place < 0 ? queue.length : place, 0, job);
    } else queue.push(job);
  }

  private pump(pool: Pool): void {
    if (this.module === null || this.held.has(pool)) return;
    const lanes = this.lanes[pool];
    while (this.waiting[pool].length > 0) {
      let index = lanes.findIndex((lane) => lane.job === null);
      if (index < 0) {
        if (lanes.length >= this.size[pool]) return;
        index = lanes.push(this.hire(pool)) - 1;
      }
      const lane = lanes[index]!;
      const job = this.waiting[pool].shift()!;
      lane.job = job;
      lane.watchdog = setTimeout(() => this.hung(pool, lane), LIMIT[pool] * 1000);
      this.send(lane, { kind: "call", id: job.id, operation: job.operation, request: job.request, along: job.along });
    }
  }

  private hire(pool: Pool): Lane {
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module", name: `gonio-${pool}` });
    const lane: Lane = { worker, job: null, watchdog: 0 };
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(pool, lane, event.data);
    worker.onerror = (event) => this.broken(pool, lane, event.message || "the worker could not be loaded");
    this.begin(lane);
    return lane;
  }

  private begin(lane: Lane): void {
    if (this.module !== null) this.send(lane, { kind: "start", module: this.module, files: [...this.files] });
  }

  private receive(pool: Pool, lane: Lane, message: FromWorker): void {
    const job = lane.job;
    if (job === null || job.id !== message.id) return;
    this.release(lane);
    if (job.key !== null) {
      const place = `${pool}\n${job.key}`;
      if ((this.answered.get(place) ?? 0) > job.id) {
        job.resolve(null);
        this.pump(pool);
        return;
      }
      this.answered.set(place, job.id);
    }
    if ("complaint" in message) job.reject(new EngineError(message.complaint));
    else {
      const along = (message.along ?? []).map((one) => ("complaint" in one ? new EngineError(one.complaint) : reply(one)));
      job.resolve({ ...reply(message), along });
    }
    this.pump(pool);
  }

  private release(lane: Lane): void {
    clearTimeout(lane.watchdog);
    lane.job = null;
    busy.value -= 1;
  }

  private hung(pool: Pool, lane: Lane): void {
    this.broken(pool, lane, `no answer after ${LIMIT[pool]} seconds`);
  }

  private broken(pool: Pool, lane: Lane, why: string): void {
    const job = lane.job;
    job?.reject(
      new EngineError({
        message: `the engine stopped in ‘${job.operation}’: ${why}`,
        help: "it has been started again and nothing that you set is lost",
        place: null,
      }),
    );
    this.replace(pool, this.lanes[pool].indexOf(lane));
  }

  private replace(pool: Pool, index: number): void {
    const lane = this.lanes[pool][index];
    if (lane === undefined) return;
    if (lane.job !== null) this.release(lane);
    lane.worker.terminate();
    this.lanes[pool].splice(index, 1);
    this.pump(pool);
  }

  private send(lane: Lane, message: ToWorker): void {
    lane.worker.postMessage(message);
  }
}

function reply({ answer, arrays, data }: Answered): Reply {
  const views: Record<string, Float32Array> = {};
  for (const [name, [first, count]] of Object.entries(arrays)) views[name] = new Float32Array(data, first * 4, count);
  return { answer, arrays: views } as Reply;
}

/** The one engine of the page. */
export const engine = new Engine(new URL("gonio.wasm", document.baseURI).href);
