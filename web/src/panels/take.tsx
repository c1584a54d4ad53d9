/** Taking it away: the link, the description in other forms, shader code, the command's own plots. */
import { signal, useSignal } from "@preact/signals";
import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { catalogue } from "../catalogue";
import { shortName } from "../core/text";
import { engine } from "../engine/client";
import type { Complaint, Requests } from "../engine/protocol";
import { complaintOf } from "../functions";
import { permanentLink } from "../persist";
import { hand, pngOfSvg } from "../plot/save";
import { channel, cosine, current, difference, functions, phiD, scale, visible, wi } from "../state";
import { Section } from "./description";
import { Copyable, Dialog, Icon, Problem } from "./ui";

export const taking = signal(false);

export function Take(): JSX.Element | null {
  if (!taking.value) return null;
  const close = (): void => void (taking.value = false);
  const shown = current.value;
  const as = shown?.description?.as;
  return (
    <Dialog title="Take away" onClose={close} wide>
      <LinkSection />
      {shown !== null && as !== undefined ? (
        <Section title={`The function: ${shortName(shown.text, [])[0]}`}>
          <Copyable label="Description" text={shown.text} />
          <Copyable label="Command line" text={as.command} />
          <Copyable label="Scene file (TOML)" text={as.toml} />
          <Copyable label="Rust" text={as.rust} />
          <Copyable label="Python" text={as.python} />
        </Section>
      ) : null}
      {shown?.description != null ? <ShaderCode key={shown.id} text={shown.text} recordable={shown.description.recordable} /> : null}
      <Plots />
      <p class="quiet">Values as CSV and pictures as PNG are saved from each view’s own menu.</p>
    </Dialog>
  );
}

function LinkSection(): JSX.Element {
  const link = useSignal<{ address: string; needs: string[] } | null>(null);
  useEffect(() => void permanentLink().then((made) => (link.value = made)), []);
  return (
    <Section title="Permanent link" hint="The link holds everything that is shown: functions, directions, scales, and the text of shaders. It is in the part of the address that no server sees.">
      {link.value !== null ? <Copyable label="Address" text={link.value.address} /> : null}
      {link.value !== null && link.value.needs.length > 0 ? (
        <p class="note">
          {link.value.needs.join(", ")}: measured files and panoramas are too large for a link. Send {link.value.needs.length === 1 ? "it" : "them"} along; the page asks for{" "}
          {link.value.needs.length === 1 ? "it" : "them"}.
        </p>
      ) : null}
    </Section>
  );
}

function ShaderCode({ text, recordable }: { text: string; recordable: boolean }): JSX.Element {
  const language = useSignal("wgsl");
  const code = useSignal<string | null>(null);
  const problem = useSignal<Complaint | null>(null);
  const languages = catalogue.value?.languages ?? [];
  useEffect(() => {
    if (!recordable) return;
    let gone = false;
    engine
      .ask("export", { function: text, language: language.value }, { pool: "slow", key: "export" })
      .then((reply) => {
        if (gone || reply === null) return;
        code.value = reply.answer.text;
        problem.value = null;
      })
      .catch((error: unknown) => {
        if (gone) return;
        code.value = null;
        problem.value = complaintOf(error);
      });
    return () => void (gone = true);
  }, [text, language.value, recordable]);
  if (!recordable)
    return (
      <Section title="Shader code">
        <p class="quiet">Tables, searches and random walks can’t be written as shader code: this function has none.</p>
      </Section>
    );
  const extension = languages.find((l) => l.name === language.value)?.extension ?? language.value;
  return (
    <Section title="Shader code" hint="The function as code, written from the same source that computes what you see.">
      <label class="row">
        Language
        <select class="select" value={language.value} onChange={(event) => (language.value = event.currentTarget.value)}>
          {languages.map((l) => (
            <option key={l.name} value={l.name}>
              {l.label}
            </option>
          ))}
        </select>
      </label>
      {problem.value !== null ? <Problem complaint={problem.value} /> : null}
      {code.value !== null ? (
        <>
          <Copyable label="Code" text={code.value} />
          <button type="button" class="button" onClick={() => hand(`${fileStem(text)}.${extension}`, code.value!, "text/plain")}>
            <Icon name="take" />
            Save {fileStem(text)}.{extension}
          </button>
        </>
      ) : null}
    </Section>
  );
}

