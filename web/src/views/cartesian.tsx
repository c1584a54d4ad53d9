import type { JSX } from "preact";

export function Cartesian(): JSX.Element {
  return <h2>f against the angle</h2>;
}
