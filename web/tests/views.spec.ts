/** The views, all linked to one direction of incidence. */
import { angle, colours, expect, open, tab, test, view, type ViewName } from "./support";

const VIEWS: readonly ViewName[] = ["lobe", "polar", "cartesian", "ball", "preview", "slice", "albedo", "difference"];

/** Of plots, which have few colours: grid, axes, and curves with smooth edges. */
const FEW: Partial<Record<ViewName, number>> = { polar: 12, cartesian: 12, albedo: 12 };

test("every view shows something", async ({ page }) => {
  await open(page);
  for (const name of VIEWS) {
    const slot = view(page, name);
    await slot.scrollIntoViewIfNeeded();
    await expect(slot.getByRole("heading")).toBeVisible();
    // Drawn and not only framed: text and frame of an empty view have fewer colours than that.
    await expect.poll(() => colours(page, slot.locator(".view-body")), { message: name }).toBeGreaterThan(FEW[name] ?? 40);
  }
  await expect(view(page, "preview").locator("[data-samples]")).toBeVisible();
});

test("the direction of incidence is dragged in one view and followed by all", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.4&wi=45,180");
  const theta = angle(page, "Polar angle of incidence");
  await expect(theta).toHaveValue("45");
  const label = (name: ViewName): Promise<string | null> => view(page, name).locator("svg.plot").first().getAttribute("aria-label");
  const before = [await label("polar"), await label("cartesian")];
  const handle = view(page, "polar").getByRole("slider", { name: "Direction of incidence" });
  const from = (await handle.boundingBox())!;
  const [x, y] = [from.x + from.width / 2, from.y + from.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 20, y + 30, { steps: 4 });
  await page.mouse.up();
  const dragged = Number(await theta.inputValue());
  expect(dragged).toBeGreaterThan(48);
  await expect.poll(() => label("polar")).not.toBe(before[0]);
  await expect.poll(() => label("cartesian")).not.toBe(before[1]);
  for (const name of ["cartesian", "ball", "albedo"] as const) await expect(view(page, name).getByRole("slider", { name: "Direction of incidence" }).first()).toHaveAttribute("aria-valuenow", String(dragged));
});

test("the keys move it in every view that has its handle", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.4&wi=45,180");
  const theta = angle(page, "Polar angle of incidence");
  for (const name of ["lobe", "polar", "cartesian", "ball"] as const) {
    const before = await theta.inputValue();
    await view(page, name).getByRole("slider", { name: "Direction of incidence" }).first().focus();
    await page.keyboard.press("ArrowUp");
    await page.keyboard.press("ArrowRight");
    await expect(theta, name).not.toHaveValue(before);
  }
});

test("a touch moves it too", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.4&wi=45,180&large=polar");
  const handle = view(page, "polar").getByRole("slider", { name: "Direction of incidence" });
  const box = (await handle.boundingBox())!;
  const client = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", dx: number): Promise<unknown> =>
    client.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x: box.x + box.width / 2 + dx, y: box.y + box.height / 2 - dx }] });
  await touch("touchStart", 0);
  for (const dx of [8, 16, 24]) await touch("touchMove", dx);
  await touch("touchEnd", 24);
  expect(Number(await angle(page, "Polar angle of incidence").inputValue())).toBeLessThan(43);
});

