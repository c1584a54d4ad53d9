/** A bar that says which colour stands for which value. */
import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import type { RGB } from "../plot/colours";

export interface BarTick {
  /** From 0 at the bottom to 1 at the top. */
  position: number;
  label: string;
}

/** Room that a bar with its labels takes. */
export const BAR = 64;

export function Bar({ height, name, ticks, colourAt }: { height: number; name: string; ticks: BarTick[]; colourAt: (position: number) => RGB }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  useLayoutEffect(() => {
    const context = canvas.current!.getContext("2d")!;
    const image = context.createImageData(1, 256);
    for (let k = 0; k < 256; k += 1) image.data.set([...colourAt(1 - k / 255), 255], 4 * k);
    context.putImageData(image, 0, 0);
  });
  let last = Infinity;
  return (
    <div class="bar-of-colours" style={{ height: `${height}px` }}>
      <canvas ref={canvas} width={1} height={256} role="img" aria-label={`Colours of ${name}`} />
      {ticks
        .filter((t) => t.label !== "")
        .map((t) => {
          const y = height * (1 - t.position);
          if (Math.abs(last - y) < 14) return null;
          last = y;
          return (
            <span key={t.label} class="bar-label" style={{ top: `${y}px` }}>
              {t.label}
            </span>
          );
        })}
    </div>
  );
}
