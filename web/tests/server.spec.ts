/** What keeps the page to itself. That nothing asks another origin, and no policy is broken, is looked at in every test. */
import { expect, open, test } from "./support";

test("the page has the policy of its server, so that any server will do", async ({ page, request, faults }) => {
  const answer = await request.get("/");
  const server = answer.headers()["content-security-policy"]!.split(";").map((part) => part.trim());
  const own = /http-equiv="Content-Security-Policy"\s+content="([^"]*)"/.exec(await answer.text())![1]!.split(";").map((part) => part.trim());
  // Only a server can say in whose frames it may be shown.
  expect(own.sort()).toEqual(server.filter((part) => part !== "frame-ancestors 'none'").sort());
  await open(page);
  await page.evaluate(() => {
    const script = document.createElement("script");
    script.textContent = "document.title = 'changed'";
    document.head.append(script);
  });
  await expect.poll(() => faults.some((fault) => fault.includes("the policy stopped script-src"))).toBe(true);
  await expect(page).not.toHaveTitle("changed");
  faults.length = 0;
});

test("no other page shows it in a frame, and none reads its files", async ({ page, request }) => {
  const headers = (await request.get("/gonio.wasm")).headers();
  expect(headers["content-type"]).toBe("application/wasm");
  expect(headers["cross-origin-resource-policy"]).toBe("same-origin");
  expect(headers["x-content-type-options"]).toBe("nosniff");
  const foreign = await request.get("/", { headers: { Host: "example.com" } });
  expect(foreign.status()).toBe(421);
  await page.goto("about:blank");
});
