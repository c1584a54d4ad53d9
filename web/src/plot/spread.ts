/** Heights of labels, at least `gap` apart: each as near to where it belongs as its neighbours leave room, the lowest one in its place. */
export function spread(heights: number[], gap: number): number[] {
  const order = heights.map((_, k) => k).filter((k) => Number.isFinite(heights[k])).sort((a, b) => heights[b]! - heights[a]!);
  const placed = [...heights];
  let limit = Infinity;
  for (const k of order) {
    placed[k] = Math.min(heights[k]!, limit);
    limit = placed[k]! - gap;
  }
  return placed;
}
