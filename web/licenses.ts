/** `licenses.txt` of the built site: of every package and crate whose code or typeface is in it, with the preview's assets. */
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Plugin } from "vite";

const ASSETS = "../assets";
/** Of the library's crates, by `cargo xtask web`. */
const CRATES = "crates.licenses.txt";
/** Reached through style sheets, which name no modules. */
const FONTS = ["@fontsource-variable/inter"];

/** The folder of the package that a module lies in. */
function packageOf(id: string): string | null {
  const found = /^(.*\/node_modules\/((?:@[^/]+\/)?[^/]+))\//.exec(id.replace(/^\0/, ""));
  return found === null ? null : found[1]!;
}

function entry(folder: string): string {
  const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) as { name: string; version: string; license?: string };
  const texts = readdirSync(folder).filter((name) => /^(licen[cs]e|copying|notice)/i.test(name));
  const body = texts.map((name) => readFileSync(join(folder, name), "utf8").trim()).join("\n\n");
  return `${about.name} ${about.version} (${about.license ?? "see its text"})\n\n${body}`;
}

const packages = new Set<string>();

/** Notes the packages of a bundle; workers are bundles of their own, built before the page's. */
export function collect(): Plugin {
  return {
    name: "licenses-collect",
    generateBundle(_, bundle) {
      for (const chunk of Object.values(bundle)) {
        if (chunk.type !== "chunk") continue;
        for (const id of chunk.moduleIds) {
          const folder = packageOf(id);
          if (folder !== null) packages.add(folder);
        }
      }
    },
  };
}

/** Writes the file; after `collect`. */
export function licenses(): Plugin {
  return {
    name: "licenses",
    apply: "build",
    generateBundle() {
      for (const font of FONTS) packages.add(join(process.cwd(), "node_modules", font));
      const parts = [...packages].filter((folder) => existsSync(join(folder, "package.json"))).sort().map(entry);
      if (!existsSync(CRATES)) throw new Error(`web/${CRATES} is missing: cargo xtask web writes it`);
      parts.push(readFileSync(CRATES, "utf8").trim());
      parts.push(`The preview's object and stand\n\n${readFileSync(join(ASSETS, "preview/LICENSE-OpenPBR-viewer"), "utf8").trim()}`);
      parts.push(readFileSync(join(ASSETS, "README.md"), "utf8").trim());
      this.emitFile({ type: "asset", fileName: "licenses.txt", source: `${parts.join(`\n\n${"-".repeat(80)}\n\n`)}\n` });
    },
  };
}
