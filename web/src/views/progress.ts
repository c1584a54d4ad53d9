/**
 * Pictures that are rendered little by little: samples of every pixel, in all of the pool's workers, which add up to the picture that the
 * command renders. While something moves, small pictures of one sample follow it.
 */
import { signal } from "@preact/signals";
import { engine, EngineError } from "../engine/client";
import { loadAssets, SCENE } from "../engine/assets";
import type { Complaint, Requests } from "../engine/protocol";
import { stir } from "./timings";

/** What is pictured: a request but for the size and the samples. */
export type Motif = Omit<Requests["render"]["request"], "width" | "height" | "first" | "count">;

export interface Film {
  width: number;
  height: number;
  /** 3 a pixel: sums over the samples. */
  sums: Float32Array;
  samples: number;
  /** Samples that were not finite, and are left out. */
  rejected: number;
  /** When what it shows was set. */
  since: number;
}

interface Painting {
  key: string;
  motif: Motif;
  since: number;
  changed: number | undefined;
  generation: number;
  width: number;
  height: number;
  /** Samples that were asked for; −1 before the small picture. */
  asked: number;
  /** Samples a call, so that one takes about `CALL`. */
  count: number;
  film: Film | null;
}

/** How long a call should take, milliseconds: the next change waits for it. */
const CALL = 120;
/** The small picture is smaller by this along each side. */
const SMALL = 4;

export class Progress {
  readonly films = signal<ReadonlyMap<string, Film>>(new Map());
  readonly complaints = signal<ReadonlyMap<string, Complaint>>(new Map());
  private readonly paintings = new Map<string, Painting>();
  private running = 0;
  private generation = 0;
  private samples = 0;
  private fine = true;

  /** What is to be pictured now; what is the same as before goes on. `fine` is false while something moves. */
  follow(motifs: { key: string; motif: Motif; version: string; changed: number | undefined }[], size: { width: number; height: number }, samples: number, fine: boolean): void {
    this.samples = samples;
    this.fine = fine;
    const kept = new Set(motifs.map((m) => m.key));
    for (const key of [...this.paintings.keys()]) if (!kept.has(key)) this.remove(key);
    const now = performance.now();
    for (const { key, motif, version, changed } of motifs) {
      const text = `${version} ${size.width} ${size.height} ${JSON.stringify(motif)}`;
      const before = this.paintings.get(key);
      if (before?.key === text) continue;
      engine.drop("render", `${key}/`);
      this.generation += 1;
      const painting: Painting = { key: text, motif, since: changed !== undefined && changed !== before?.changed ? changed : now, changed, generation: this.generation, ...size, asked: -1, count: 1, film: null };
      this.paintings.set(key, painting);
    }
    this.pump();
  }

  /** Begins nothing new until `follow` is called again. */
  rest(): void {
    this.fine = false;
  }

  private remove(key: string): void {
    this.paintings.delete(key);
    engine.drop("render", `${key}/`);
    if (this.films.value.has(key)) {
      const films = new Map(this.films.value);
      films.delete(key);
      this.films.value = films;
    }
    this.complain(key, null);
  }

  private complain(key: string, complaint: Complaint | null): void {
    if (complaint === null && !this.complaints.value.has(key)) return;
    const all = new Map(this.complaints.value);
    if (complaint === null) all.delete(key);
    else all.set(key, complaint);
    this.complaints.value = all;
  }

  /** Gives work to as many workers as there are: to what has least samples first. */
  private pump(): void {
    while (this.running < engine.width("render")) {
      let next: [string, Painting] | null = null;
      for (const entry of this.paintings) {
        const painting = entry[1];
        const open = painting.asked < 0 || (this.fine && painting.asked < this.samples);
        if (open && (next === null || painting.asked < next[1].asked)) next = entry;
      }
      if (next === null) return;
      this.running += 1;
      void this.call(...next).finally(() => {
        this.running -= 1;
        this.pump();
      });
    }
  }

  private async call(key: string, painting: Painting): Promise<void> {
    const small = painting.asked < 0;
    const count = small ? 1 : Math.min(painting.count, this.samples - painting.asked);
    const first = small ? 0 : painting.asked;
    painting.asked = small ? 0 : painting.asked + count;
    const width = small ? Math.max(1, Math.round(painting.width / SMALL)) : painting.width;
    const height = small ? Math.max(1, Math.round(painting.height / SMALL)) : painting.height;
    try {
      await load(painting.motif);
      const start = performance.now();
      stir();
      const reply = await engine.ask("render", { ...painting.motif, width, height, first, count }, { pool: "render", key: `${key}/${painting.generation}/${first}/${small}` });
      stir();
      if (reply === null || this.paintings.get(key) !== painting) return;
      if (!small) painting.count = Math.max(1, Math.min(16, Math.round((CALL * count) / Math.max(1, performance.now() - start))));
      this.add(key, painting, { width, height, sums: reply.arrays["sums"]!, samples: count, rejected: reply.answer.rejected, since: painting.since }, small);
      this.complain(key, null);
    } catch (error) {
      if (this.paintings.get(key) !== painting) return;
      // What fails once fails again: it is tried anew when something changes.
      painting.asked = Infinity;
      this.complain(key, error instanceof EngineError ? error.complaint : { message: String(error), help: null, place: null });
    }
  }

  private add(key: string, painting: Painting, part: Film, small: boolean): void {
    let film = part;
    if (!small) {
      if (painting.film !== null) {
        const { sums, samples, rejected } = painting.film;
        for (let k = 0; k < sums.length; k += 1) sums[k]! += part.sums[k]!;
        film = { ...part, sums, samples: samples + part.samples, rejected: rejected + part.rejected };
      }
      painting.film = film;
    } else if (painting.film !== null) return;
    this.films.value = new Map(this.films.value).set(key, film);
  }
}

async function load(motif: Motif): Promise<void> {
  const names: string[] = motif.object === "preview" ? [...SCENE] : [];
  // The scene names its own panorama, whatever light is asked for.
  if (motif.object === "preview") names.push("sunset.hdr");
  if (motif.light.startsWith("files/")) names.push(motif.light.slice("files/".length));
  await loadAssets(names);
}
