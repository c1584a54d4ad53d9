/**
 * Answers of the engine that follow the state: a view says what it wants, and finds what was answered last.
 *
 * What is wanted anew while a call runs replaces what waits, so a drag never queues up work; every answer that arrives is shown.
 */
import { computed, effect, signal, untracked } from "@preact/signals";
import { engine, EngineError, type Pool } from "../engine/client";
import type { Complaint, Operation, Reply, Requests } from "../engine/protocol";
import { functions, phiD, scale, type Shown, turn, type ViewName, wi } from "../state";
import { begun, pressed } from "./timings";

/** Whether a view can be seen: not scrolled away nor behind a large one. Views that can't ask for nothing. */
export const seen: Record<ViewName, { value: boolean }> = {
  lobe: signal(false),
  polar: signal(false),
  cartesian: signal(false),
  slice: signal(false),
  albedo: signal(false),
  ball: signal(false),
  preview: signal(false),
  difference: signal(false),
};

/** How often what comes second follows a drag on a slow machine, milliseconds. */
const PAUSE = 250;

/** How long nothing may change until pictures are made as fine as they can be shown, milliseconds. */
const CALM = 300;

/** False while something is dragged or a slider moves: what takes longer than a frame is drawn coarsely then. */
export const settled = signal(true);
const moving = computed(() => JSON.stringify([functions.value.map((f) => [f.text, f.revision]), wi.value, phiD.value, scale.value, turn.value]));
let calm = 0;
effect(() => {
  void moving.value;
  settled.value = false;
  clearTimeout(calm);
  calm = setTimeout(() => (settled.value = true), CALM);
});

export interface Wish<K extends Operation> {
  key: string;
  request: Requests[K]["request"];
  /** Of which function it is. */
  shown: Shown;
  /** Whether it only makes finer what is there already. */
  fine?: boolean;
}

export interface Answer<K extends Operation> extends Reply<K> {
  request: Requests[K]["request"];
  /** When what is answered was set; 0 where it is only finer than what was there. */
  since: number;
}

export class Live<K extends Operation> {
  readonly answers = signal<ReadonlyMap<string, Answer<K>>>(new Map());
  readonly complaints = signal<ReadonlyMap<string, Complaint>>(new Map());
  private readonly asked = new Map<string, { text: string; changed: number | undefined }>();
  /** Whether it comes after the plots: from another worker, and less often where they would suffer. */
  private readonly second: boolean;
  private readonly how: { pool: Pool; early: boolean };
  private later = 0;
  private followed = 0;

  /** `wanted` reads the state; null while nobody looks, and then nothing changes. */
  constructor(
    private readonly operation: K,
    wanted: () => Wish<K>[] | null,
  ) {
    this.second = operation !== "curve" && operation !== "evaluate";
    // What follows a drag goes before what only follows a slider.
    this.how = { pool: this.second ? "slow" : "fast", early: operation !== "albedo" && operation !== "slice" };
    effect(() => {
      if (this.second && !begun.value) return;
      const wishes = wanted();
      clearTimeout(this.later);
      if (wishes !== null) untracked(() => this.take(wishes));
    });
  }

  private take(wishes: Wish<K>[]): void {
    const since = performance.now();
    if (!this.second || !pressed() || wishes.some((w) => w.fine === true) || since - this.followed > PAUSE) this.follow(wishes, since);
    else this.later = setTimeout(() => this.follow(wishes, since), PAUSE - (since - this.followed));
  }

  private follow(wishes: Wish<K>[], since: number): void {
    this.followed = performance.now();
    const keys = new Set(wishes.map((w) => w.key));
    const gone = [...this.asked.keys()].filter((key) => !keys.has(key));
    if (gone.length > 0) {
      for (const key of gone) {
        this.asked.delete(key);
        engine.drop(this.how.pool, `${this.operation}/${key}/`);
      }
      this.answers.value = without(this.answers.value, gone);
      this.complaints.value = without(this.complaints.value, gone);
    }
    for (const wish of wishes) {
      const { changed, revision } = wish.shown;
      const text = `${revision} ${JSON.stringify(wish.request)}`;
      const before = this.asked.get(wish.key);
      if (before?.text === text) continue;
      this.asked.set(wish.key, { text, changed });
      // A description is what the library made of a slider that was moved some time before.
      const set = changed !== undefined && changed !== before?.changed ? changed : since;
      void this.ask(wish, wish.fine === true ? 0 : set);
    }
  }

  private async ask({ key, request }: Wish<K>, since: number): Promise<void> {
    try {
      const reply = await engine.ask(this.operation, request, { ...this.how, key: `${this.operation}/${key}/` });
      if (reply === null || !this.asked.has(key)) return;
      if (this.complaints.value.has(key)) this.complaints.value = without(this.complaints.value, [key]);
      this.answers.value = new Map(this.answers.value).set(key, { ...reply, request, since });
    } catch (error) {
      if (!this.asked.has(key)) return;
      const complaint = error instanceof EngineError ? error.complaint : { message: String(error), help: null, place: null };
      this.complaints.value = new Map(this.complaints.value).set(key, complaint);
      this.answers.value = without(this.answers.value, [key]);
    }
  }
}

function without<V>(map: ReadonlyMap<string, V>, keys: string[]): ReadonlyMap<string, V> {
  if (!keys.some((key) => map.has(key))) return map;
  const left = new Map(map);
  for (const key of keys) left.delete(key);
  return left;
}
