/** How fast it is, printed; and that memory does not grow. */
import { expect, open, test } from "./support";

/** The value below which this share of them is. */
const quantile = (values: number[], share: number): number => [...values].sort((a, b) => a - b)[Math.floor(values.length * share)] ?? NaN;
const figures = (values: number[]): string => `${quantile(values, 0.5).toFixed(1)} ms, 90 % within ${quantile(values, 0.9).toFixed(1)} ms`;

test.describe("1440 × 900", () => {
  test.use({ viewport: { width: 1440, height: 900 } });

  test("first picture, and from a slider to redrawn plots", async ({ page }) => {
    await open(page);
    await page.reload();
    await expect(page.locator('.slot[data-view="polar"] path').first()).toBeAttached();
    const first = await page.evaluate(async () => {
      const timings = (): number => Object.values(window.__gonio?.timings ?? {}).flat().length;
      while (timings() === 0) await new Promise((resolve) => setTimeout(resolve, 5));
      const all = Object.values(window.__gonio!.timings).flat() as { since: number; drawn: number }[];
      return Math.min(...all.map((t) => t.since + t.drawn));
    });
    await page.waitForTimeout(1500);
    const slider = page.getByRole("slider", { name: "roughness", exact: true }).first();
    await slider.focus();
    const since = await page.evaluate(() => {
      window.longest = 0;
      new PerformanceObserver((list) => list.getEntries().forEach((entry) => (window.longest = Math.max(window.longest ?? 0, entry.duration)))).observe({ type: "longtask" });
      return performance.now();
    });
    for (let i = 0; i < 20; i += 1) {
      await page.keyboard.press(i % 2 === 0 ? "ArrowRight" : "ArrowLeft");
      await page.waitForTimeout(40);
    }
    await page.waitForTimeout(500);
    const drawn = await page.evaluate((after) => (["polar", "cartesian"] as const).flatMap((name) => (window.__gonio!.timings[name] ?? []).filter((t) => t.since >= after)), since);
    test.info().annotations.push({ type: "first picture", description: `${first.toFixed(0)} ms after navigation, from a warm cache` });
    test.info().annotations.push({ type: "slider to plots", description: `drawn after ${figures(drawn.map((t) => t.drawn))}; on the screen after ${figures(drawn.map((t) => t.painted))}: the middle of ${drawn.length}` });
    const longest = await page.evaluate(() => window.longest ?? 0);
    test.info().annotations.push({ type: "longest task meanwhile", description: longest === 0 ? "below 50 ms" : `${longest.toFixed(0)} ms` });
    expect(drawn.length).toBeGreaterThan(4);
  });
});

test("memory is stable over 200 changes", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.3&wi=45,180&large=polar");
  const client = await page.context().newCDPSession(page);
  await client.send("HeapProfiler.enable");
  const used = async (): Promise<number> => {
    await client.send("HeapProfiler.collectGarbage");
    return ((await client.send("Runtime.getHeapUsage")) as { usedSize: number }).usedSize / 2 ** 20;
  };
  const nodes = (): Promise<number> => page.evaluate(() => document.querySelectorAll("*").length);
  const change = async (count: number): Promise<void> => {
    const slider = page.getByRole("slider", { name: "roughness", exact: true }).first();
    await slider.focus();
    for (let i = 0; i < count; i += 1) await page.keyboard.press(Math.floor(i / 10) % 2 === 0 ? "ArrowRight" : "ArrowLeft");
    await page.waitForTimeout(600);
  };
  await change(40);
  const [memory, elements] = [await used(), await nodes()];
  await change(200);
  const after = await used();
  test.info().annotations.push({ type: "memory", description: `${memory.toFixed(1)} MiB before 200 changes, ${after.toFixed(1)} MiB after` });
  expect(after - memory).toBeLessThan(6);
  expect(await nodes()).toBeLessThan(elements + 200);
});

declare global {
  interface Window {
    longest?: number;
    __gonio?: { timings: Partial<Record<string, { since: number; drawn: number; painted: number }[]>> };
  }
}
