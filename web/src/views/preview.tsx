import type { JSX } from "preact";

export function Preview(): JSX.Element {
  return <h2>Preview</h2>;
}
