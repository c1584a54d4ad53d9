import { defineConfig } from "@playwright/test";

/** Without a GPU: pictures are the same on every machine, and only WebGL is drawn by SwiftShader, which is slow. */
const FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--force-color-profile=srgb", "--font-render-hinting=none"];

export default defineConfig({
  testDir: ".",
  testMatch: "*.spec.ts",
  outputDir: "../test-results",
  globalSetup: "./server.ts",
  snapshotPathTemplate: "{testDir}/pictures/{arg}{ext}",
  fullyParallel: true,
  workers: 2,
  timeout: 60_000,
  expect: { timeout: 20_000, toHaveScreenshot: { maxDiffPixelRatio: 0.03, threshold: 0.2, animations: "disabled" } },
  reporter: [["./reporter.ts"]],
  use: {
    viewport: { width: 1280, height: 860 },
    colorScheme: "light",
    locale: "en-GB",
    serviceWorkers: "block",
    trace: "off",
    launchOptions: { executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS },
  },
});
