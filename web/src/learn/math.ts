/**
 * Formulas: from a few of TeX's marks to MathML, which browsers set themselves.
 *
 * Known are letters and signs as they are (`ω`, `∫`, `≤`), names of functions, `_` and `^` with one sign or `{…}`, `\frac{…}{…}`, `\sqrt{…}`, and
 * `\text{…}`; two spaces or more are a wide one. Under `∑` the scripts are limits. A `d` is that of a
 * differential, but for scripts.
 */

/** An element of MathML: its name, and what is in it. */
export type Node = [name: string, content: string | Node[], attributes?: Record<string, string>];

const NAMES = ["atan2", "sin", "cos", "tan", "mod", "max", "min"];
const OPERATORS = /^[=+−·/(){}[\]|,;:≤≥<>→∝≈∈…!×]/u;
const LARGE = new Set(["∑", "∫"]);
/** Between factors that would be read as one word. */
const THIN: Node = ["mspace", "", { width: "0.17em" }];

export function formula(source: string): Node {
  const reader = new Reader(source);
  const nodes = reader.many(null);
  return ["math", [["mrow", nodes]], { display: "block" }];
}

/** The name of a function, with what stands above it. */
function isFunction([name, content]: Node): boolean {
  return typeof content === "string" ? name === "mi" && NAMES.includes(content) : name.startsWith("msu") && isFunction(content[0]!);
}

/** What is set apart from a factor before it: a function, a differential. */
const isWord = (node: Node): boolean => isFunction(node) || (node[0] === "mi" && node[1] === "d");

class Reader {
  private at = 0;
  constructor(private readonly source: string) {}

  /** Everything up to `end`, which is read too. */
  many(end: "}" | null): Node[] {
    const nodes: Node[] = [];
    for (;;) {
      const before = this.at;
      this.spaces();
      if (this.at > before + 1) nodes.push(["mspace", "", { width: "1em" }]);
      if (this.at >= this.source.length) {
        if (end !== null) throw new Error(`${this.source}: a brace is open`);
        return nodes;
      }
      if (end !== null && this.source[this.at] === end) {
        this.at += 1;
        return nodes;
      }
      const node = this.scripted();
      const last = nodes.at(-1);
      const apart = isWord(node) || (last !== undefined && isFunction(last) && node[0] !== "mo");
      if (apart && last !== undefined && last[0] !== "mspace" && (last[0] !== "mo" || last[1] === ")")) nodes.push(THIN);
      nodes.push(node);
    }
  }

  private spaces(): void {
    while (this.source[this.at] === " ") this.at += 1;
  }

  /** One thing with what stands below and above it. */
  private scripted(): Node {
    const base = this.one();
    let below: Node | null = null;
    let above: Node | null = null;
    for (;;) {
      const mark = this.source[this.at];
      if (mark !== "_" && mark !== "^") break;
      this.at += 1;
      const script = this.group();
      if (mark === "_") below = script;
      else above = script;
    }
    if (below === null && above === null) return base;
    const limits = base[0] === "mo" && base[1] === "∑";
    if (below !== null && above !== null) return [limits ? "munderover" : "msubsup", [base, below, above]];
    return below !== null ? [limits ? "munder" : "msub", [base, below]] : [limits ? "mover" : "msup", [base, above!]];
  }

  private group(): Node {
    // A `d` below something is a name.
    if (this.source[this.at] === "d") return this.take("mi", "d");
    if (this.source[this.at] !== "{") return this.one();
    this.at += 1;
    const nodes = this.many("}");
    return nodes.length === 1 ? nodes[0]! : ["mrow", nodes];
  }

  private one(): Node {
    const rest = this.source.slice(this.at);
    if (rest.startsWith("{")) return this.group();
    for (const [command, name] of [
      ["\\frac", "mfrac"],
      ["\\sqrt", "msqrt"],
    ] as const) {
      if (!rest.startsWith(command)) continue;
      this.at += command.length;
      return [name, name === "mfrac" ? [this.group(), this.group()] : [this.group()]];
    }
    if (rest.startsWith("\\text{")) {
      const end = rest.indexOf("}");
      this.at += end + 1;
      // Spaces at the ends of an element are dropped, no-break spaces are not.
      return ["mtext", rest.slice("\\text{".length, end).replaceAll(" ", "\u00a0")];
    }
    const number = /^\d+(\.\d+)?/.exec(rest);
    if (number !== null) return this.take("mn", number[0]);
    const name = NAMES.find((n) => rest.startsWith(n));
    if (name === "mod") return this.take("mo", name, { lspace: "0.3em", rspace: "0.3em" });
    if (name !== undefined) return this.take("mi", name);
    const sign = [...rest][0]!;
    if (LARGE.has(sign)) return this.take("mo", sign, { largeop: "true", movablelimits: "false" });
    // `\{` and `\}` are the signs, not a group.
    if (sign === "\\") {
      this.at += 1;
      return this.take("mo", [...rest][1]!);
    }
    if (sign === "d") return this.take("mi", sign, { mathvariant: "normal" });
    return OPERATORS.test(sign) ? this.take("mo", sign) : this.take("mi", sign);
  }

  private take(name: string, text: string, attributes?: Record<string, string>): Node {
    this.at += text.length;
    return attributes === undefined ? [name, text] : [name, text, attributes];
  }
}