function fileStem(text: string): string {
  return (shortName(text, [])[0].replace(/\.[^.]*$/, "") || "function").replace(/[^\w-]+/g, "-");
}

type PlotKind = Requests["plot"]["request"]["kind"];
const PLOTS: { kind: PlotKind; name: string }[] = [
  { kind: "polar", name: "Polar" },
  { kind: "cartesian", name: "Cartesian" },
  { kind: "albedo", name: "Albedo" },
  { kind: "slice", name: "Slice" },
  { kind: "lobe3d", name: "Lobe in space" },
  { kind: "sphere", name: "Lit ball" },
  { kind: "difference", name: "Difference" },
];

/** The command's `--phi`: of the plane of incidence, towards the side where a mirror reflects; of albedos that of the light. Functions that are isotropic don't depend on it. */
function azimuth(kind: PlotKind): number {
  const turned = visible.value.some((f) => f.description?.declares.isotropic === false);
  if (!turned || kind === "slice" || kind === "sphere") return 0;
  const phi = kind === "albedo" ? wi.value.phi : wi.value.phi - 180;
  return phi <= -180 ? phi + 360 : phi;
}

function Plots(): JSX.Element {
  const problem = useSignal<Complaint | null>(null);
  const notes = useSignal<string[]>([]);
  const going = useSignal<string | null>(null);
  const pair = difference.value?.map((id) => functions.value.find((f) => f.id === id)?.text) ?? visible.value.slice(0, 2).map((f) => f.text);
  const plot = async (kind: PlotKind, as: "svg" | "png"): Promise<void> => {
    going.value = `${kind} ${as}`;
    problem.value = null;
    try {
      const reply = await engine.ask(
        "plot",
        {
          functions: kind === "difference" ? pair.filter((text) => text !== undefined) : visible.value.map((f) => f.text),
          kind,
          theta: [wi.value.theta],
          phi: azimuth(kind),
          phi_d: phiD.value,
          scale: scale.value,
          channel: channel.value,
          cosine: cosine.value,
        },
        { pool: "slow", key: "plot" },
      );
      if (reply === null) return;
      notes.value = reply.answer.notes;
      if (as === "svg") hand(`gonio-${kind}.svg`, reply.answer.svg, "image/svg+xml");
      else hand(`gonio-${kind}.png`, await pngOfSvg(reply.answer.svg));
    } catch (error) {
      problem.value = complaintOf(error);
    } finally {
      going.value = null;
    }
  };
  return (
    <Section title="Plots for papers" hint="The command’s own plots of the visible functions at the present direction of incidence, on white, with legend and axes: what gonio brdf plot writes.">
      <ul class="plots">
        {PLOTS.map(({ kind, name }) => (
          <li key={kind}>
            <span>{kind === "slice" ? `${name}, φd = ${phiD.value}°` : name}</span>
            {(["svg", "png"] as const).map((as) => (
              <button
                key={as}
                type="button"
                class="button"
                aria-label={`Save ${name} as ${as.toUpperCase()}`}
                disabled={going.value !== null || visible.value.length === 0 || (kind === "difference" && pair.length !== 2)}
                onClick={() => void plot(kind, as)}
              >
                {going.value === `${kind} ${as}` ? "…" : as.toUpperCase()}
              </button>
            ))}
          </li>
        ))}
      </ul>
      {notes.value.map((note) => (
        <p class="quiet" key={note}>
          {note}
        </p>
      ))}
      {problem.value !== null ? <Problem complaint={problem.value} /> : null}
    </Section>
  );
}
