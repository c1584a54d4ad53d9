import { expect, test } from "vitest";
import { formula, type Node } from "./math";

const text = ([name, content]: Node): string => `<${name}>${typeof content === "string" ? content : content.map(text).join("")}</${name}>`;
const set = (source: string): string => text(formula(source)).replace(/^<math><mrow>|<\/mrow><\/math>$/g, "");

test("letters, numbers, signs, and names of functions", () => {
  expect(set("x = 2.5 sinθ")).toBe("<mi>x</mi><mo>=</mo><mn>2.5</mn><mspace></mspace><mi>sin</mi><mspace></mspace><mi>θ</mi>");
});

test("differentials are set apart, and so are formulas on one line", () => {
  expect(set("L dω")).toBe("<mi>L</mi><mspace></mspace><mi>d</mi><mi>ω</mi>");
  expect(set("a,  b")).toBe("<mi>a</mi><mo>,</mo><mspace></mspace><mi>b</mi>");
  expect(set("\\text{W m}")).toBe("<mtext>W\u00a0m</mtext>");
});

test("scripts belong to what stands before them", () => {
  expect(set("ω_i")).toBe("<msub><mi>ω</mi><mi>i</mi></msub>");
  expect(set("cos^p α")).toBe("<msup><mi>cos</mi><mi>p</mi></msup><mspace></mspace><mi>α</mi>");
  expect(set("x_{ab}^2")).toBe("<msubsup><mi>x</mi><mrow><mi>a</mi><mi>b</mi></mrow><mn>2</mn></msubsup>");
  expect(set("ρ_d")).toBe("<msub><mi>ρ</mi><mi>d</mi></msub>");
  expect(set("∑_i x")).toBe("<munder><mo>∑</mo><mi>i</mi></munder><mi>x</mi>");
});

test("fractions and roots", () => {
  expect(set("\\frac{A}{r^2}")).toBe("<mfrac><mi>A</mi><msup><mi>r</mi><mn>2</mn></msup></mfrac>");
  expect(set("\\sqrt{x}")).toBe("<msqrt><mi>x</mi></msqrt>");
});

test("an open brace is no formula", () => {
  expect(() => formula("\\frac{A}{r")).toThrow("open");
});
