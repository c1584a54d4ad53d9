/** The permanent link, and everything that is taken away. */
import { spawnSync } from "node:child_process";
import { writeFileSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Download } from "@playwright/test";
import { GONIO } from "./gonio";
import { angle, expect, open, test, view } from "./support";

async function content(file: Download): Promise<Buffer> {
  return Buffer.concat((await (await file.createReadStream()).toArray()) as Buffer[]);
}

test("the link holds the whole state", async ({ page, context }) => {
  await open(page, "#f=ggx:metal=gold,roughness=0.3&f=lambertian&wi=45,180&large=polar");
  await angle(page, "Polar angle of incidence").fill("33");
  await page.getByRole("slider", { name: "Exposure, stops" }).fill("1.5");
  await page.getByRole("combobox", { name: "Scale", exact: true }).selectOption("cube-root");
  await page.locator(".function").nth(1).getByRole("button", { name: /^Show/ }).click();
  await expect(page).toHaveURL(/cube-root/);
  await expect(page).toHaveURL(/wi=33,180/);
  const other = await context.newPage();
  await open(other, new URL(page.url()).hash);
  await expect(angle(other, "Polar angle of incidence")).toHaveValue("33");
  await expect(other.getByText("+1.5 EV")).toBeVisible();
  await expect(other.getByRole("combobox", { name: "Scale", exact: true })).toHaveValue("cube-root");
  await expect(other.locator(".function")).toHaveCount(2);
  await expect(other.locator(".function").nth(1).getByRole("button", { name: /^Show/ })).toHaveAttribute("aria-pressed", "false");
});

test("a link that is broken says so, and the page works", async ({ page }) => {
  await page.goto("/#f=gxx:nonsense=1&wi=900,x&s=~~~~");
  await expect(page.getByRole("alert").first()).toBeVisible();
  await page.getByRole("button", { name: "Add", exact: true }).click();
  await page.getByRole("dialog").getByRole("combobox").fill("lambertian");
  await page.getByRole("option", { name: /^lambertian/ }).first().click();
  await expect(page.locator(".function").filter({ hasText: "lambertian" })).toHaveCount(1);
});

test("what is taken away is what the command understands", async ({ page }) => {
  await open(page, "#f=ggx:metal=gold,roughness=0.3&wi=45,180&large=polar");
  await page.getByRole("button", { name: "Take away" }).click();
  const text = (name: string): Promise<string> => page.getByRole("dialog").getByRole("textbox", { name }).first().inputValue();
  expect(await text("Address")).toContain("#f=");
  expect(await text("Rust")).toContain("ModelSpec");
  const command = await text("Command line");
  const words = command.match(/'[^']*'|\S+/g)!.map((w) => w.replace(/^'|'$/g, ""));
  expect(words[0]).toBe("gonio");
  expect(spawnSync(GONIO, words.slice(1), { cwd: mkdtempSync(join(tmpdir(), "gonio-")), timeout: 30_000 }).stderr.toString()).not.toContain("error:");
  const toml = await text("Scene file (TOML)");
  expect(toml).toContain("torrance-sparrow");
  const wgsl = page.getByRole("dialog").getByRole("textbox", { name: "Code" });
  await expect(wgsl).toHaveValue(/fn /);
});

test("plots and views are saved as SVG, PNG and CSV", async ({ page }) => {
  await open(page, "#f=ggx:metal=gold,roughness=0.3&wi=45,180&large=polar");
  const slot = view(page, "polar");
  for (const [kind, begins] of [
    ["SVG", "<svg"],
    ["PNG", "\x89PNG"],
    ["CSV", ""],
  ] as const) {
    await slot.getByLabel(/^Save the/).click();
    const [file] = await Promise.all([page.waitForEvent("download"), slot.getByRole("button", { name: kind }).click()]);
    const bytes = await content(file);
    expect(bytes.length).toBeGreaterThan(500);
    expect(bytes.toString("latin1").replace(/^<\?xml[^>]*>\s*/, "").startsWith(begins)).toBe(true);
  }
});

test("shader code is the command's", async ({ page }) => {
  await open(page, "#f=ggx:metal=gold,roughness=0.3&large=polar");
  await page.getByRole("button", { name: "Take away" }).click();
  const code = page.getByRole("dialog").getByRole("textbox", { name: "Code" });
  await expect(code).toHaveValue(/fn /);
  const folder = mkdtempSync(join(tmpdir(), "gonio-"));
  writeFileSync(join(folder, "mine.wgsl"), await code.inputValue());
  const exported = spawnSync(GONIO, ["brdf", "export", "torrance-sparrow:distribution=ggx,metal=gold,roughness=0.3", "--lang", "wgsl"], { encoding: "utf8" });
  expect((await code.inputValue()).trim()).toBe(exported.stdout.trim());
});
