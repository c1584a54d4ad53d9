/** What the page opens with. */
import { add } from "./functions";

export function start(): void {
  add("ggx:metal=gold,roughness=0.3");
}
