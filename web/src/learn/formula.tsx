/** A formula, with the number that it has in the theory. */
import { h, type JSX, type VNode } from "preact";
import { formula, type Node } from "./math";

const built = ([name, content, attributes]: Node): VNode => h(name, attributes ?? null, typeof content === "string" ? content : content.map(built));

export function Formula({ children, number }: { children: string; number?: string | undefined }): JSX.Element {
  return (
    <div class="learn-formula">
      <div class="learn-formula-scroll" tabIndex={0} role="group" aria-label="Formula">
        {built(formula(children))}
      </div>
      {number !== undefined ? <span class="learn-formula-number">({number})</span> : null}
    </div>
  );
}
