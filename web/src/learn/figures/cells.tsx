/** The hemisphere seen from above, in cells of θ and φ, each as strong as its value. */
import type { JSX } from "preact";
import { Drawing } from "../figure";

interface Props {
  label: string;
  /** Rings; each has four times as many cells. */
  steps: number;
  /** One a cell, θ outer. */
  values: ArrayLike<number> | undefined;
}

export function Cells({ label, steps, values }: Props): JSX.Element {
  return (
    <Drawing ratio={1.35} label={label}>
      {({ width, height }) => {
        const radius = Math.min(width, height) / 2 - 8;
        const [cx, cy] = [width / 2, height / 2];
        const around = 4 * steps;
        // The values of another number of steps are no values of these cells.
        const known = values !== undefined && values.length === steps * around ? values : null;
        let largest = 0;
        if (known !== null) for (let i = 0; i < known.length; i += 1) largest = Math.max(largest, known[i]!);
        const at = (i: number, j: number): string => {
          const [r, phi] = [(radius * i) / steps, (2 * Math.PI * j) / around];
          return `${(cx + r * Math.cos(phi)).toFixed(1)} ${(cy - r * Math.sin(phi)).toFixed(1)}`;
        };
        const ringAt = (i: number): string => ((radius * i) / steps).toFixed(1);
        return (
          <>
            <circle class="globe" cx={cx} cy={cy} r={radius} />
            <g class="light">
              {known === null
                ? null
                : Array.from({ length: known.length }, (_, k) => {
                    const [i, j] = [Math.floor(k / around), k % around];
                    return (
                      <path
                        key={k}
                        class="cell"
                        fill-opacity={largest > 0 ? (0.06 + 0.94 * (known[k]! / largest)).toFixed(3) : "0.06"}
                        d={`M${at(i, j)}L${at(i + 1, j)}A${ringAt(i + 1)} ${ringAt(i + 1)} 0 0 0 ${at(i + 1, j + 1)}L${at(i, j + 1)}A${ringAt(i)} ${ringAt(i)} 0 0 1 ${at(i, j)}Z`}
                      />
                    );
                  })}
            </g>
          </>
        );
      }}
    </Drawing>
  );
}
