/**
 * Pictures against those of before, with a tolerance: few, of what the library computes and the page draws. `tests/run.sh pictures --update-snapshots` takes
 * them anew; look at them before they are kept.
 */
import { colours, expect, open, test, view } from "./support";

const STATE = "f=ggx:metal=gold,roughness=0.3&f=sum(lambertian:0.1/0.25/0.4,ggx:f0=0.04,roughness=0.2)&wi=50,180";

test.use({ viewport: { width: 900, height: 640 } });

for (const [name, scheme, what] of [
  ["polar", "light", "svg.plot"],
  ["cartesian", "dark", "svg.plot"],
  ["ball", "light", ".view-body"],
] as const) {
  test.describe(scheme, () => {
    test.use({ colorScheme: scheme });

    test(`${name}, ${scheme}`, async ({ page }) => {
      await open(page, `#${STATE}&large=${name}`, `.slot[data-view="${name}"] ${what}`);
      await expect.poll(() => colours(page, view(page, name).locator(what))).toBeGreaterThan(what === "svg.plot" ? 12 : 40);
      await expect(view(page, name).locator(what)).toHaveScreenshot(`${name}.png`, { timeout: 20_000 });
    });
  });
}

test("a figure of the page Learn", async ({ page }) => {
  await page.goto("/#learn/T3");
  const drawing = page.locator(".learn-section").nth(2).locator("svg");
  await expect(drawing.locator("circle.point")).toBeVisible();
  await expect(drawing).toHaveScreenshot("spherical-coordinates.png");
});
