/**
 * Answers of the engine that follow the state: a view says what it wants, and finds what was answered last.
 *
 * What is wanted anew while a call runs replaces what waits, so a drag never queues up work; every answer that arrives is shown,
 * unless a newer one was before it.
 */
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { engine, EngineError, type Pool } from "../engine/client";
import type { Along, Complaint, Operation, Reply, Requests } from "../engine/protocol";
import { companions } from "../functions";
import { functions, phiD, scale, type Shown, turn, type ViewName, wi } from "../state";
import { begun, stir } from "./timings";

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
  /** Counts what was asked; an older answer never takes the place of a newer one. */
  private turn = 0;
  private readonly shown = new Map<string, number>();
  /** Whether it comes after the plots, from another worker. */
  private readonly second: boolean;
  private readonly how: { pool: Pool; early: boolean };

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
      if (wishes !== null) untracked(() => this.follow(wishes));
    });
    if (!this.second) companions.push((id) => this.along(untracked(wanted)?.find((wish) => wish.shown.id === id)));
  }

  /** The same question of what the function becomes. */
  private along(wish: Wish<K> | undefined) {
    if (wish === undefined) return null;
    const { key, request, shown } = wish;
    const turn = ++this.turn;
    return {
      along: { operation: this.operation, request } as Along,
      take: (text: string, answer: Reply | EngineError, changed: number): void => {
        const asked = { ...request, function: text };
        this.asked.set(key, { text: wording(shown, asked), changed });
        this.show(key, turn, asked, answer as Reply<K> | EngineError, changed);
      },
    };
  }

  private follow(wishes: Wish<K>[]): void {
    const since = performance.now();
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
      const { changed } = wish.shown;
      const text = wording(wish.shown, wish.request);
      const before = this.asked.get(wish.key);
      if (before?.text === text) continue;
      this.asked.set(wish.key, { text, changed });
      // A description is what the library made of a slider that was moved some time before.
      const set = changed !== undefined && changed !== before?.changed ? changed : since;
      void this.ask(wish, wish.fine === true ? 0 : set);
    }
  }

  private async ask({ key, request }: Wish<K>, since: number): Promise<void> {
    const turn = ++this.turn;
    if (this.second) stir();
    const answer = await engine.ask(this.operation, request, { ...this.how, key: `${this.operation}/${key}/` }).catch((error: unknown) => error);
    if (this.second) stir();
    if (answer !== null) this.show(key, turn, request, answer as Reply<K> | Error, since);
  }

  private show(key: string, turn: number, request: Requests[K]["request"], answer: Reply<K> | Error, since: number): void {
    if (!this.asked.has(key) || turn < (this.shown.get(key) ?? 0)) return;
    this.shown.set(key, turn);
    batch(() => {
      if (answer instanceof Error) {
        const complaint = answer instanceof EngineError ? answer.complaint : { message: String(answer), help: null, place: null };
        this.complaints.value = new Map(this.complaints.value).set(key, complaint);
        this.answers.value = without(this.answers.value, [key]);
      } else {
        this.complaints.value = without(this.complaints.value, [key]);
        this.answers.value = new Map(this.answers.value).set(key, { answer: answer.answer, arrays: answer.arrays, request, since });
      }
    });
  }
}

/** What tells one question from another: a file behind the function may have changed too. */
const wording = ({ revision }: Shown, request: unknown): string => `${revision} ${JSON.stringify(request)}`;

function without<V>(map: ReadonlyMap<string, V>, keys: string[]): ReadonlyMap<string, V> {
  if (!keys.some((key) => map.has(key))) return map;
  const left = new Map(map);
  for (const key of keys) left.delete(key);
  return left;
}
