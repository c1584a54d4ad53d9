/**
 * Answers of the engine that follow the state: a view says what it wants, and finds what was answered last.
 *
 * What is wanted anew while a call runs replaces what waits, so a drag never queues up work; every answer that arrives is shown.
 */
import { effect, signal, untracked } from "@preact/signals";
import { engine, EngineError, type Pool } from "../engine/client";
import type { Complaint, Operation, Reply, Requests } from "../engine/protocol";
import { functions, phiD, scale, type Shown, turn, type ViewName, wi } from "../state";

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
const CALM = 160;

/** False while something is dragged or a slider moves: what takes longer than a frame is drawn coarsely then. */
export const settled = signal(true);
let calm = 0;
effect(() => {
  void [wi.value, functions.value, phiD.value, scale.value, turn.value];
  settled.value = false;
  clearTimeout(calm);
  calm = setTimeout(() => (settled.value = true), CALM);
});

export interface Wish<K extends Operation> {
  key: string;
  request: Requests[K]["request"];
  /** Of which function it is. */
  shown: Shown;
}

export interface Answer<K extends Operation> extends Reply<K> {
  request: Requests[K]["request"];
  /** When what is answered was set. */
  since: number;
}

export class Live<K extends Operation> {
  readonly answers = signal<ReadonlyMap<string, Answer<K>>>(new Map());
  readonly complaints = signal<ReadonlyMap<string, Complaint>>(new Map());
  private readonly asked = new Map<string, { text: string; changed: number | undefined }>();

  /** `wanted` reads the state; null while nobody looks, and then nothing changes. */
  constructor(
    private readonly operation: K,
    private readonly pool: Pool,
    wanted: () => Wish<K>[] | null,
    /** Tells apart the requests of different views that want the same operation. */
    private readonly name: string = operation,
  ) {
    effect(() => {
      const wishes = wanted();
      if (wishes !== null) untracked(() => this.follow(wishes));
    });
  }

  private follow(wishes: Wish<K>[]): void {
    const since = performance.now();
    const keys = new Set(wishes.map((w) => w.key));
    const gone = [...this.asked.keys()].filter((key) => !keys.has(key));
    if (gone.length > 0) {
      for (const key of gone) {
        this.asked.delete(key);
        engine.drop(this.pool, `${this.name}/${key}/`);
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
      void this.ask(wish, changed !== undefined && changed !== before?.changed ? changed : since);
    }
  }

  private async ask({ key, request }: Wish<K>, since: number): Promise<void> {
    try {
      const reply = await engine.ask(this.operation, request, { pool: this.pool, key: `${this.name}/${key}/` });
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
