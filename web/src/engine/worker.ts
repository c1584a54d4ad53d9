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

function ready(): Promise<Instance> {
  if (module === null) throw new Error("the worker was asked before it was started");
  return (instance ??= Instance.make(module, files));
}

/** Either the library's own complaint, or what is known of a trap: that leaves the instance's memory in an unknown state, so the next call gets a new one. */
function refusal(error: unknown, operation: string, running: Instance | null): { complaint: Complaint; lost: boolean } {
  if (error instanceof LibraryError) return { complaint: error.complaint, lost: false };
  instance = null;
  const why = running?.lastWords() || (error instanceof Error ? error.message : String(error));
  const complaint: Complaint = {
    message: `the engine stopped in ‘${operation}’: ${why}`,
    help: "it has been started again and nothing that you set is lost; please report this, with the permanent link",
    place: null,
  };
  return { complaint, lost: true };
}

async function call({ id, operation, request, along }: Extract<ToWorker, { kind: "call" }>): Promise<void> {
  let running: Instance | null = null;
  try {
    running = await ready();
    const answered = running.call(operation, request);
    const followed: (Answered | { complaint: Complaint })[] = [];
    for (const one of along) followed.push(await follow(one, (answered.answer as Description).text));
    const data = [answered, ...followed].flatMap((a) => ("data" in a ? [a.data] : []));
    scope.postMessage({ id, ...answered, along: followed }, data);
  } catch (error) {
    scope.postMessage({ id, ...refusal(error, operation, running) }, []);
  }
}

/** What was asked along is answered for itself: a function that can be described may have no curve. */
async function follow({ operation, request }: Along, text: string): Promise<Answered | { complaint: Complaint }> {
  let running: Instance | null = null;
  try {
    running = await ready();
    return running.call(operation, { ...request, function: text });
  } catch (error) {
    return { complaint: refusal(error, operation, running).complaint };
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
