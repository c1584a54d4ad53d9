/** A picture that the engine made, on a canvas. */
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { continueRim } from "../plot/rim";
import { picture } from "../plot/tone";

interface Props {
  label: string;
  /** 3 a pixel, linear; null while nothing was answered yet. */
  values: ArrayLike<number> | null;
  width: number;
  height: number;
  exposure?: number;
  /** How the values become colours, where not as light. */
  paint?: (out: Uint8ClampedArray, values: ArrayLike<number>) => void;
  name?: string;
}

export function Picture({ label, values, width, height, exposure = 0, paint, name }: Props): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  // A disc has nothing in the corners of its square.
  const round = paint === undefined && width === height && Number.isNaN(values?.[0]);
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (context == null || values === null || values.length !== 3 * width * height) return;
    const image = context.createImageData(width, height);
    if (paint !== undefined) paint(image.data, values);
    else picture(image.data, values, 2 ** exposure, "srgb");
    if (round) continueRim(image.data, width);
    context.putImageData(image, 0, 0);
  }, [values, width, height, exposure, paint, round]);
  return (
    <div class={round ? "learn-picture round" : "learn-picture"}>
      <canvas ref={canvas} width={width} height={height} role="img" aria-label={label} />
      {name !== undefined ? <span class="learn-picture-name">{name}</span> : null}
    </div>
  );
}
