/**
 * Continues the pixels of a disc, which fills its square, a little beyond its rim: the style sheet cuts it round then, with a smooth edge,
 * where pixels can only be inside or outside.
 */
export function continueRim(out: Uint8ClampedArray, side: number): void {
  const middle = (side - 1) / 2;
  const radius = side / 2;
  for (let y = 0; y < side; y += 1) {
    for (let x = 0; x < side; x += 1) {
      const at = 4 * (y * side + x);
      const r = Math.hypot(x - middle, y - middle);
      if (out[at + 3] !== 0 || r > radius + 1.5) continue;
      // Towards the centre, to where the disc is for certain.
      const inward = (radius - 1.5) / r;
      const from = 4 * (Math.round(middle + (y - middle) * inward) * side + Math.round(middle + (x - middle) * inward));
      out.copyWithin(at, from, from + 4);
    }
  }
}
