/** The page Learn: every row of the theory, alive. */
import { evaluated } from "./gonio";
import { expect, test } from "./support";

const NAMES = [
  "Light",
  "Solid angle",
  "Spherical coordinates",
  "Differential solid angle",
  "Radiance",
  "Irradiance",
  "Radiant exitance",
  "The reflection function",
  "Linearity",
  "Reciprocity",
  "Isotropy and anisotropy",
  "Energy conservation",
  "The reflection equation",
  "Mirror",
  "Diffuse reflection",
  "Specular reflection",
  "Fresnel's equations",
  "Torrance–Sparrow",
  "Measured reflection",
  "Non-photorealistic reflection",
  "Environment maps",
];

test("every section of the notes has its formula and a figure whose numbers the library has answered", async ({ page }) => {
  await page.goto("/#learn");
  await expect(page.getByRole("heading", { name: "How light is reflected" })).toBeVisible();
  for (const [index, name] of NAMES.entries()) {
    const key = `T${index + 1}`;
    await page.getByRole("navigation", { name: "Sections" }).getByRole("link", { name: `${key} ${name}` }).click();
    const section = page.locator(".learn-section").nth(index);
    await expect(section.getByRole("heading", { level: 2 })).toHaveText(`${key} ${name}`);
    await expect(section.locator("math").first()).toBeVisible();
    await expect(section.locator("svg, canvas").first()).toBeVisible();
    // A dash stands where nothing was answered yet.
    await expect(section.locator("dd").first()).toBeVisible();
    await expect(section.locator("dd", { hasText: /^–$/ })).toHaveCount(0);
    await expect(section.getByRole("alert")).toHaveCount(0);
  }
});

test("figures follow their sliders", async ({ page }) => {
  await page.goto("/#learn/T2");
  const section = page.locator(".learn-section").nth(1);
  const omega = section.locator("dl > div", { hasText: "Ω = A / r²" }).locator("dd");
  await section.getByRole("slider", { name: "half angle of the cone" }).fill("90");
  await expect(omega).toHaveText("6.2832 sr");
  await section.getByRole("slider", { name: "half angle of the cone" }).fill("180");
  await expect(omega).toHaveText("12.566 sr");
});

test("the same function fails reciprocity here as in the command", async ({ page }) => {
  await page.goto("/#learn/T10");
  const section = page.locator(".learn-section").nth(9);
  const number = async (name: string): Promise<number> => Number((await section.locator("dl > div", { hasText: name }).locator("dd").innerText()).split(" ")[0]);
  await expect(section.locator("dl > div", { hasText: "reciprocal here" }).locator("dd")).toHaveText("no");
  const toon = "toon:bands=3,highlight_deg=12";
  const [a, b] = [{ theta: 60, phi: 180 }, { theta: 20, phi: 0 }];
  expect(await number("f(a→b)")).toBeCloseTo(evaluated(toon, a, b).f_per_sr[0], 4);
  expect(await number("f(b→a)")).toBeCloseTo(evaluated(toon, b, a).f_per_sr[0], 4);
  await section.getByRole("combobox").selectOption({ label: "rough copper" });
  await expect(section.locator("dl > div", { hasText: "reciprocal here" }).locator("dd")).toHaveText("yes");
});
