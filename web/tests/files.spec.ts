/** Files that are dropped: measured tables, shaders, panoramas, and what can't be read. */
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { evaluated, gonio } from "./gonio";
import { drop, expect, open, reading, tab, test } from "./support";

const SHADERS = resolve(import.meta.dirname, "../../examples/shaders");
const scratch = (): string => mkdtempSync(join(tmpdir(), "gonio-"));

/** A measured file, made of a model by the command. */
function table(): { path: string; bytes: Buffer } {
  const path = join(scratch(), "plaster.gonio");
  gonio("brdf", "convert", "lambertian:reflectance=0.4", path, "--resolution", "18x9x12");
  return { path, bytes: readFileSync(path) };
}

test("a measured file is shown, and its values are the command's", async ({ page }) => {
  const { path, bytes } = table();
  await open(page, "#f=lambertian&wi=45,180&wo=30,0&large=cartesian");
  await drop(page, [{ name: "plaster.gonio", bytes }]);
  const row = page.locator(".function").nth(1);
  await expect(row).toContainText("plaster.gonio");
  const text = (await page.locator("tr[data-function*='plaster']").getAttribute("data-function"))!;
  const shown = await reading(page, text);
  const exact = evaluated(`table:${path}`, { theta: 45, phi: 180 }, { theta: 30, phi: 0 });
  shown.f_per_sr.forEach((x, k) => expect(Math.abs(x - exact.f_per_sr[k]!)).toBeLessThan(1e-6));
});

test("a broken file shows the library's error and loses nothing", async ({ page }) => {
  const { bytes } = table();
  await open(page, "#f=ggx:roughness=0.4&f=lambertian&large=cartesian");
  await expect(page).toHaveURL(/torrance-sparrow/);
  const before = page.url();
  for (const [name, content] of [
    ["short.gonio", bytes.subarray(0, 100)],
    ["empty.binary", Buffer.alloc(0)],
    ["noise.binary", Buffer.from("not a table at all")],
    ["notes.docx", Buffer.from("words")],
    ["broken.hdr", Buffer.from("#?RADIANCE\nFORMAT=none\n\n")],
  ] as const) {
    await drop(page, [{ name, bytes: content }]);
    const alert = page.getByRole("alert").filter({ hasText: name });
    await expect(alert).toBeVisible();
    expect((await alert.innerText()).length).toBeGreaterThan(name.length + 10);
    await alert.getByRole("button", { name: "Dismiss" }).click();
  }
  await expect(page.locator(".function")).toHaveCount(2);
  await expect(page.locator(".function-flag")).toHaveCount(0);
  expect(page.url()).toBe(before);
});

test("a shader is edited in place, with its errors at their line, and recomputed while typing", async ({ page }) => {
  const source = readFileSync(join(SHADERS, "blinn-phong.glsl"), "utf8");
  await open(page, "#f=lambertian&wi=45,180&wo=45,0&large=cartesian");
  await drop(page, [{ name: "mine.glsl", bytes: Buffer.from(source) }]);
  await expect(page.locator(".function").nth(1)).toContainText("mine.glsl");
  await tab(page, "Source").click();
  const editor = page.locator(".cm-content");
  await expect(editor).toBeVisible();
  const value = async (): Promise<number> => (await reading(page, (await page.locator("tr[data-function*='mine.glsl']").getAttribute("data-function"))!)).f_per_sr[0]!;
  const before = await value();
  await editor.click();
  await page.keyboard.press("Control+End");
  await page.keyboard.type("\nthis is no shader");
  const alert = page.getByRole("alert").first();
  await expect(alert).toContainText(/mine\.glsl:\d+:\d+/);
  const line = Number(/mine\.glsl:(\d+):/.exec(await alert.innerText())![1]);
  expect(Math.abs(line - (source.split("\n").length + 1))).toBeLessThanOrEqual(1);
  // It is marked in the text, and what was drawn before stays.
  await expect(page.locator(".cm-lintRange-error, .cm-lint-marker-error").first()).toBeAttached();
  expect(await value()).toBe(before);
  // Chromium styles what it types over several lines, which the policy stops without harm: they are deleted first.
  await page.keyboard.press("Control+a");
  await page.keyboard.press("Delete");
  await page.keyboard.type("vec3 eval(vec3 wi, vec3 wo) { return vec3(0.125); }");
  await expect(page.getByRole("alert")).toHaveCount(0);
  await expect.poll(value).toBeCloseTo(0.125, 9);
});

test("a panorama that is dropped lights the preview", async ({ page }) => {
  await open(page, "#f=lambertian");
  const path = join(scratch(), "noon.hdr");
  gonio("env", "sky", "2026-06-21T12:00+02:00@48.2,16.4", "-o", path, "--height", "32");
  await drop(page, [{ name: "noon.hdr", bytes: readFileSync(path) }]);
  await expect(page.getByRole("combobox", { name: "Light of the preview" })).toHaveValue("files/noon.hdr");
});
