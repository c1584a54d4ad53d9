/** The page Learn: every row of the theory with its formula and a figure that is alive. */
import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { route } from "../route";
import { Formula } from "./formula";
import { ROWS, type Row } from "./rows";
import "./learn.css";

export function Learn(): JSX.Element {
  const { section } = route.value;
  useEffect(() => {
    if (section === null) return;
    const heading = document.getElementById(`learn-${section}`);
    if (heading === null) return;
    heading.focus({ preventScroll: true });
    return stay(heading);
  }, [section]);
  return (
    <div class="learn">
      <nav class="learn-contents" aria-label="Sections">
        <ol>
          {ROWS.map(({ key, name }) => (
            <li key={key}>
              <a href={`#learn/${key}`} aria-current={section === key ? "true" : undefined}>
                <span class="learn-key">{key}</span>
                {name}
              </a>
            </li>
          ))}
        </ol>
      </nav>
      <main class="learn-main" id="views" tabIndex={-1}>
        <header class="learn-head">
          <h1>How light is reflected</h1>
          <p>
            From solid angles to environment maps: each section has its formula and a figure that follows its sliders. The numbers are computed by the library as they are shown. Directions point away
            from the surface: ω<sub>i</sub> to the light, ω<sub>r</sub> to the viewer; θ is measured from the normal.
          </p>
        </header>
        {ROWS.map((row) => (
          <Section key={row.key} row={row} />
        ))}
      </main>
    </div>
  );
}

/** Goes to the heading, and stays there while figures above it appear, until the person moves on. */
function stay(heading: HTMLElement): () => void {
  const go = (): void => heading.scrollIntoView();
  const sizes = new ResizeObserver(go);
  for (const section of document.querySelectorAll(".learn-section")) sizes.observe(section);
  const moves = ["wheel", "touchstart", "pointerdown", "keydown"];
  const end = (): void => {
    sizes.disconnect();
    clearTimeout(timer);
    for (const move of moves) removeEventListener(move, end);
  };
  const timer = setTimeout(end, 2000);
  for (const move of moves) addEventListener(move, end, { passive: true });
  go();
  return end;
}

function Section({ row: { key, name, chapter, formulas, text, Live } }: { row: Row }): JSX.Element {
  const element = useRef<HTMLElement>(null);
  const [near, setNear] = useState(false);
  // Twenty figures at once would keep the engine from the one that is looked at.
  useEffect(() => {
    const observer = new IntersectionObserver(
      (entries) => {
        if (!entries.some((entry) => entry.isIntersecting)) return;
        setNear(true);
        observer.disconnect();
      },
      { rootMargin: "300px" },
    );
    observer.observe(element.current!);
    return () => observer.disconnect();
  }, []);
  return (
    <section ref={element} class="learn-section" aria-labelledby={`learn-${key}`}>
      <div class="learn-words">
        <h2 id={`learn-${key}`} tabIndex={-1}>
          <span class="learn-key">{key}</span> {name}
        </h2>
        {formulas.map((f) => (
          <Formula key={f.text} number={f.number}>
            {f.text}
          </Formula>
        ))}
        <p>{text}</p>
        <p class="learn-book">
          In the book: Theory, <cite>{`${key} ${name}`}</cite> (<code>theory/{chapter}.md</code>), with where it is in the code and how it is tested.
        </p>
      </div>
      <div class="learn-live">{near ? <Live /> : null}</div>
    </section>
  );
}
