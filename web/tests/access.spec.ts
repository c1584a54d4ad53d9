/** For everybody: axe-core finds nothing serious, the keyboard is enough, 360 px are enough. */
import AxeBuilder from "@axe-core/playwright";
import type { Page } from "@playwright/test";
import { angle, expect, open, test, view } from "./support";

async function serious(page: Page): Promise<string[]> {
  const found = await new AxeBuilder({ page }).analyze();
  return found.violations.filter((v) => v.impact === "serious" || v.impact === "critical").map((v) => `${v.id}: ${v.help}: ${v.nodes.map((n) => n.target.join(" ")).slice(0, 4).join("; ")}`);
}

for (const [name, viewport, colorScheme] of [
  ["light", { width: 1280, height: 860 }, "light"],
  ["dark", { width: 1280, height: 860 }, "dark"],
  ["360 px", { width: 360, height: 740 }, "light"],
] as const) {
  test.describe(name, () => {
    test.use({ viewport, colorScheme });

    test("axe-core finds nothing serious in the explorer", async ({ page }) => {
      await open(page, "#f=ggx:metal=gold,roughness=0.3&f=lambertian&wi=45,180&wo=30,0");
      await page.waitForTimeout(500);
      expect(await serious(page)).toEqual([]);
    });

    test("axe-core finds nothing serious on the page Learn", async ({ page }) => {
      await page.goto("/#learn/T8");
      await expect(page.getByRole("heading", { name: /The reflection function/ })).toBeVisible();
      await expect(page.locator(".learn-figure").first()).toBeVisible();
      expect(await serious(page)).toEqual([]);
    });
  });
}

test.describe("360 px wide", () => {
  test.use({ viewport: { width: 360, height: 740 } });

  test("nothing is wider than the screen, and functions are a tap away", async ({ page }) => {
    await open(page);
    const wider = (): Promise<number> => page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    expect(await wider()).toBeLessThanOrEqual(0);
    await page.getByRole("navigation", { name: "Parts of the page" }).getByRole("button", { name: "Functions" }).click();
    await expect(page.getByRole("button", { name: "Add", exact: true })).toBeVisible();
    expect(await wider()).toBeLessThanOrEqual(0);
    await page.goto("/#learn");
    await expect(page.getByRole("heading", { name: "How light is reflected" })).toBeVisible();
    expect(await wider()).toBeLessThanOrEqual(0);
  });
});

test("the keyboard chooses a cell of the slice and of the differences", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.3&f=ggx:roughness=0.5&wi=45,180", ".slot[data-view=difference] canvas");
  const fields = async (): Promise<number[]> => {
    const values: number[] = [];
    for (const name of ["Polar angle of incidence", "Azimuth of incidence", "Polar angle of view", "Azimuth of view"]) values.push(Number(await angle(page, name).inputValue()));
    return values;
  };
  /** Half and difference angles of the pair in the fields, from the vectors' own geometry. */
  const half = ([a, b, c, d]: number[]): [number, number] => {
    const vector = (theta: number, phi: number): number[] => [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
    const [i, o] = [vector(rad(a!), rad(b!)), vector(rad(c!), rad(d!))];
    const sum = i.map((x, k) => x + o[k]!);
    const length = Math.hypot(...sum);
    return [Math.acos(Math.min(1, sum[2]! / length)) / rad(1), Math.acos(Math.min(1, length / 2)) / rad(1)];
  };
  const rad = (x: number): number => (x * Math.PI) / 180;

  // Nothing is looked at: the keys begin at the mirror's direction, θh = 0, θd = 45.
  const cell = view(page, "slice").getByRole("slider", { name: /^Cell of the slice/ }).first();
  await cell.focus();
  await expect(cell).toHaveAttribute("aria-valuetext", /^θh 0\.0°, θd 45\.0°: f [\d.]+ per steradian$/);
  const words = await cell.getAttribute("aria-valuetext");
  await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowDown");
  await expect(cell).not.toHaveAttribute("aria-valuetext", words!);
  const [thetaH, thetaD] = half(await fields());
  expect(thetaH).toBeGreaterThan(10.2);
  expect(thetaH).toBeLessThan(10.8);
  expect(thetaD).toBeGreaterThan(44.2);
  expect(thetaD).toBeLessThan(44.8);
  expect(await page.evaluate(() => document.activeElement!.matches(":focus-visible"))).toBe(true);
  // Home and End lead to the ends of the row, as far as both directions are above the horizon.
  await page.keyboard.press("End");
  expect(half(await fields())[0]).toBeGreaterThan(30);
  for (const name of ["Polar angle of incidence", "Polar angle of view"]) expect(Number(await angle(page, name).inputValue())).toBeLessThanOrEqual(90);
  await page.keyboard.press("Home");
  expect(half(await fields())[0]).toBeLessThan(0.1);

  const difference = view(page, "difference").getByRole("slider", { name: "Cell of the difference of the slices" });
  await difference.focus();
  await page.keyboard.press("Shift+ArrowUp");
  await expect(difference).toHaveAttribute("aria-valuetext", /θd 54\.\d°: difference [+−]?[\d.]+ %$/);
  expect(half(await fields())[1]).toBeCloseTo(54.4, 0);

  await page.getByRole("button", { name: "Look at no direction" }).click();
  const viewer = view(page, "difference").getByRole("slider", { name: "Direction of view" });
  await viewer.focus();
  await page.keyboard.press("Shift+ArrowUp");
  await expect(viewer).toHaveAttribute("aria-valuetext", /difference/);
  await expect(angle(page, "Polar angle of view")).toBeVisible();
});

test("the keyboard alone: a function is added, set and looked at", async ({ page }) => {
  await open(page, "#f=lambertian&large=polar");
  const reach = async (name: RegExp): Promise<void> => {
    for (let i = 0; i < 80; i += 1) {
      await page.keyboard.press("Tab");
      const label = await page.evaluate(() => {
        const element = document.activeElement as HTMLElement;
        const own = element.getAttribute("aria-label") ?? (element as HTMLInputElement).labels?.[0]?.textContent ?? element.textContent ?? "";
        return own.trim();
      });
      if (name.test(label)) return;
    }
    throw new Error(`Tab reaches nothing named ${name}`);
  };
  await reach(/^Add$/);
  await page.keyboard.press("Enter");
  await expect(page.getByRole("dialog").getByRole("combobox")).toBeFocused();
  await page.keyboard.type("phong");
  await expect(page.getByRole("dialog").getByRole("option").first()).toContainText("phong");
  await page.keyboard.press("Enter");
  await expect(page.locator(".function")).toHaveCount(2);
  await expect(page.getByRole("slider", { name: "exponent", exact: true })).toBeVisible();
  await reach(/^exponent$/);
  const before = page.url();
  await page.keyboard.press("ArrowRight");
  await expect(page).not.toHaveURL(before);
  await reach(/^Polar angle of incidence/);
  await page.keyboard.press("ArrowUp");
  await expect(page).toHaveURL(/wi=46,180/);
  await reach(/^Direction of incidence$/);
  // The focus can be seen.
  expect(await page.evaluate(() => document.activeElement!.matches(":focus-visible"))).toBe(true);
});
