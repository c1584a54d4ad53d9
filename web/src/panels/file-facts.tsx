/** What a measured file holds, as the library read it. */
import { useSignal } from "@preact/signals";
import { Fragment, type JSX } from "preact";
import { useEffect } from "preact/hooks";
import { engine } from "../engine/client";
import type { Complaint, Requests } from "../engine/protocol";
import { complaintOf } from "../functions";
import { Problem } from "./ui";

export function FileFacts({ name }: { name: string }): JSX.Element | null {
  const facts = useSignal<Requests["file"]["answer"] | null>(null);
  const problem = useSignal<Complaint | null>(null);
  useEffect(() => {
    let gone = false;
    engine
      .ask("file", { path: `files/${name}` }, { pool: "slow", key: `file:${name}` })
      .then((reply) => {
        if (!gone && reply !== null) facts.value = reply.answer;
      })
      .catch((error: unknown) => {
        if (!gone) problem.value = complaintOf(error);
      });
    return () => void (gone = true);
  }, [name]);
  if (problem.value !== null) return <Problem complaint={problem.value} />;
  if (facts.value === null) return null;
  const { format, summary, metadata, notes } = facts.value;
  return (
    <details class="part file-facts">
      <summary>
        <span class="part-name">{name}</span>
        <span class="quiet">{format}</span>
      </summary>
      <div class="part-body">
        <p>{summary}</p>
        <dl class="facts">
          {metadata.map(([key, value]) => (
            <Fragment key={key}>
              <dt>{key}</dt>
              <dd>{value}</dd>
            </Fragment>
          ))}
        </dl>
        {notes.map((note) => (
          <p class="note" key={note}>
            {note}
          </p>
        ))}
      </div>
    </details>
  );
}
