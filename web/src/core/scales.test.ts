import { describe, expect, it } from "vitest";
import { fromHex, position, toHex, value } from "./scales";

describe("sliders", () => {
  it.each([
    [0, 1],
    [-2, 2],
    [0.1, 10],
    [0, 200000],
    [1, 1000],
    [-360, 360],
  ])("go from %d to %d and back", (low, high) => {
    expect(value(0, low, high)).toBe(low);
    expect(value(1, low, high)).toBe(high);
    let last = -Infinity;
    for (let i = 0; i <= 100; i++) {
      const x = value(i / 100, low, high);
      expect(x).toBeGreaterThan(last);
      expect(position(x, low, high)).toBeCloseTo(i / 100, 2);
      last = x;
    }
  });
  it("give small values of wide ranges room", () => {
    expect(value(0.5, 0, 200000)).toBeLessThan(10000);
    expect(value(0.5, 0, 1)).toBe(0.5);
  });
  it("stay inside for values outside", () => {
    expect(position(5, 0, 1)).toBe(1);
    expect(position(-5, 0, 200000)).toBe(0);
  });
});

describe("swatches", () => {
  it("keep every byte", () => {
    for (let i = 0; i < 256; i++) {
      const hex = `#${i.toString(16).padStart(2, "0")}8000`;
      expect(toHex(fromHex(hex))).toBe(hex);
    }
  });
  it("know sRGB's middle grey", () => {
    expect(fromHex("#bcbcbc")[0]).toBeCloseTo(0.5029, 4);
    expect(toHex([2, -1, 0.0031308])).toBe("#ff000a");
  });
});
