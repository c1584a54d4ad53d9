import type { JSX } from "preact";

export function Slice(): JSX.Element {
  return <h2>Slice θh × θd</h2>;
}
