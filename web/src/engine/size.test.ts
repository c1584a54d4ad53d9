/** What a browser loads before the first picture is bounded, as a server sends it. */
import { existsSync, readFileSync } from "node:fs";
import { brotliCompressSync, constants } from "node:zlib";
import { expect, test } from "vitest";

const LIBRARY = new URL("../../public/gonio.wasm", import.meta.url);

test.skipIf(!existsSync(LIBRARY))("the library takes at most 2.5 MB, compressed", { timeout: 300_000 }, () => {
  const bytes = readFileSync(LIBRARY);
  const { length } = brotliCompressSync(bytes, {
    params: { [constants.BROTLI_PARAM_QUALITY]: 11, [constants.BROTLI_PARAM_LGWIN]: 24, [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length },
  });
  console.info(`gonio.wasm: ${(length / 1e6).toFixed(3)} MB by brotli, ${(bytes.length / 1e6).toFixed(1)} MB as it is`);
  expect(length).toBeLessThanOrEqual(2.5e6);
});
