import type { JSX } from "preact";

export function Polar(): JSX.Element {
  return <h2>Plane of incidence</h2>;
}
