/** Pictures of several functions side by side, each with its name. */
import type { ComponentChildren, JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import type { Shown } from "../state";
import type { Size } from "./frame";
import { label } from "./label";

/** Room for a name above a picture. */
const NAME = 20;
const GAP = 8;

/** Columns and cell size for `count` pictures of an aspect, as large as can be; `foot` is what each needs below it. */
export function grid(count: number, { width, height }: Size, aspect: number, foot = 0): { columns: number; cell: Size } {
  const name = count > 1 ? NAME : 0;
  let best = { columns: 1, cell: { width: 0, height: 0 } };
  for (let columns = 1; columns <= Math.max(1, count); columns += 1) {
    const rows = Math.ceil(count / columns);
    const w = (width - GAP * (columns + 1)) / columns;
    const h = (height - GAP * (rows + 1)) / rows - name - foot;
    const cell = { width: Math.floor(Math.min(w, h * aspect)), height: Math.floor(Math.min(w, h * aspect) / aspect) };
    if (cell.width > best.cell.width) best = { columns, cell };
  }
  return best;
}

export interface Picture {
  shown: Shown;
  /** Pixels of the picture itself. */
  width: number;
  height: number;
  /** Draws it into sRGB, 4 codes a pixel. */
  paint: (out: Uint8ClampedArray) => void;
  /** What it shows, for those who can't see it. */
  words: string;
}

export interface PicturesProps {
  size: Size;
  aspect: number;
  pictures: Picture[];
  /** What is drawn over a picture; `left` says whether it is the first of a row. */
  over?: (cell: Size, left: boolean) => ComponentChildren;
  /** Room below each, pixels. */
  foot?: number;
}

export function Pictures({ size, aspect, pictures, over, foot = 0 }: PicturesProps): JSX.Element {
  const { columns, cell } = grid(pictures.length, size, aspect, foot);
  return (
    <div class="pictures" style={{ gridTemplateColumns: `repeat(${columns}, ${cell.width}px)` }}>
      {cell.width > 8 &&
        pictures.map((picture, k) => (
          <figure key={picture.shown.id} class="picture" style={{ marginBottom: `${foot}px` }}>
            {pictures.length > 1 && <Name shown={picture.shown} width={cell.width} />}
            <div class="picture-place" style={{ width: `${cell.width}px`, height: `${cell.height}px` }}>
              <Pixels picture={picture} cell={cell} />
              {over?.(cell, k % columns === 0)}
            </div>
          </figure>
        ))}
    </div>
  );
}

export function Name({ shown, width }: { shown: Shown; width: number }): JSX.Element {
  return (
    <figcaption class={`picture-name series-${shown.colour}`} style={{ maxWidth: `${width}px` }} title={shown.text}>
      <span class="view-dot" />
      <span class="picture-text">{label(shown)}</span>
    </figcaption>
  );
}

export function Pixels({ picture, cell }: { picture: Omit<Picture, "shown">; cell: Size }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const { width, height, paint } = picture;
  useLayoutEffect(() => {
    const context = canvas.current!.getContext("2d")!;
    const image = context.createImageData(width, height);
    paint(image.data);
    context.putImageData(image, 0, 0);
  }, [width, height, paint]);
  return <canvas ref={canvas} width={width} height={height} role="img" aria-label={picture.words} style={{ width: `${cell.width}px`, height: `${cell.height}px` }} />;
}