test("the lobe is scaled by two fingers, the wheel and the keys, and turned by one finger", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.4&wi=45,180&large=lobe", ".lobe-overlay:not(.empty)");
  const overlay = page.locator(".lobe-overlay");
  const label = (text: string) => overlay.locator(".lobe-label", { hasText: new RegExp(`^${text}$`) });
  /** Pixels across the rim, when what was asked for is drawn. */
  const width = async (): Promise<number> => {
    const [a, b] = [(await label("0°").boundingBox())!, (await label("180°").boundingBox())!];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  const box = (await overlay.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + 0.8 * box.height];
  const client = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", points: [number, number][]): Promise<unknown> =>
    client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([dx, dy], id) => ({ x: x + dx, y: y + dy, id })) });
  const pinch = async (from: number, to: number): Promise<void> => {
    await touch("touchStart", [[-from, 0], [from, 0]]);
    for (let k = 1; k <= 5; k += 1) await touch("touchMove", [[-from - (k / 5) * (to - from), 0], [from + (k / 5) * (to - from), 0]]);
    await touch("touchEnd", []);
  };
  await expect.poll(width).toBeGreaterThan(100);
  const first = await width();
  await pinch(40, 60);
  await expect.poll(width).toBeGreaterThan(1.3 * first);
  expect(await width()).toBeLessThan(1.7 * first);
  await pinch(60, 40);
  await expect.poll(async () => Math.abs((await width()) - first)).toBeLessThan(0.05 * first);

  // One finger turns it and scales nothing.
  const before = await label("0°").getAttribute("style");
  await touch("touchStart", [[0, 0]]);
  for (const dx of [20, 40, 60]) await touch("touchMove", [[dx, 0]]);
  await touch("touchEnd", []);
  await expect(label("0°")).not.toHaveAttribute("style", before!);

  const turned = await width();
  await overlay.focus();
  for (let k = 0; k < 3; k += 1) await page.keyboard.press("+");
  await expect.poll(width).toBeGreaterThan(1.3 * turned);
  for (let k = 0; k < 3; k += 1) await page.keyboard.press("-");
  await expect.poll(async () => Math.abs((await width()) - turned)).toBeLessThan(0.05 * turned);
  await page.mouse.move(x, y);
  await page.mouse.wheel(0, -200);
  await expect.poll(width).toBeGreaterThan(1.2 * turned);
});

test("scales, the cosine, exposure and the tone curve are set for all views", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.4&large=polar");
  const polar = view(page, "polar").locator("svg.plot");
  await page.getByRole("combobox", { name: "Scale", exact: true }).selectOption("log");
  await expect(page).toHaveURL(/log/);
  await page.getByRole("checkbox", { name: /cos/ }).check();
  await expect(polar).toHaveAttribute("aria-label", /cos/);
  await page.getByRole("slider", { name: "Exposure, stops" }).fill("2");
  await expect(page.getByText("+2.0 EV")).toBeVisible();
  await page.getByRole("combobox", { name: "Tone curve" }).selectOption("aces");
  await expect(page).toHaveURL(/aces/);
});

test("a view is made large, and small again by Escape", async ({ page }) => {
  await open(page, "#f=ggx");
  const slot = view(page, "cartesian");
  const small = (await slot.boundingBox())!.width;
  await slot.getByRole("button", { name: /large$/ }).click();
  await expect.poll(async () => (await slot.boundingBox())!.width).toBeGreaterThan(1.8 * small);
  await expect(view(page, "ball")).toBeHidden();
  await page.keyboard.press("Escape");
  await expect(view(page, "ball")).toBeVisible();
});

test("two functions are compared, and the largest difference is gone to", async ({ page }) => {
  await open(page, "#f=ggx:roughness=0.3&f=ggx:roughness=0.5&wi=45,180&large=difference", ".view-body canvas");
  const slot = view(page, "difference");
  await slot.scrollIntoViewIfNeeded();
  const largest = slot.getByRole("button", { name: /^largest|largest difference/i }).first();
  await expect(largest).toBeVisible();
  await largest.click();
  await expect(angle(page, "Polar angle of view")).toBeVisible();
});

test("verdicts: what fails names its witness, and every view goes there", async ({ page }) => {
  await open(page, "#f=toon&wi=10,180&large=polar");
  await tab(page, "Verdicts").click();
  const rows = page.locator(".verdict");
  await expect(rows.first()).toBeVisible({ timeout: 40_000 });
  await expect(rows.filter({ hasText: /reciprocity/i })).toHaveCount(1);
  const witness = rows.filter({ hasText: /reciprocity/i }).getByRole("button", { name: /witness/i });
  const words = await witness.innerText();
  await witness.click();
  const [theta] = /(\d+(\.\d+)?)°/.exec(words)!.slice(1).map(Number);
  expect(Math.abs(Number(await angle(page, "Polar angle of incidence").inputValue()) - theta!)).toBeLessThanOrEqual(0.051);
  await expect(angle(page, "Polar angle of view")).toBeVisible();
});

test("verdicts: a physical function is not refuted", async ({ page }) => {
  await open(page, "#f=lambertian&large=polar");
  await tab(page, "Verdicts").click();
  await expect(page.getByText("Nothing is refuted")).toBeVisible({ timeout: 40_000 });
});
