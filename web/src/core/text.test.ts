import { describe, expect, it } from "vitest";
import { addPart, colourText, composite, fileName, filesIn, parseColour, removePart, replacePart, shortName } from "./text";

describe("parts of a composite", () => {
  it("gives settings to the model before them", () => {
    const found = composite("sum(lambertian:0.4, ggx:f0=0.04,roughness=0.2)")!;
    expect(found.name).toBe("sum");
    expect(found.own).toBe("");
    expect(found.parts.map((p) => p.text)).toEqual(["lambertian:0.4", "ggx:f0=0.04,roughness=0.2"]);
  });
  it("keeps what is before the first model for the composite itself", () => {
    const found = composite("coat(roughness=0.1, color=1/0.8/0.5, lambertian:0.6)")!;
    expect(found.own).toBe("roughness=0.1, color=1/0.8/0.5");
    expect(found.parts.map((p) => p.text)).toEqual(["lambertian:0.6"]);
    expect(composite("mix(#ff8000, lambertian, ggx)")!.own).toBe("#ff8000");
    expect(composite("mix(0.1/0.2/0.3, lambertian, ggx)")!.parts).toHaveLength(2);
  });
  it("does not look into nested composites", () => {
    const found = composite("mix(0.3, sum(lambertian:0.2, phong), coat(roughness=0.1, mirror))")!;
    expect(found.parts.map((p) => p.text)).toEqual(["sum(lambertian:0.2, phong)", "coat(roughness=0.1, mirror)"]);
  });
  it("is null for plain models and unfinished text", () => {
    for (const text of ["ggx:metal=gold", "sum(lambertian", "sum(lambertian))", "sum(a, b", ""]) expect(composite(text)).toBeNull();
  });
});

describe("editing a composite", () => {
  it("replaces one part and leaves every other character", () => {
    expect(replacePart("mix(0.3,  lambertian:0.2,ggx:metal=gold , roughness=0.4)", 1, "phong")).toBe("mix(0.3,  lambertian:0.2,phong)");
    expect(replacePart("sum(lambertian, ggx)", 5, "phong")).toBe("sum(lambertian, ggx)");
  });
  it("adds and removes", () => {
    expect(addPart("sum(lambertian)", " ggx:roughness=0.2 ")).toBe("sum(lambertian, ggx:roughness=0.2)");
    expect(removePart("coat(roughness=0.1, a, b)", 0)).toBe("coat(roughness=0.1, b)");
    expect(removePart("scaled(0.5, a)", 0)).toBe("scaled(0.5, a)");
  });
});

describe("names of files", () => {
  it("have nothing that a description would read", () => {
    expect(fileName("my paint: (gold), v=2.BINARY", () => false)).toBe("my-paint-gold-v-2.binary");
    expect(fileName("../../etc/passwd", () => false)).toBe("passwd");
    expect(fileName("…", () => false)).toBe("file");
    expect(fileName(".hidden", () => false)).toBe("hidden");
  });
  it("never take another file's place", () => {
    const held = new Set(["a.wgsl", "a-2.wgsl"]);
    expect(fileName("a.wgsl", (name) => held.has(name))).toBe("a-3.wgsl");
  });
  it("are found in descriptions", () => {
    expect(filesIn("sum(files/a-2.wgsl:tint=0.1, scaled(0.5, files/paint.binary), files/a-2.wgsl)")).toEqual(["a-2.wgsl", "paint.binary"]);
  });
});

it("reads the colours that it writes", () => {
  for (const rgb of [[0.5, 0.5, 0.5], [1, 0.25, 0]] as [number, number, number][]) expect(parseColour(colourText(rgb))).toEqual(rgb);
  for (const text of ["", "0.1/0.2", "a", "0.1//0.3", "#ff0000"]) expect(parseColour(text)).toBeNull();
});

it("writes colours as short as it can", () => {
  expect(colourText([0.5, 0.5, 0.5])).toBe("0.5");
  expect(colourText([0.1 + 0.2, 0, 1])).toBe("0.3/0/1");
});

describe("short names", () => {
  const aliases = [
    { name: "ggx", model: "torrance-sparrow", sets: [["distribution", "ggx"]] as [string, string][] },
    { name: "beckmann", model: "torrance-sparrow", sets: [["distribution", "beckmann"]] as [string, string][] },
    { name: "cook-torrance", model: "torrance-sparrow", sets: [["distribution", "beckmann"], ["masking", "v-cavity"]] as [string, string][] },
  ];
  it.each([
    ["torrance-sparrow:distribution=ggx,metal=gold", "ggx", "metal=gold"],
    ["torrance-sparrow:masking=v-cavity,distribution=beckmann", "cook-torrance", ""],
    ["torrance-sparrow:distribution=gtr", "torrance-sparrow", "distribution=gtr"],
    ["sum(lambertian:0.2, torrance-sparrow:distribution=ggx,f0=0.04)", "sum", "lambertian, ggx"],
    ["files/mine.wgsl:tint=1/0.5/0.2", "mine.wgsl", "tint=1/0.5/0.2"],
    ["table:file=files/paint.binary,scale=2", "paint.binary", "scale=2"],
    ["mirror", "mirror", ""],
  ])("of %s", (text, name, rest) => {
    expect(shortName(text, aliases)).toEqual([name, rest]);
  });
});
