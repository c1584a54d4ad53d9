/** The factors of the reflection equation, each to be switched off: Lr = ∫ L f cosθ dω. */
import type { JSX } from "preact";
import type { Factors } from "../engine/protocol";
import { factors } from "../state";

const ALL: { key: keyof Factors; sign: string; name: string }[] = [
  { key: "light", sign: "L", name: "The light’s radiance L" },
  { key: "brdf", sign: "f", name: "The reflection function f" },
  { key: "cosine", sign: "cos θ", name: "The cosine of the angle of incidence" },
];

export function FactorSwitches(): JSX.Element {
  return (
    <div class="factors" role="group" aria-label="Factors of the reflection equation that take part">
      {ALL.map(({ key, sign, name }) => (
        <button key={key} type="button" class="factor" aria-pressed={factors.value[key]} aria-label={name} title={name} onClick={() => (factors.value = { ...factors.value, [key]: !factors.value[key] })}>
          {sign}
        </button>
      ))}
    </div>
  );
}
