/** For everybody: axe-core finds nothing serious, the keyboard is enough, 360 px are enough. */
import AxeBuilder from "@axe-core/playwright";
import type { Page } from "@playwright/test";
import { expect, open, test } from "./support";

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
