/** Pictures of several functions side by side, each with its name. */
import type { ComponentChildren, JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { grid, type Size } from "../plot/grid";
import type { Shown } from "../state";
import { label } from "./label";
import "./pictures.css";

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
  over?: (cell: Size, left: boolean, index: number) => ComponentChildren;
  /** Room below each, pixels. */
  foot?: number;
  /** Whether they are discs. */
  round?: boolean;
}

export function Pictures({ size, aspect, pictures, over, foot = 0, round = false }: PicturesProps): JSX.Element {
  const { columns, cell } = grid(pictures.length, size, aspect, foot);
  return (
    <div class="pictures" style={{ gridTemplateColumns: `repeat(${columns}, ${cell.width}px)` }}>
      {cell.width > 8 &&
        pictures.map((picture, k) => (
          <figure key={picture.shown.id} class="picture" style={{ marginBottom: `${foot}px` }}>
            {pictures.length > 1 && <Name shown={picture.shown} width={cell.width} />}
            <div class={round ? "picture-place round" : "picture-place"} style={{ width: `${cell.width}px`, height: `${cell.height}px` }}>
              <Pixels picture={picture} cell={cell} />
              {over?.(cell, k % columns === 0, k)}
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
