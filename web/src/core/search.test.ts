import { describe, expect, it } from "vitest";
import type { Catalogue, ModelEntry } from "../engine/protocol";
import { choices, search } from "./search";

const entry = (name: string, more: Partial<ModelEntry>): ModelEntry => ({
  name,
  summary: "",
  paper: "",
  parameters: [],
  positional: null,
  aliases: [],
  recordable: true,
  presets: [],
  example: name,
  ...more,
});
const CATALOGUE: Catalogue = {
  version: "0",
  measured: [],
  languages: [],
  models: [
    entry("ward", { summary: "a Gaussian lobe", presets: ["ward@gold-paint", "ward@nickel"] }),
    entry("torrance-sparrow", { summary: "microfacets", aliases: [{ name: "ggx", sets: [["distribution", "ggx"]] }] }),
    entry("table", { summary: "a measured table", example: null }),
    entry("gold-leaf", { summary: "nothing that Ward knew" }),
  ],
};
const names = (query: string, model: string | null = null): string[] => search(choices(CATALOGUE, model), query, model !== null).map((c) => c.name);

describe("the search in the registry", () => {
  it("shows models and aliases, without what needs a file", () => {
    expect(names("")).toEqual(["ward", "torrance-sparrow", "ggx", "gold-leaf"]);
  });
  it("finds presets, and names before summaries", () => {
    expect(names("gold")).toEqual(["gold-leaf", "ward@gold-paint"]);
    expect(names("ward")).toEqual(["ward", "ward@gold-paint", "ward@nickel", "gold-leaf"]);
    expect(names("NICKEL ward")).toEqual(["ward@nickel"]);
    expect(names("no such")).toEqual([]);
  });
  it("shows the presets of one model", () => {
    expect(names("", "ward")).toEqual(["ward@gold-paint", "ward@nickel"]);
  });
});
