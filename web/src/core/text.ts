/**
 * Descriptions as text: only what the page needs to edit one part of a composite, as in `sum(lambertian:0.4, ggx:f0=0.04,roughness=0.2)`.
 * What a description means is the library's to say.
 */

export interface Part {
  from: number;
  to: number;
  text: string;
}

export interface Composite {
  name: string;
  /** What is before the first model: shares, colours and parameters of the composite itself. */
  own: string;
  parts: Part[];
}

/** The pieces between commas outside of parentheses, without the spaces around them; null if parentheses don't match. */
function pieces(text: string, from: number, to: number): Part[] | null {
  const found: Part[] = [];
  let depth = 0;
  let start = from;
  const end = (at: number): void => {
    const raw = text.slice(start, at);
    const left = raw.length - raw.trimStart().length;
    found.push({ from: start + left, to: start + left + raw.trim().length, text: raw.trim() });
  };
  for (let at = from; at < to; at++) {
    const c = text[at];
    if (c === "(") depth++;
    else if (c === ")") {
      depth--;
      if (depth < 0) return null;
    } else if (c === "," && depth === 0) {
      end(at);
      start = at + 1;
    }
  }
  if (depth !== 0) return null;
  end(to);
  return found;
}

const SETTING = /^[A-Za-z_][\w-]*\s*=/;
const VALUE = /^(#[0-9a-fA-F]+|[-+]?[\d.][\d.eE+\-/]*)$/;

/** The composite's parts, or null for what is no composite or is unfinished. */
export function composite(text: string): Composite | null {
  const head = /^\s*([a-z][\w-]*)\s*\(/.exec(text);
  const trimmed = text.trimEnd();
  if (head === null || !trimmed.endsWith(")")) return null;
  const first = head[0].length;
  const all = pieces(text, first, trimmed.length - 1);
  if (all === null) return null;
  const parts: Part[] = [];
  for (const piece of all) {
    const last = parts[parts.length - 1];
    if (SETTING.test(piece.text)) {
      // A setting belongs to the model before it.
      if (last !== undefined) {
        last.to = piece.to;
        last.text = text.slice(last.from, last.to);
      }
    } else if (!(last === undefined && VALUE.test(piece.text)) && piece.text !== "") parts.push({ ...piece });
  }
  const own = text.slice(first, parts[0]?.from ?? trimmed.length - 1).replace(/[\s,]+$/, "").trim();
  return { name: head[1]!, own, parts };
}

/** The composite's text with another model as its part `index`. */
export function replacePart(text: string, index: number, part: string): string {
  const found = composite(text)?.parts[index];
  return found === undefined ? text : text.slice(0, found.from) + part.trim() + text.slice(found.to);
}

/** The composite's text without its part `index`; unchanged if it is the only one. */
export function removePart(text: string, index: number): string {
  const whole = composite(text);
  if (whole === null || whole.parts.length < 2 || whole.parts[index] === undefined) return text;
  return assemble(whole.name, whole.own, whole.parts.filter((_, i) => i !== index).map((part) => part.text));
}

export function addPart(text: string, part: string): string {
  const whole = composite(text);
  return whole === null ? text : assemble(whole.name, whole.own, [...whole.parts.map((p) => p.text), part.trim()]);
}

function assemble(name: string, own: string, parts: string[]): string {
  return `${name}(${[...(own === "" ? [] : [own]), ...parts].join(", ")})`;
}

/** Names of the files that a description speaks of. */
export function filesIn(text: string): string[] {
  return [...new Set([...text.matchAll(/files\/([\w.-]+)/g)].map((match) => match[1]!))];
}

/**
 * A name for a file in the engine's folder: what would mean something in a description becomes `-`, and a taken name gets a number, so that nothing
 * that is held already is replaced.
 */
export function fileName(name: string, taken: (name: string) => boolean): string {
  const clean = name.normalize("NFC").replace(/^.*[/\\]/, "").replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[.-]+/, "") || "file";
  const dot = clean.lastIndexOf(".");
  const [stem, extension] = dot > 0 ? [clean.slice(0, dot), clean.slice(dot).toLowerCase()] : [clean, ""];
  let result = stem + extension;
  for (let n = 2; taken(result); n++) result = `${stem}-${n}${extension}`;
  return result;
}

/** A number as short as it can be without losing what a control can set. */
export function short(x: number): string {
  return String(Number(x.toPrecision(6)));
}

/** A colour as descriptions have it. */
export function colourText(rgb: readonly [number, number, number]): string {
  const [r, g, b] = rgb;
  return r === g && g === b ? short(r) : `${short(r)}/${short(g)}/${short(b)}`;
}

/** A colour that is written as numbers, or null. */
export function parseColour(text: string): [number, number, number] | null {
  const parts = text.split("/").map((part) => (part.trim() === "" ? NaN : Number(part)));
  if (!parts.every(Number.isFinite)) return null;
  if (parts.length === 1) return [parts[0]!, parts[0]!, parts[0]!];
  return parts.length === 3 ? [parts[0]!, parts[1]!, parts[2]!] : null;
}

/** A name that stands for a model with some parameters set. */
export interface Alias {
  name: string;
  model: string;
  sets: [string, string][];
}

/**
 * A description's short name and the rest of it, for lists: `torrance-sparrow:distribution=ggx,metal=gold` is `ggx`, `metal=gold`. Only for show; what is asked of the library
 * is the whole text.
 */
export function shortName(text: string, aliases: readonly Alias[]): [string, string] {
  const whole = composite(text);
  if (whole !== null) {
    const parts = whole.parts.map((part) => shortName(part.text, aliases)[0]);
    return [whole.name, [...(whole.own === "" ? [] : [whole.own]), ...parts].join(", ")];
  }
  const plain = text.replace(/^files\//, "");
  const colon = plain.indexOf(":");
  if (colon < 0) return [plain, ""];
  const model = plain.slice(0, colon);
  const settings = plain.slice(colon + 1).split(",");
  let best: Alias | null = null;
  for (const alias of aliases) {
    if (alias.model !== model || alias.sets.length <= (best?.sets.length ?? 0)) continue;
    if (alias.sets.every(([key, value]) => settings.includes(`${key}=${value}`))) best = alias;
  }
  // Of tables and shaders the file is the name.
  const file = settings.find((setting) => setting.startsWith("file="));
  if (file !== undefined) return [file.replace(/^file=(files\/)?/, ""), settings.filter((setting) => setting !== file).join(", ")];
  if (best === null) return [model, settings.join(", ")];
  const implied = new Set(best.sets.map(([key, value]) => `${key}=${value}`));
  return [best.name, settings.filter((setting) => !implied.has(setting)).join(", ")];
}
