/** Between the state and the permanent link. */
import { effect } from "@preact/signals";
import { decode, encode, type Linked } from "./core/link";
import { filesIn } from "./core/text";
import { engine } from "./engine/client";
import { held, missing, putShader } from "./files";
import { add, remove } from "./functions";
import { complain } from "./notices";
import { isLearn } from "./route";
import * as state from "./state";

/** Opened without a link: a metal and a plastic show what the views are for. */
const OPENING = ["ggx:metal=gold,roughness=0.3", "sum(lambertian:0.1/0.25/0.4, ggx:f0=0.04,roughness=0.2)"];

function snapshot(): Linked {
  const functions = state.functions.value;
  const index = (id: number): number => functions.findIndex((f) => f.id === id);
  const names = new Set(filesIn([...functions.map((f) => f.text), state.light.value].join(" ")));
  const shaders: Record<string, string> = {};
  const needs: string[] = [...missing.value];
  for (const file of held.value) {
    if (!names.has(file.name)) continue;
    if (file.source !== null) shaders[file.name] = file.source;
    else needs.push(file.name);
  }
  const pair = state.difference.value;
  return {
    functions: functions.map(({ text, preset, colour, visible }) => ({ text: preset ?? text, colour, visible })),
    selected: Math.max(0, index(state.selected.value)),
    wi: state.wi.value,
    wo: state.wo.value,
    scale: state.scale.value,
    channel: state.channel.value,
    cosine: state.cosine.value,
    exposure: state.exposure.value,
    toneMap: state.toneMap.value,
    phiD: state.phiD.value,
    object: state.object.value,
    light: state.light.value,
    turn: state.turn.value,
    factors: state.factors.value,
    difference: pair === null ? null : [index(pair[0]), index(pair[1])],
    large: state.large.value,
    shaders,
    needs: [...new Set(needs)],
  };
}

/** The address that holds everything that is shown now, and the files that it can't hold. */
export async function permanentLink(): Promise<{ address: string; needs: string[] }> {
  const now = snapshot();
  const address = new URL(location.href);
  address.hash = await encode(now);
  return { address: address.href, needs: now.needs };
}

let written = "";

async function restore(hash: string): Promise<void> {
  const { state: linked, problems } = await decode(hash);
  if (problems.length > 0) complain({ message: `the link could not be used wholly: ${problems.join("; ")}`, help: "the rest of it is shown", place: null });
  for (const f of state.functions.value) remove(f.id);
  for (const [name, text] of Object.entries(linked.shaders)) putShader(name, text);
  missing.value = linked.needs.filter((name) => !engine.hasFile(name));
  state.wi.value = linked.wi;
  state.wo.value = linked.wo;
  // Beside a metal's peak a plastic's can be seen with the cube root only; a link says what it wants.
  state.scale.value = hash.length > 1 ? linked.scale : "cube-root";
  state.channel.value = linked.channel;
  state.cosine.value = linked.cosine;
  state.exposure.value = linked.exposure;
  state.toneMap.value = linked.toneMap;
  state.phiD.value = linked.phiD;
  state.object.value = linked.object;
  // A panorama that is missing would leave the picture empty.
  state.light.value = missing.value.some((name) => linked.light === `files/${name}`) ? state.light.value : linked.light;
  state.turn.value = linked.turn;
  state.factors.value = linked.factors;
  state.large.value = linked.large;
  const functions = linked.functions.length > 0 ? linked.functions : OPENING.map((text, colour) => ({ text, colour, visible: true }));
  const ids = functions.map((f) => add(f.text, f)!);
  state.selected.value = ids[linked.selected] ?? ids[0] ?? 0;
  const pair = linked.difference;
  state.difference.value = pair === null ? null : [ids[pair[0]]!, ids[pair[1]]!];
}

/** Restores what the address holds, and keeps the address up to date from then on. */
export async function persist(): Promise<void> {
  await restore(isLearn(location.hash) ? "" : location.hash);
  written = location.hash;
  addEventListener("hashchange", () => {
    if (isLearn(location.hash) || location.hash === written || location.hash === "") return;
    written = location.hash;
    void restore(location.hash);
  });
  let timer = 0;
  effect(() => {
    const now = snapshot();
    clearTimeout(timer);
    // Browsers refuse more than a hundred changes of the address in half a minute.
    timer = setTimeout(() => {
      void encode(now).then((hash) => {
        if (isLearn(location.hash)) return;
        written = `#${hash}`;
        history.replaceState(null, "", written);
      });
    }, 500);
  });
}
