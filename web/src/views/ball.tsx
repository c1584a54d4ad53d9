import type { JSX } from "preact";

export function Ball(): JSX.Element {
  return <h2>Lit ball</h2>;
}
