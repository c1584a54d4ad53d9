/** A worker: one instance of the library, one call at a time. */
import { File } from "@bjorn3/browser_wasi_shim";
import { type Answered, type Files, Instance, LibraryError } from "./wasm";
import type { Along, Complaint, Description } from "./protocol";

export type ToWorker =
  | { kind: "start"; module: WebAssembly.Module; files: [string, Uint8Array][] }
  | { kind: "file"; name: string; bytes: Uint8Array }
  | { kind: "call"; id: number; operation: string; request: unknown; along: Along[] };

export type FromWorker =
  | ({ id: number; along?: (Answered | { complaint: Complaint })[] } & Answered)
  | { id: number; complaint: Complaint; lost: boolean };

/** What a worker's global scope has of this; the DOM's types describe a window. */
interface Scope {
  onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
  postMessage(message: FromWorker, transfer: Transferable[]): void;
}
const scope = self as unknown as Scope;

const files: Files = new Map();
let module: WebAssembly.Module | null = null;
let instance: Promise<Instance> | null = null;

async function call(message: Extract<ToWorker, { kind: "call" }>): Promise<void> {
  let running: Instance | null = null;
  try {
    if (module === null) throw new Error("the worker was asked before it was started");
    instance ??= Instance.make(module, files);
    running = await instance;
    const answered = running.call(message.operation, message.request);
    const along: (Answered | { complaint: Complaint })[] = [];
    for (const one of message.along) along.push(follow(running, one, answered.answer as Description));
    const data = [answered, ...along].flatMap((a) => ("data" in a ? [a.data] : []));
    scope.postMessage({ id: message.id, ...answered, along }, data);
  } catch (error) {
    if (error instanceof LibraryError) {
      scope.postMessage({ id: message.id, complaint: error.complaint, lost: false }, []);
      return;
    }
    // A trap leaves the instance's memory in an unknown state; the next call gets a new one.
    instance = null;
    const why = running?.lastWords() || (error instanceof Error ? error.message : String(error));
    const complaint: Complaint = {
      message: `the engine stopped in ‘${message.operation}’: ${why}`,
      help: "it has been started again and nothing that you set is lost; please report this, with the permanent link",
      place: null,
    };
    scope.postMessage({ id: message.id, complaint, lost: true }, []);
  }
}

/** What was asked along is answered for itself: a function that can be described may have no curve. */
function follow(running: Instance, { operation, request }: Along, { text }: Description): Answered | { complaint: Complaint } {
  try {
    return running.call(operation, { ...request, function: text });
  } catch (error) {
    if (error instanceof LibraryError) return { complaint: error.complaint };
    throw error;
  }
}

scope.onmessage = (event) => {
  const message = event.data;
  switch (message.kind) {
    case "start":
      module = message.module;
      for (const [name, bytes] of message.files) files.set(name, new File(bytes, { readonly: true }));
      instance = Instance.make(module, files);
      // A failure is told by the first call.
      instance.catch(() => undefined);
      break;
    case "file": {
      const replaced = files.has(message.name);
      files.set(message.name, new File(message.bytes, { readonly: true }));
      // The library keeps what it read; calls are answered in order, so the next one sees the new file.
      if (replaced) void instance?.then((running) => running.call("forget", {})).catch(() => (instance = null));
      break;
    }
    case "call":
      void call(message);
      break;
  }
};
