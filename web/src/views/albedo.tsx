import type { JSX } from "preact";

export function Albedo(): JSX.Element {
  return <h2>Directional albedo</h2>;
}
