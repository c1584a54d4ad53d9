import { describe, expect, it } from "vitest";
import { decode, encode, INITIAL, type Linked, pack, unpack } from "./link";

const FULL: Linked = {
  functions: [
    { text: "sum(lambertian:0.4, ggx:f0=0.04,roughness=0.2)", colour: 3, visible: true },
    { text: "files/mine-ü&#%+.wgsl:tint=#ff8000", colour: 0, visible: false },
  ],
  selected: 1,
  wi: { theta: 60.25, phi: -12.5 },
  wo: { theta: 120, phi: 3 },
  scale: "log",
  channel: "rgb",
  cosine: true,
  exposure: -1.5,
  toneMap: "aces",
  phiD: 30,
  object: "ball",
  light: "sky:elevation=30",
  turn: 77,
  factors: { light: true, brdf: false, cosine: false },
  difference: [1, 0],
  large: "slice",
  shaders: { "mine.wgsl": "// θ → φ\n".repeat(100), "b.brdf": "analytic" },
  needs: ["paint.binary"],
};

describe("the permanent link", () => {
  it("gives back every part of the state", async () => {
    const { state, problems } = await decode(`#${await encode(FULL)}`);
    expect(problems).toEqual([]);
    expect(state).toEqual(FULL);
  });
  it("leaves out what has its initial value, and stays readable", async () => {
    const functions = [{ text: "ggx:metal=gold,roughness=0.3", colour: 0, visible: true }];
    expect(await encode({ ...INITIAL, functions })).toBe("f=ggx:metal=gold,roughness=0.3");
  });
  it("survives a trip through an address", async () => {
    const address = new URL(`https://example.org/#${await encode(FULL)}`);
    expect((await decode(address.hash)).state).toEqual(FULL);
  });
  it.each([
    ["wi=95,0", "θ,φ"],
    ["wi=45", "θ,φ"],
    ["wi=,0", "θ,φ"],
    ["exposure=NaN", "a number"],
    ["exposure=", "a number"],
    ["scale=Log", "one of"],
    ["hidden=-1", "indices"],
    ["f=%E0%A4", "cut off"],
    ["nonsense=1", "not known"],
    ["shader=a.wgsl:q", "expected text"],
    ["shader=a.wgsl:z____", "damaged"],
    ["shader=a.wgsl:t!!", "base64"],
    ["shader=../x:tQQ", "NAME:TEXT"],
  ])("says what is wrong with %s and keeps the rest", async (bad, words) => {
    const { state, problems } = await decode(`#f=lambertian&${bad}&turn=5`);
    expect(problems).toHaveLength(1);
    expect(problems[0]).toContain(words);
    expect(state).toEqual({ ...INITIAL, functions: [{ text: "lambertian", colour: 0, visible: true }], turn: 5 });
  });
  it("ignores indices of functions that aren't there", async () => {
    const { state } = await decode("#f=mirror&selected=4&difference=0,3&hidden=2&colours=1,5");
    expect(state.selected).toBe(0);
    expect(state.difference).toBeNull();
    expect(state.functions).toEqual([{ text: "mirror", colour: 1, visible: true }]);
  });
  it("does not inflate without end", async () => {
    const bomb = await pack("a".repeat(2 << 20));
    await expect(unpack(bomb)).rejects.toThrow("longer than");
  });
});
