/** Choosing functions, and their parameters. */
import { expect, open, test, view } from "./support";

test("functions are chosen from the registry, compared, hidden and removed", async ({ page }) => {
  await open(page, "#large=cartesian");
  const functions = page.locator(".function");
  await expect(functions).toHaveCount(2);
  await page.getByRole("button", { name: "Add", exact: true }).click();
  await page.getByRole("combobox", { name: /^Search models/ }).fill("oren");
  await page.getByRole("option", { name: /^oren-nayar/ }).first().click();
  await expect(functions).toHaveCount(3);
  await expect(functions.nth(2)).toContainText("oren-nayar");
  // Each has a colour of its own, and a curve in every plot.
  const colours = await functions.evaluateAll((rows) => rows.map((row) => (row as HTMLElement).dataset.colour));
  expect(new Set(colours).size).toBe(3);
  const curves = view(page, "cartesian").locator("path.curve");
  await expect(curves).toHaveCount(3);
  await functions.nth(2).getByRole("button", { name: /^Show/ }).click();
  await expect(curves).toHaveCount(2);
  await functions.nth(2).getByRole("button", { name: /^Remove/ }).click();
  await expect(functions).toHaveCount(2);
});

test("a slider's range, help and paper are the registry's; the plots follow it", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.3&wi=45,180&large=polar");
  const slider = page.getByRole("slider", { name: "roughness", exact: true });
  await expect(slider).toHaveValue("0.3");
  const label = async (): Promise<string> => (await view(page, "polar").locator("svg.plot").getAttribute("aria-label"))!;
  const before = await label();
  await slider.focus();
  await page.keyboard.press("End");
  await expect(page.getByRole("textbox", { name: "roughness, as a number" })).toHaveValue("1");
  await expect.poll(label).not.toBe(before);
  await page.getByRole("button", { name: "What is this: roughness" }).click();
  await expect(page.getByText(/perceptual roughness/)).toBeVisible();
  await expect(page).toHaveURL(/roughness=1/);
});

test("a description that is written as text, wrong or right", async ({ page }) => {
  await open(page, "#f=lambertian&large=polar");
  const text = page.getByRole("textbox", { name: "Description of the function" });
  await text.fill("lambertain:0.5");
  await expect(page.getByRole("alert")).toContainText("lambertian");
  await expect(page.locator(".function")).toHaveCount(1);
  await text.fill("phong:exponent=40");
  await expect(page.getByRole("alert")).toHaveCount(0);
  await expect(page.locator(".function")).toContainText("phong");
});

test("presets of a model are found and set", async ({ page }) => {
  await open(page, "#f=ward&large=polar");
  await page.getByRole("button", { name: /presets$/ }).click();
  await page.getByRole("dialog").getByRole("combobox").fill("gold-paint");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("textbox", { name: "Description of the function" })).toHaveValue(/^ward/);
  await expect(page.locator(".function")).toContainText("ward");
});
