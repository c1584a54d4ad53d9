/**
 * The library in WebAssembly answers as the native one does, to the last bit: `crates/gonio-web/tests/same_bits.rs` made the hashes.
 */
import { existsSync, readFileSync } from "node:fs";
import { ConsoleStdout, File, OpenFile, PreopenDirectory, WASI } from "@bjorn3/browser_wasi_shim";
import { describe, expect, it } from "vitest";

const MODULE = "public/gonio.wasm";
const SCENE = ["scene.toml", "ball.glb", "stand.glb", "sunset.hdr"];

interface Asked {
  operation: string;
  request: unknown;
  hash: string;
}

/** FNV-1a of 32 bits. */
function hash(bytes: Uint8Array): string {
  let h = 0x811c9dc5;
  for (const byte of bytes) h = Math.imul(h ^ byte, 0x01000193);
  return (h >>> 0).toString(16).padStart(8, "0");
}

/** What answers a request with the bytes of its answer. */
async function library(): Promise<(asked: Asked) => Uint8Array> {
  const files = new Map(SCENE.map((name) => [name, new File(readFileSync(`../assets/preview/${name}`))]));
  const nothing = (): ConsoleStdout => ConsoleStdout.lineBuffered(() => undefined);
  const wasi = new WASI(["gonio"], [], [new OpenFile(new File([])), nothing(), nothing(), new PreopenDirectory("files", files)], { debug: false });
  const module = await WebAssembly.compile(readFileSync(MODULE));
  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport as WebAssembly.ModuleImports });
  const exports = instance.exports as unknown as {
    memory: WebAssembly.Memory;
    _initialize(): void;
    gonio_alloc(length: number): number;
    gonio_call(pointer: number, length: number): number;
  };
  wasi.initialize({ exports });
  return ({ operation, request }) => {
    const text = new TextEncoder().encode(JSON.stringify({ operation, request }));
    const input = exports.gonio_alloc(text.length);
    new Uint8Array(exports.memory.buffer, input, text.length).set(text);
    const output = exports.gonio_call(input, text.length);
    const total = new DataView(exports.memory.buffer).getUint32(output, true);
    return new Uint8Array(exports.memory.buffer, output, total);
  };
}

describe.skipIf(!existsSync(MODULE))("the library in WebAssembly", () => {
  it("answers as the native one, to the last bit", async () => {
    const answer = await library();
    const all = JSON.parse(readFileSync("../crates/gonio-web/tests/answers.json", "utf8")) as Asked[];
    expect(all.length).toBeGreaterThan(30);
    const other = all.filter((asked) => hash(answer(asked)) !== asked.hash);
    expect(other.map(({ operation, request }) => `${operation} ${JSON.stringify(request)}`)).toEqual([]);
  }, 120_000);

  it("tells one bit of one number", () => {
    expect(hash(new TextEncoder().encode("foobar"))).toBe("bf9cf968");
  });
});
