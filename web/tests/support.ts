/**
 * What every test has: a page that must keep to itself. Errors in the console, requests to another origin and whatever the
 * content-security policy stops fail the test in which they occur.
 */
import { expect, type Locator, type Page, test as base } from "@playwright/test";

export { expect };

export const EXPLORER = process.env.EXPLORER ?? "";

interface Fixtures {
  /** What the page did wrong so far. */
  faults: string[];
}

export const test = base.extend<Fixtures>({
  baseURL: EXPLORER,
  faults: [async ({ page }, use) => {
    const faults: string[] = [];
    page.on("pageerror", (error) => faults.push(`not caught: ${error.stack ?? error.message}`));
    page.on("console", (message) => {
      if (message.type() === "error") faults.push(`console: ${message.text()}`);
    });
    page.on("request", (request) => {
      const { protocol, origin } = new URL(request.url());
      if (protocol !== "blob:" && protocol !== "data:" && origin !== new URL(EXPLORER).origin) faults.push(`asks another origin: ${request.url()}`);
    });
    await page.exposeFunction("__forbidden", (what: string) => faults.push(`the policy stopped ${what}`));
    await page.addInitScript(() => {
      addEventListener("securitypolicyviolation", (event) => {
        const tell = (globalThis as unknown as { __forbidden(what: string): void }).__forbidden;
        tell(`${event.effectiveDirective} ${event.blockedURI} in ${event.sourceFile}:${event.lineNumber}`);
      });
    });
    await use(faults);
    expect(faults).toEqual([]);
  }, { auto: true }],
});

/** Opens the page at a link and waits until its functions are understood and something is drawn. */
export async function open(page: Page, link = "", drawn = ".view svg.plot"): Promise<void> {
  await page.goto(`/${link}`);
  // On a narrow screen the panel with the functions is behind the views.
  await expect(page.locator(".function").first()).toBeAttached();
  await expect(page.locator(drawn).first()).toBeVisible();
}

/** The panel's tab for the selected function. */
export const tab = (page: Page, name: "Parameters" | "Source" | "Verdicts"): Locator => page.getByRole("tab", { name });

/** The view of that name. */
export const view = (page: Page, name: ViewName): Locator => page.locator(`.slot[data-view="${name}"]`);

/** How many colours the element has on the screen, of those that are not just in an edge or two. */
export async function colours(page: Page, element: Locator): Promise<number> {
  const png = (await element.screenshot()).toString("base64");
  return page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext("2d")!;
    context.drawImage(bitmap, 0, 0);
    const counts = new Map<number, number>();
    for (const pixel of new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer)) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
    return [...counts.values()].filter((count) => count >= 8).length;
  }, png);
}

/** A function's line in the table of values, when the library has answered. */
export async function reading(page: Page, description: string): Promise<Record<"f_per_sr" | "f_cos_per_sr" | "pdf_per_sr", number[]>> {
  const row = page.locator(`tr[data-function=${JSON.stringify(description)}]`);
  await expect(row.locator("data").first()).toBeAttached();
  return row.locator("data").evaluateAll((cells) => {
    const found: Record<string, number[]> = {};
    for (const cell of cells as HTMLDataElement[]) (found[cell.dataset.of!] ??= []).push(Number(cell.value));
    return found as Record<"f_per_sr" | "f_cos_per_sr" | "pdf_per_sr", number[]>;
  });
}

/** Drops files on the page, as from a folder. */
export async function drop(page: Page, files: { name: string; bytes: Buffer }[]): Promise<void> {
  const transfer = await page.evaluateHandle((all) => {
    const data = new DataTransfer();
    for (const { name, base64 } of all) data.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name));
    return data;
  }, files.map(({ name, bytes }) => ({ name, base64: bytes.toString("base64") })));
  for (const event of ["dragenter", "dragover", "drop"]) await page.dispatchEvent("body", event, { dataTransfer: transfer });
}

/** A field of an angle in the bar above the views. */
export const angle = (page: Page, name: string): Locator => page.getByRole("spinbutton", { name: `${name}, degrees` });

export type ViewName = "lobe" | "polar" | "cartesian" | "slice" | "albedo" | "ball" | "preview" | "difference";
