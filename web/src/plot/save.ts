/** What a view shows, as a file: SVG with its looks written into it, PNG, CSV. */

/** What of a style sheet a drawing needs to look the same without it. */
const LOOKS = [
  "fill",
  "fill-opacity",
  "stroke",
  "stroke-width",
  "stroke-dasharray",
  "stroke-linecap",
  "stroke-linejoin",
  "stroke-opacity",
  "opacity",
  "font-family",
  "font-size",
  "font-weight",
  "text-anchor",
  "dominant-baseline",
  "paint-order",
] as const;

const SVG = "http://www.w3.org/2000/svg";

/** A line of a legend: what it looks like and what it is called. */
export interface Entry {
  colour: string;
  dash: string;
  text: string;
}

/** The drawing as a file of its own, on the page's ground, with a legend below; elements of class `aside` are left out. */
export function svgText(svg: SVGSVGElement, legend: Entry[], ground: string, ink: string): string {
  const { width, height } = svg.viewBox.baseVal;
  const copy = svg.cloneNode(true) as SVGSVGElement;
  dress(svg, copy);
  for (const aside of copy.querySelectorAll(".aside")) aside.remove();
  const total = height + (legend.length > 0 ? 18 * legend.length + 8 : 0);
  copy.setAttribute("xmlns", SVG);
  copy.setAttribute("width", String(width));
  copy.setAttribute("height", String(total));
  copy.setAttribute("viewBox", `0 0 ${width} ${total}`);
  const add = (name: string, values: Record<string, string | number>, before: Node | null = null): Element => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(values)) made.setAttribute(key, String(value));
    copy.insertBefore(made, before);
    return made;
  };
  add("rect", { width, height: total, fill: ground }, copy.firstChild);
  legend.forEach((entry, k) => {
    const y = height + 18 * k + 9;
    add("line", { x1: 12, x2: 40, y1: y, y2: y, stroke: entry.colour, "stroke-width": 2, "stroke-dasharray": entry.dash || "none" });
    const text = add("text", { x: 48, y, fill: ink, "font-size": 12, "font-family": "sans-serif", "dominant-baseline": "central" });
    text.textContent = entry.text;
  });
  return new XMLSerializer().serializeToString(copy);
}

function dress(from: Element, to: Element): void {
  const style = getComputedStyle(from);
  for (const look of LOOKS) to.setAttribute(look, style.getPropertyValue(look));
  to.removeAttribute("class");
  if (from.classList.contains("aside")) to.setAttribute("class", "aside");
  for (const name of ["tabindex", "role", "style"]) to.removeAttribute(name);
  for (let k = 0; k < from.children.length; k += 1) dress(from.children[k]!, to.children[k]!);
}

/** A drawing as pixels, `density` for each of its own. */
export async function pngOfSvg(text: string, density = 2): Promise<Blob> {
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = image.naturalWidth * density;
    canvas.height = image.naturalHeight * density;
    canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await pngOfCanvas(canvas);
  } finally {
    URL.revokeObjectURL(address);
  }
}

export function pngOfCanvas(canvas: HTMLCanvasElement): Promise<Blob> {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob === null ? reject(new Error(`a picture of ${canvas.width} × ${canvas.height} pixels can't be encoded`)) : resolve(blob)));
  });
}

/** Pictures side by side, as one. */
export function beside(canvases: HTMLCanvasElement[], ground: string): HTMLCanvasElement {
  const all = document.createElement("canvas");
  const gap = 8;
  all.width = canvases.reduce((sum, c) => sum + c.width + gap, -gap);
  all.height = Math.max(...canvases.map((c) => c.height));
  const context = all.getContext("2d")!;
  context.fillStyle = ground;
  context.fillRect(0, 0, all.width, all.height);
  let x = 0;
  for (const canvas of canvases) {
    context.drawImage(canvas, x, 0);
    x += canvas.width + gap;
  }
  return all;
}

export type Row = readonly (number | string)[];

/** A table (RFC 4180): the names of the columns, then the rows. Numbers are written with all digits that 32 bits have. */
export function csvText(columns: string[], rows: Iterable<Row>): string {
  const text = (x: string): string => (/[",\r\n]/.test(x) ? `"${x.replace(/"/g, '""')}"` : x);
  const cell = (x: number | string): string => (typeof x === "string" ? text(x) : Number.isFinite(x) ? String(Number(x.toPrecision(9))) : Number.isNaN(x) ? "" : String(x));
  const lines = [columns, ...rows].map((row) => row.map(cell).join(","));
  return lines.join("\r\n") + "\r\n";
}

/** Hands a file to the person. */
export function hand(name: string, content: Blob | string, type = "text/plain"): void {
  const address = URL.createObjectURL(typeof content === "string" ? new Blob([content], { type }) : content);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  // Some browsers read the address only after the click's task.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
