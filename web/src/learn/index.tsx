import type { JSX } from "preact";

export function Learn(): JSX.Element {
  return <main />;
}
