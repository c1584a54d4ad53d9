/** What the page tells in passing: errors of files, what was copied, what a link could not hold. */
import { signal } from "@preact/signals";
import type { Complaint } from "./engine/protocol";

export interface Notice extends Complaint {
  id: number;
  tone: "error" | "done";
  /** What it is about: a file's name. */
  subject: string | null;
}

export const notices = signal<Notice[]>([]);
let next = 1;

export function dismissNotice(id: number): void {
  notices.value = notices.value.filter((notice) => notice.id !== id);
}

/** Errors stay until they are dismissed. */
export function complain(complaint: Complaint, subject: string | null = null): void {
  notices.value = [...notices.value.slice(-4), { ...complaint, id: next++, tone: "error", subject }];
}

export function say(message: string): void {
  const id = next++;
  notices.value = [...notices.value.slice(-4), { message, help: null, place: null, id, tone: "done", subject: null }];
  setTimeout(() => dismissNotice(id), 4000);
}
