/** Values where the pointer is, and what could not be drawn. */
import type { JSX } from "preact";
import type { Operation } from "../engine/protocol";
import { number } from "../plot/scale";
import { visible } from "../state";
import type { Live } from "./live";
import { at, lines, looked } from "./plane";

/** Each curve's value at the angle that the pointer is at. */
export function Reading({ place }: { place: "corner" | "inside" }): JSX.Element | null {
  const angle = looked.value;
  if (angle === null || lines.value.length === 0) return null;
  return (
    <div class={`view-reading ${place}`} aria-hidden="true">
      <span>θr {angle.toFixed(1).replace("-", "−")}°</span>
      {visible.value.map((f) => (
        <span key={f.id} class={`series-${f.colour}`}>
          <span class="view-dot" />
          {lines.value
            .filter((line) => line.shown.id === f.id)
            .map((line) => (
              <b key={line.key} class={line.look}>
                {Number.isFinite(at(line, angle)) ? number(at(line, angle)) : "–"}
              </b>
            ))}
        </span>
      ))}
    </div>
  );
}

/** The complaints of functions that are shown. */
export function complaintsOf<K extends Operation>(live: Live<K>, functions = visible.value): { colour: number; message: string; help: string | null }[] {
  return functions.flatMap((f) => {
    for (const [key, complaint] of live.complaints.value) {
      if (key === String(f.id) || key.startsWith(`${f.id}/`)) return [{ colour: f.colour, message: complaint.message, help: complaint.help }];
    }
    return [];
  });
}
