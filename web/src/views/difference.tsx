import type { JSX } from "preact";

export function Difference(): JSX.Element {
  return <h2>Difference</h2>;
}
