import { defineConfig } from "vite";
import { collect, licenses } from "./licenses.ts";
import { offline } from "./offline.ts";

export default defineConfig({
  // Relative addresses: the site works in any folder of any server.
  base: "./",
  build: {
    // Safari 16.4 is the oldest browser that the page is written for.
    target: ["es2022", "safari16.4"],
    // Without source text in data: addresses, so that the content-security policy can forbid them for scripts and fonts.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700,
  },
  plugins: [collect(), licenses(), offline()],
  worker: { format: "es", plugins: () => [collect()] },
});
