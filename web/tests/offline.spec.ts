/** Once it has been loaded the page works without its server, and a new version takes the place of the old one. */
import { spawn, type ChildProcess } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { type Page, expect, test } from "@playwright/test";
import { GONIO, SITE } from "./gonio";

test.use({ serviceWorkers: "allow" });

/** A server of its own, for it is ended. */
async function serve(site: string, port = 0): Promise<{ address: string; end: () => Promise<void> }> {
  const server: ChildProcess = spawn(GONIO, ["explore", "--no-open", "--port", String(port), "--site", site], { stdio: ["ignore", "pipe", "ignore"] });
  const address = await new Promise<string>((resolve, reject) => {
    server.once("exit", (code) => reject(new Error(`it ended with ${code}`)));
    createInterface({ input: server.stdout! }).once("line", resolve);
  });
  return {
    address,
    end: () =>
      new Promise((resolve) => {
        server.removeAllListeners("exit");
        server.once("exit", () => resolve());
        server.kill("SIGINT");
      }),
  };
}

/** Until everything is stored. */
async function stored(page: Page): Promise<void> {
  await page.evaluate(async () => {
    await navigator.serviceWorker.ready;
  });
}

const drawn = (page: Page): Promise<void> => expect(page.locator('.slot[data-view="polar"] path.lobe, .slot[data-view="polar"] .plot path').first()).toBeAttached();

test("without the server everything is still there", async ({ page }) => {
  const server = await serve(SITE);
  await page.goto(`${server.address}#f=ggx:roughness=0.4&large=polar`);
  await stored(page);
  await server.end();
  await page.goto("about:blank");
  await page.goto(`${server.address}#f=phong:exponent=30&large=polar`);
  await drawn(page);
  await expect(page.locator(".function")).toContainText("phong");
  // What was never looked at while there was a server.
  await page.getByRole("link", { name: "Learn" }).click();
  await expect(page.getByRole("heading", { name: "How light is reflected" })).toBeVisible();
});

test("a new version is there at once, and whole without the server", async ({ page }) => {
  const site = mkdtempSync(join(tmpdir(), "gonio-"));
  cpSync(SITE, site, { recursive: true });
  const old = await serve(site);
  await page.goto(`${old.address}#f=lambertian&large=polar`);
  await stored(page);
  await old.end();
  // A new version: another page, and a worker that knows it.
  const index = join(site, "index.html");
  writeFileSync(index, readFileSync(index, "utf8").replace("<title>Gonio explorer", "<title>New explorer"));
  const worker = join(site, "sw.js");
  writeFileSync(worker, readFileSync(worker, "utf8").replace(/(["']?index\.html["']?:\s*["'`])[0-9a-f]{16}/, "$10000000000000000"));
  const port = Number(new URL(old.address).port);
  const next = await serve(site, port);
  await page.reload();
  await expect(page).toHaveTitle(/New/);
  await page.evaluate(async () => {
    const registration = await navigator.serviceWorker.ready;
    await registration.update();
    while (registration.installing !== null) await new Promise((resolve) => setTimeout(resolve, 50));
  });
  // When no page of the old version is open, the new one takes its place.
  const context = page.context();
  await page.close();
  let again = await context.newPage();
  await expect(async () => {
    await again.close();
    // A browser takes a moment to notice that a page is gone.
    await new Promise((resolve) => setTimeout(resolve, 1000));
    again = await context.newPage();
    await again.goto(`${old.address}#f=lambertian&large=polar`);
    const pages = await again.evaluate(async () => (await (await caches.open("gonio-explorer")).keys()).filter((r) => r.url.includes("index.html")).map((r) => new URL(r.url).search));
    expect(pages).toEqual(["?0000000000000000"]);
  }).toPass({ timeout: 30_000 });
  await drawn(again);
  await next.end();
  await again.reload();
  await expect(again).toHaveTitle(/New/);
  await drawn(again);
});
