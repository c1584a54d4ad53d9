/** What the page shows is what the library's command says. */
import { evaluated } from "./gonio";
import { angle, expect, open, reading, test, view } from "./support";

const close = (found: number, exact: number): void => expect(Math.abs(found - exact)).toBeLessThanOrEqual(1e-6 * Math.max(1, Math.abs(exact)));

const FUNCTIONS = ["torrance-sparrow:distribution=ggx,metal=gold,roughness=0.3", "sum(lambertian:reflectance=0.1/0.25/0.4, torrance-sparrow:distribution=ggx,f0=0.04,roughness=0.2)", "disney:base_color=0.8/0.2/0.1,metallic=0.3", "toon"];

test("values for a pair of directions are those of gonio brdf eval --json", async ({ page }) => {
  const functions = FUNCTIONS.map((f) => `f=${encodeURIComponent(f)}`).join("&");
  await open(page, `#${functions}&wi=45,180&wo=30,0&large=cartesian`);
  for (const [wi, wo] of [
    [{ theta: 45, phi: 180 }, { theta: 30, phi: 0 }],
    [{ theta: 60, phi: 90 }, { theta: 58, phi: -80 }],
  ] as const) {
    await angle(page, "Polar angle of incidence").fill(String(wi.theta));
    await angle(page, "Azimuth of incidence").fill(String(wi.phi));
    await angle(page, "Polar angle of view").fill(String(wo.theta));
    await angle(page, "Azimuth of view").fill(String(wo.phi));
    await page.waitForTimeout(300);
    for (const f of await page.locator("tr[data-function]").evaluateAll((rows) => rows.map((row) => (row as HTMLElement).dataset.function!))) {
      const exact = evaluated(f, wi, wo);
      await expect(async () => {
        const shown = await reading(page, f);
        shown.f_per_sr.forEach((x, k) => close(x, exact.f_per_sr[k]!));
        shown.f_cos_per_sr.forEach((x, k) => close(x, exact.f_cos_per_sr[k]!));
        close(shown.pdf_per_sr[0]!, exact.pdf_per_sr);
      }).toPass({ timeout: 10_000 });
    }
  }
});

test("the curves' table is the command's function, at every angle", async ({ page }) => {
  const f = "torrance-sparrow:distribution=ggx,metal=copper,roughness=0.5";
  await open(page, `#f=${f}&wi=40,180&large=polar`);
  await view(page, "polar").getByLabel(/^Save the/).click();
  const [file] = await Promise.all([page.waitForEvent("download"), view(page, "polar").getByRole("button", { name: "CSV" }).click()]);
  const text = await (await file.createReadStream()).toArray().then((parts) => Buffer.concat(parts as Buffer[]).toString());
  const [head, ...lines] = text.trim().split("\r\n");
  expect(head).toBe("function,theta_r_deg,red,green,blue");
  // The function's text may have commas of its own, in quotes.
  const rows = lines.map((line) => line.split(",").slice(-4).map(Number));
  expect(rows.length).toBeGreaterThan(100);
  for (const at of [0.15, 0.5, 0.72, 0.9]) {
    const [theta, ...rgb] = rows[Math.floor(at * rows.length)]!;
    const exact = evaluated(f, { theta: 40, phi: 180 }, { theta: Math.abs(theta!), phi: theta! < 0 ? 180 : 0 });
    // The angles and values of curves are 32-bit numbers.
    exact.f_per_sr.forEach((x, k) => expect(Math.abs(rgb[k]! - x)).toBeLessThan(1e-5 * x));
  }
});
