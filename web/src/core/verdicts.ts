/** What the laboratory's properties are called, and mean. */

const MEANINGS: Record<string, [string, string]> = {
  finite: ["Finite", "No value is infinite or not a number."],
  non_negative: ["Non-negative", "f ≥ 0 for every pair of directions: a surface can't reflect less than nothing."],
  horizon: ["Horizon", "Nothing is reflected from or to directions below the surface."],
  continuity: ["Continuity", "f·|cosθ| goes to 0 as the light goes below the horizon, without a step."],
  reciprocity: ["Reciprocity", "f(ωi→ωr) = f(ωr→ωi): light and viewer can change places (Helmholtz)."],
  energy_conservation: ["Energy conservation", "No more light leaves than arrives: the directional albedo is at most 1 for every direction."],
  energy_loss: ["Energy loss", "The largest part of the light that is lost in the surface: information, not a verdict."],
  isotropy: ["Isotropy", "f doesn't change when light and viewer are turned together around the normal."],
  linearity: ["Linearity", "The reflection of a sum of lights is the sum of their reflections."],
  pdf_integral: ["Integral of the pdf", "The density of sampled directions integrates to 1."],
  sample_density: ["Density of samples", "Sampled directions are distributed as the pdf says (χ² test)."],
  sample_weight: ["Weight of samples", "A sample's weight is f·|cosθ|/pdf at its direction."],
  single_precision: ["Single precision", "Values in 32-bit arithmetic agree with those in 64-bit."],
  declarations: ["Declarations", "What the model declares of itself holds."],
};

/** A property's name and meaning; a new one is shown under the library's own word. */
export function meaning(property: string): { name: string; text: string | null } {
  const known = MEANINGS[property];
  if (known !== undefined) return { name: known[0], text: known[1] };
  const words = property.replace(/_/g, " ");
  return { name: words.charAt(0).toUpperCase() + words.slice(1), text: null };
}

/** A figure for people: three digits, and powers of ten where it is small or large. */
export function figure(x: number | null): string {
  if (x === null) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 0.001 && size < 10000) return String(Number(x.toPrecision(4)));
  const [digits, power] = x.toExponential(1).split("e") as [string, string];
  const raised = [...String(Number(power))].map((c) => ({ "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" })[c]!).join("");
  return `${digits.replace("-", "−")}·10${raised}`;
}
