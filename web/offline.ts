/** Builds the service worker, which knows every file of the site by a hash of what it holds. */
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { build, type Plugin, type ResolvedConfig } from "vite";

const WORKER = "sw.js";

export function offline(): Plugin {
  let config: ResolvedConfig;
  return {
    name: "offline",
    apply: "build",
    configResolved: (resolved) => void (config = resolved),
    // When everything is written, the files of the public folder too.
    closeBundle: {
      order: "post",
      sequential: true,
      async handler() {
        const folder = resolve(config.root, config.build.outDir);
        const files: Record<string, string> = {};
        for (const entry of readdirSync(folder, { recursive: true, encoding: "utf8" })) {
          const path = join(folder, entry);
          const name = entry.replaceAll("\\", "/");
          if (statSync(path).isFile() && name !== WORKER) files[name] = createHash("sha256").update(readFileSync(path)).digest("hex").slice(0, 16);
        }
        const built = await build({
          configFile: false,
          root: config.root,
          logLevel: "warn",
          publicDir: false,
          define: { SITE_FILES: JSON.stringify(Object.fromEntries(Object.entries(files).sort())) },
          build: { write: false, target: config.build.target, rolldownOptions: { input: join(config.root, "offline/worker.ts"), output: { format: "iife" } } },
        });
        const output = (Array.isArray(built) ? built : [built]).flatMap((one) => ("output" in one ? one.output : []));
        const code = output.find((part) => part.type === "chunk")?.code;
        if (code === undefined) throw new Error("the service worker was not built");
        writeFileSync(join(folder, WORKER), code);
      },
    },
  };
}
