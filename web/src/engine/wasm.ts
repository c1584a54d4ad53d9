/**
 * One instance of the library, compiled to WebAssembly: a call in, an answer out. Runs inside of a worker.
 *
 * The library reads files through WASI; they lie in a folder in memory, which it sees as `files`.
 */
import { ConsoleStdout, File, type Inode, OpenFile, PreopenDirectory, WASI } from "@bjorn3/browser_wasi_shim";
import type { Complaint } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  _initialize?: () => void;
  gonio_alloc(length: number): number;
  gonio_free(pointer: number, length: number): void;
  gonio_call(pointer: number, length: number): number;
}

/** What the library answered: text, and all its numbers in one piece. */
export interface Answered {
  answer: unknown;
  /** First number and how many, of each array. */
  arrays: Record<string, [number, number]>;
  data: ArrayBuffer;
}

/** The library's own error: the instance is sound and goes on. Anything else that `call` throws means that it is lost. */
export class LibraryError extends Error {
  constructor(readonly complaint: Complaint) {
    super(complaint.message);
  }
}

/** The files, shared by the instances that follow each other in one worker. */
export type Files = Map<string, Inode>;

export class Instance {
  private constructor(
    private readonly wasi: WASI,
    private readonly exports: Exports,
    private readonly stderr: { lines: string[] },
  ) {}

  static async make(module: WebAssembly.Module, files: Files): Promise<Instance> {
    const stderr = { lines: [] as string[] };
    const wasi = new WASI(
      ["gonio"],
      [],
      [
        new OpenFile(new File([])),
        ConsoleStdout.lineBuffered(() => undefined),
        ConsoleStdout.lineBuffered((line) => stderr.lines.push(line)),
        new PreopenDirectory("files", files),
      ],
      // Unless it is told otherwise, the shim writes every path that is opened to the console.
      { debug: false },
    );
    const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport as WebAssembly.ModuleImports });
    const exports = instance.exports as unknown as Exports;
    wasi.initialize({ exports });
    return new Instance(wasi, exports, stderr);
  }

  /** What it said before it was lost: the message of a panic. */
  lastWords(): string {
    return this.stderr.lines.slice(0, 2).join(" ");
  }

  call(operation: string, request: unknown): Answered {
    this.stderr.lines.length = 0;
    const text = new TextEncoder().encode(JSON.stringify({ operation, request }));
    const input = this.exports.gonio_alloc(text.length);
    new Uint8Array(this.exports.memory.buffer, input, text.length).set(text);
    const output = this.exports.gonio_call(input, text.length);
    this.exports.gonio_free(input, text.length);
    // The memory may have grown during the call, which detaches older views of it.
    const header = new DataView(this.exports.memory.buffer, output, 8);
    const total = header.getUint32(0, true);
    const json = header.getUint32(4, true);
    const parsed = JSON.parse(new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, output + 8, json))) as
      | { answer: unknown; arrays?: Record<string, [number, number]> }
      | { error: Complaint };
    const first = 8 + Math.ceil(json / 4) * 4;
    const data = this.exports.memory.buffer.slice(output + first, output + total) as ArrayBuffer;
    this.exports.gonio_free(output, total);
    this.forgetClosedFiles();
    if ("error" in parsed) throw new LibraryError(parsed.error);
    return { answer: parsed.answer, arrays: parsed.arrays ?? {}, data };
  }

  /** The shim never uses a number of a closed file again; without this its table would grow with every file that is read. */
  private forgetClosedFiles(): void {
    const open = this.wasi.fds as (unknown | undefined)[];
    while (open.length > 4 && open[open.length - 1] === undefined) open.pop();
  }
}
