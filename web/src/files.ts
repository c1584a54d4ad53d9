/**
 * Files that a person brings: measured tables, shaders, panoramas. Each goes into the engine's folder under a name of its own, and the library says
 * whether it can be read; if not, its error is shown and everything stays as it was.
 */
import { signal } from "@preact/signals";
import { loadCatalogue } from "./catalogue";
import { fileName } from "./core/text";
import { engine } from "./engine/client";
import type { Complaint } from "./engine/protocol";
import { add, complaintOf, MOST, refresh } from "./functions";
import { complain, say } from "./notices";
import { tab } from "./panels/tab";
import { functions, light } from "./state";

export type Kind = "measured" | "shader" | "panorama";

export interface Held {
  name: string;
  kind: Kind;
  /** Of a shader, as it is in the editor. */
  source: string | null;
  /** What is wrong with the source; the views keep the last one that worked. */
  problem: Complaint | null;
}

/** What the folder holds beside what comes along with the page. */
export const held = signal<Held[]>([]);
/** Files that a link speaks of and that are still missing. */
export const missing = signal<string[]>([]);

const SHADERS = ["wgsl", "glsl", "frag", "brdf"];
/** More than any measured table that is published, and less than what WebAssembly can hold beside its work. */
const LARGEST = 1 << 30;

function extension(name: string): string {
  return name.slice(name.lastIndexOf(".") + 1).toLowerCase();
}

export function isShader(name: string): boolean {
  return SHADERS.includes(extension(name));
}

export function sourceOf(name: string): string | null {
  return held.value.find((file) => file.name === name)?.source ?? null;
}

async function kindOf(name: string): Promise<Kind | null> {
  if (isShader(name)) return "shader";
  const measured = (await loadCatalogue())?.measured.map((format) => format.extension.replace(/^\./, "").toLowerCase()) ?? [];
  if (measured.includes(extension(name))) return "measured";
  return extension(name) === "hdr" || extension(name) === "exr" ? "panorama" : null;
}

function hold(file: Held): void {
  held.value = [...held.value.filter((other) => other.name !== file.name), file];
}

/** The library's error speaks of the file by its place in the folder. */
function renamed(complaint: Complaint, from: string, to: string): Complaint {
  const replace = (text: string): string => text.split(`files/${from}`).join(to).replace(`${to}: `, "");
  return { ...complaint, message: replace(complaint.message), help: complaint.help === null ? null : replace(complaint.help) };
}

/** Takes files in; those that can't be read are told of, one by one. */
export async function take(files: Iterable<File>): Promise<void> {
  for (const file of files) {
    try {
      await takeOne(file);
    } catch (error) {
      complain(complaintOf(error), file.name);
    }
  }
}

async function takeOne(file: File): Promise<void> {
  if (file.size > LARGEST) {
    complain({ message: `it has ${Math.round(file.size / (1 << 20))} MB`, help: "the explorer reads files of up to 1024 MB; the command reads larger ones", place: null }, file.name);
    return;
  }
  const kind = await kindOf(file.name);
  if (kind === null) {
    const known = (await loadCatalogue())?.measured.map((format) => format.extension.replace(/^\./, "")) ?? [];
    complain(
      {
        message: `its extension ‘${extension(file.name)}’ names no format that is read here`,
        help: `measured files: ${[...new Set(known)].join(", ")}; shaders: ${SHADERS.join(", ")}; panoramas: hdr, exr`,
        place: null,
      },
      file.name,
    );
    return;
  }
  const bytes = new Uint8Array(await file.arrayBuffer());
  const wanted = missing.value.find((name) => name === fileName(file.name, () => false));
  const name = wanted ?? fileName(file.name, (taken) => engine.hasFile(taken));
  engine.putFile(name, bytes);
  try {
    if (kind === "panorama") {
      await engine.ask("panorama", { light: `files/${name}`, width: 16, height: 8 }, { pool: "slow" });
      hold({ name, kind, source: null, problem: null });
      light.value = `files/${name}`;
    } else {
      const reply = await engine.ask("describe", { function: `files/${name}` }, { pool: "fast" });
      // `.brdf` is the extension of shaders and of a measured format; the library tells them apart by what they hold.
      const shader = kind === "shader" && reply?.answer.model !== "table";
      hold({ name, kind: shader ? "shader" : "measured", source: shader ? new TextDecoder().decode(bytes) : null, problem: null });
      if (wanted === undefined) show(name);
    }
  } catch (error) {
    // A shader with a mistake is still worth an editor: its text is kept, and the error stands at its line.
    const problem = complaintOf(error);
    if (kind === "shader" && problem.place !== null) {
      hold({ name, kind, source: new TextDecoder().decode(bytes), problem });
      if (show(name)) {
        tab.value = "source";
        return;
      }
    }
    complain(renamed(problem, name, file.name), file.name);
    return;
  }
  if (wanted !== undefined) {
    missing.value = missing.value.filter((other) => other !== wanted);
    await refresh(wanted);
  }
  say(`${file.name} is open`);
}

function show(name: string): boolean {
  if (add(`files/${name}`) !== null) return true;
  complain({ message: `${MOST} functions are shown, and no more can be told apart`, help: "remove one, then choose the file again", place: null }, name);
  return false;
}

/** A new shader, to be edited. */
export function createShader(name: string, source: string): void {
  if (functions.value.length >= MOST) {
    show(name);
    return;
  }
  const free = fileName(name, (taken) => engine.hasFile(taken));
  putShader(free, source);
  if (show(free)) tab.value = "source";
}

export function putShader(name: string, source: string): void {
  engine.putFile(name, new TextEncoder().encode(source));
  hold({ name, kind: "shader", source, problem: null });
}

/**
 * Tries a shader's new text under another name first, so that the views keep the last one that works; if the library understands it, it takes the old one's place, else
 * its error is the file's `problem`.
 */
export async function editShader(name: string, source: string): Promise<void> {
  const change = (to: Partial<Held>): void => void (held.value = held.value.map((file) => (file.name === name ? { ...file, ...to } : file)));
  const draft = `draft-${name}`;
  change({ source });
  engine.putFile(draft, new TextEncoder().encode(source));
  try {
    const reply = await engine.ask("describe", { function: `files/${draft}` }, { pool: "fast", key: `draft:${name}` });
    if (reply === null) return;
  } catch (error) {
    if (sourceOf(name) === source) change({ problem: renamed(complaintOf(error), draft, name) });
    return;
  }
  if (sourceOf(name) !== source) return;
  change({ problem: null });
  engine.putFile(name, new TextEncoder().encode(source));
  await refresh(name);
}
