/** The laboratory's verdicts on one function, with the pair of directions that refutes what fails. */
import { signal, useSignal } from "@preact/signals";
import { Fragment, type JSX } from "preact";
import { useEffect } from "preact/hooks";
import { figure, meaning } from "../core/verdicts";
import { engine } from "../engine/client";
import type { Angles, Complaint, Report, Verdict, WitnessDirection } from "../engine/protocol";
import { complaintOf, find } from "../functions";
import { say } from "../notices";
import { type Shown, wi, wo } from "../state";
import { Hint, Icon, type IconName, Problem } from "./ui";

interface Checked {
  /** The text and revision that it is about. */
  subject: string;
  report: Report;
}

/** Reports stay while other functions are looked at. */
const reports = signal<ReadonlyMap<number, Checked>>(new Map());

const LOOKS: Record<Verdict["outcome"], { icon: IconName; word: string; tone: string }> = {
  pass: { icon: "check", word: "pass", tone: "good" },
  fail: { icon: "cross", word: "fail", tone: "bad" },
  allowed: { icon: "check", word: "allowed", tone: "warn" },
  declared: { icon: "dot", word: "declared", tone: "warn" },
  information: { icon: "dot", word: "info", tone: "quiet" },
  not_applicable: { icon: "dot", word: "n/a", tone: "quiet" },
};

function angles(direction: WitnessDirection): Angles {
  return { theta: direction.theta_deg, phi: direction.phi_deg };
}

/** θ, φ. */
function degrees(a: Angles): string {
  const one = (x: number): string => `${String(Math.round(x * 10) / 10).replace("-", "−")}°`;
  return `${one(a.theta)}, ${one(a.phi)}`;
}

/** Takes every view to the witness. */
function goTo(verdict: Verdict): void {
  const witness = verdict.witness!;
  // A property of one direction has it as the direction of incidence in the views: the albedo for this light.
  const light = angles(witness.wi ?? witness.wo);
  wi.value = { theta: Math.min(light.theta, 89.5), phi: light.phi };
  wo.value = witness.wi === null ? null : angles(witness.wo);
  const name = meaning(verdict.property).name.toLowerCase();
  if (light.theta > 90) say(`The witness of ${name} has its light below the surface, at θ ${Math.round(light.theta)}°; the views show light from above, here at 89.5°`);
  else say(`Every view shows the witness of ${name}`);
}

export function Verdicts({ shown }: { shown: Shown }): JSX.Element {
  const effort = useSignal<"quick" | "standard">("quick");
  const running = useSignal(false);
  const problem = useSignal<Complaint | null>(null);
  const subject = `${shown.text}\n${shown.revision}\n${effort.value}`;
  const checked = reports.value.get(shown.id);
  const fresh = checked?.subject === subject;

  useEffect(() => {
    if (shown.description === null || reports.value.get(shown.id)?.subject === subject) return;
    let gone = false;
    // While a slider moves nothing is checked: each check takes a second or more.
    const timer = setTimeout(() => {
      running.value = true;
      problem.value = null;
      engine
        .ask("check", { function: shown.text, effort: effort.value }, { pool: "check", key: "check", interrupt: true })
        .then((reply) => {
          if (reply === null) return;
          const kept = [...reports.value].filter(([id]) => find(id) !== undefined);
          reports.value = new Map(kept).set(shown.id, { subject, report: reply.answer });
          if (!gone) running.value = false;
        })
        .catch((error: unknown) => {
          if (gone) return;
          problem.value = complaintOf(error);
          running.value = false;
        });
    }, 400);
    return () => {
      gone = true;
      clearTimeout(timer);
    };
  }, [subject, shown.id, shown.description === null]);

  const failed = checked?.report.verdicts.filter((v) => v.outcome === "fail").length ?? 0;
  return (
    <div class="verdicts" aria-busy={running.value}>
      <div class="verdicts-head">
        <p class={`verdict-sum ${checked === undefined || !fresh ? "tone-quiet" : failed > 0 ? "tone-bad" : "tone-good"}`} role="status">
          {checked === undefined
            ? problem.value !== null
              ? "Not checked"
              : "Checking …"
            : !fresh
              ? "Checking the changed function …"
              : failed > 0
                ? `${failed} of ${checked.report.verdicts.length} fail`
                : "Nothing is refuted"}
        </p>
        <label class="effort">
          Effort
          <select class="select" value={effort.value} onChange={(event) => (effort.value = event.currentTarget.value as "quick" | "standard")}>
            <option value="quick">quick</option>
            <option value="standard">standard</option>
          </select>
        </label>
        <Hint about="verdicts">
          Each property is tested at many directions by the same code as <code>gonio brdf check</code>. A fail names the worst pair of directions: its witness. Go to it, and every view shows
          it. Directions are θ, φ.
        </Hint>
      </div>
      {problem.value !== null ? <Problem complaint={problem.value} /> : null}
      {checked !== undefined ? (
        <ul class={`verdict-list ${fresh ? "" : "verdict-old"}`}>
          {checked.report.verdicts.map((verdict) => (
            <Row key={verdict.property} verdict={verdict} />
          ))}
        </ul>
      ) : null}
    </div>
  );
}

function Row({ verdict }: { verdict: Verdict }): JSX.Element {
  const look = LOOKS[verdict.outcome] ?? LOOKS.information;
  const { name, text } = meaning(verdict.property);
  const witness = verdict.witness;
  return (
    <li class={`verdict tone-${look.tone}`}>
      <details>
        <summary>
          <span class="verdict-mark">
            <Icon name={look.icon} />
          </span>
          <span class="verdict-name">{name}</span>
          <span class="verdict-word">{look.word}</span>
          <span class="verdict-figure">{verdict.p_value !== null ? `p ${figure(verdict.p_value)}` : verdict.figure !== null ? figure(verdict.figure) : ""}</span>
        </summary>
        <div class="verdict-body">
          {text !== null ? <p>{text}</p> : null}
          <p class="quiet">{verdict.detail}</p>
          {verdict.note !== null ? <p class="quiet">{verdict.note}</p> : null}
          <dl class="facts">
            {verdict.bound !== null ? (
              <>
                <dt>bound</dt>
                <dd>{figure(verdict.bound)}</dd>
              </>
            ) : null}
            {verdict.samples > 0 ? (
              <>
                <dt>evaluations</dt>
                <dd>{verdict.samples.toLocaleString("en")}</dd>
              </>
            ) : null}
            {witness?.values.map((v) => (
              <Fragment key={v.name}>
                <dt>{v.name}</dt>
                <dd>{figure(v.value)}</dd>
              </Fragment>
            ))}
          </dl>
        </div>
      </details>
      {witness !== null ? (
        <button type="button" class="witness" title="Show this pair of directions (θ, φ) in every view" onClick={() => goTo(verdict)}>
          <Icon name="go" />
          <span>
            <span class="hidden">Go to the witness of {name}: </span>
            {witness.wi !== null ? `ωi ${degrees(angles(witness.wi))} → ωo ${degrees(angles(witness.wo))}` : `ω ${degrees(angles(witness.wo))}`}
          </span>
        </button>
      ) : null}
    </li>
  );
}
