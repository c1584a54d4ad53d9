/** The path of a line through many points, as text for an SVG. */

/** Pixels by which the path may pass beside a point: nobody sees so little, and it takes a fraction of the time to draw. */
const TOLERANCE = 0.08;
/** Points that one straight piece passes at most. */
const LONGEST = 40;

/** A place, to a tenth of a pixel. */
const tenth = (x: number): number => Math.round(10 * x) / 10;

/** Through the points in order; one that is not finite breaks the line. */
export function outline(xs: Float64Array, ys: Float64Array): string {
  let text = "";
  let from = -1;
  for (let k = 0; k < xs.length; k += 1) {
    if (!Number.isFinite(xs[k]! + ys[k]!)) {
      from = -1;
      continue;
    }
    const straight = from >= 0 && k + 1 < xs.length && k + 1 - from <= LONGEST && near(xs, ys, from, k + 1);
    if (straight) continue;
    text += `${from < 0 ? "M" : "L"}${tenth(xs[k]!)} ${tenth(ys[k]!)}`;
    from = k;
  }
  return text;
}

/** Whether all points between two are near the straight piece from the one to the other. */
function near(xs: Float64Array, ys: Float64Array, from: number, to: number): boolean {
  const [x, y] = [xs[from]!, ys[from]!];
  const [dx, dy] = [xs[to]! - x, ys[to]! - y];
  const length = dx * dx + dy * dy;
  for (let k = from + 1; k < to; k += 1) {
    const [px, py] = [xs[k]! - x, ys[k]! - y];
    const share = length > 0 ? Math.min(Math.max((px * dx + py * dy) / length, 0), 1) : 0;
    const [ex, ey] = [px - share * dx, py - share * dy];
    // An end that is not finite makes the comparison false: the piece ends before it.
    if (!(ex * ex + ey * ey <= TOLERANCE * TOLERANCE)) return false;
  }
  return true;
}
