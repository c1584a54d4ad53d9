/** Serves the page as users get it, by the command, while the tests run. */
import { type ChildProcess, spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { GONIO, SITE } from "./gonio";

export default async function start(): Promise<() => Promise<void>> {
  const server = spawn(GONIO, ["explore", "--no-open", "--port", "0", "--site", SITE], { stdio: ["ignore", "pipe", "inherit"] });
  process.env.EXPLORER = await address(server);
  return async () => {
    const ended = new Promise<number | null>((resolve) => server.once("exit", resolve));
    server.kill("SIGINT");
    const code = await ended;
    if (code !== 0) throw new Error(`gonio explore ended with ${code}`);
  };
}

/** The first line that it prints. */
function address(server: ChildProcess): Promise<string> {
  return new Promise((resolve, reject) => {
    server.once("error", reject);
    server.once("exit", (code) => reject(new Error(`gonio explore ended with ${code} before it served`)));
    createInterface({ input: server.stdout! }).once("line", resolve);
  });
}
