/** What the explorer is, and how it is used. */
import { signal } from "@preact/signals";
import type { JSX } from "preact";
import { catalogue } from "../catalogue";
import { Section } from "./description";
import { Dialog } from "./ui";

export const helping = signal(false);

export function Help(): JSX.Element | null {
  if (!helping.value) return null;
  return (
    <Dialog title="What this is" onClose={() => (helping.value = false)} wide>
      <p>
        Reflection functions (BRDFs), seen from every side at once. A function says how much of the light that comes from one direction leaves towards another. Everything here is computed by
        the library that the command <code>gonio</code> is made of, in this browser: nothing leaves your machine.
      </p>
      <Section title="Look">
        <ul class="help-list">
          <li>
            <strong>One light for all.</strong> Drag the light’s direction in any view, or type θi and φi; every view follows.
          </li>
          <li>
            <strong>One direction to look at.</strong> Click in a view, and f is read there in all of them.
          </li>
          <li>
            <strong>Several functions.</strong> Up to eight, each with its colour in every view. The coloured square hides and shows one.
          </li>
          <li>
            <strong>Your own.</strong> Drop measured files (MERL, RGL, UTIA, ASTM, Radiance XML, pbrt), shaders (.wgsl, .glsl, .frag, .brdf) or panoramas (.hdr, .exr) anywhere.
          </li>
          <li>
            <strong>Verdicts.</strong> Whether a function is physical; a failed property names its witness, and a click takes every view there.
          </li>
          <li>
            <strong>The address is the state.</strong> Copy it, and another person sees what you see.
          </li>
        </ul>
      </Section>
      <Section title="Keyboard">
        <dl class="facts keys">
          <dt>Tab, Shift Tab</dt>
          <dd>from control to control; every view’s light and viewer are controls</dd>
          <dt>Arrows</dt>
          <dd>move a slider, or the direction or the cell of a slice that has the focus; with Shift in larger steps</dd>
          <dt>Home, End</dt>
          <dd>to the normal and the horizon; in a slice to the ends of the row</dd>
          <dt>+, −</dt>
          <dd>scale the lobe, as pinching does</dd>
          <dt>Enter, Space</dt>
          <dd>press a button, choose what is marked in a list</dd>
          <dt>Escape</dt>
          <dd>closes a dialog, or the view that is large</dd>
          <dt>Escape, then Tab</dt>
          <dd>leaves the shader editor, where Tab indents</dd>
        </dl>
      </Section>
      <Section title="Conventions">
        <p>
          ωi points to the light and ωr, or ωo, to the viewer; both leave the surface. θ is measured from its normal, φ around it. f is in sr⁻¹ and has no cosine unless “× cos θ” is on. Colours
          are linear Rec.709.
        </p>
      </Section>
      <p class="quiet">
        Gonio {catalogue.value?.version ?? ""}, MIT or Apache-2.0. The typeface is Inter (SIL Open Font License 1.1). Licences of the libraries are in <a href="./licenses.txt">licenses.txt</a>.
      </p>
    </Dialog>
  );
}
