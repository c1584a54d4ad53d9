import type { JSX } from "preact";

export function Lobe(): JSX.Element {
  return <h2>Lobe in space</h2>;
}
