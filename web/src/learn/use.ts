/** What the figures ask of the engine. */
import { useEffect, useId, useRef, useState } from "preact/hooks";
import { engine, EngineError, type Pool } from "../engine/client";
import { loadAssets } from "../engine/assets";
import type { Complaint, Operation, Reply, Requests } from "../engine/protocol";

export interface Asked<K extends Operation> {
  /** What was answered last; while a slider moves it is a little old. */
  reply: Reply<K> | null;
  complaint: Complaint | null;
}

/** The answer to a request that follows the figure's controls; nothing is asked while it is null. */
export function useAnswer<K extends Operation>(operation: K, request: Requests[K]["request"] | null, pool: Pool = "fast"): Asked<K> {
  const key = `learn/${useId()}`;
  const [asked, setAsked] = useState<Asked<K>>({ reply: null, complaint: null });
  const gone = useRef(false);
  useEffect(
    () => () => {
      gone.current = true;
      engine.drop(pool, key);
    },
    [key, pool],
  );
  const text = request === null ? null : JSON.stringify(request);
  useEffect(() => {
    if (text === null) return;
    engine.ask(operation, JSON.parse(text) as Requests[K]["request"], { pool, key }).then(
      (reply) => {
        if (reply !== null && !gone.current) setAsked({ reply, complaint: null });
      },
      (error: unknown) => {
        const complaint = error instanceof EngineError ? error.complaint : { message: String(error), help: null, place: null };
        if (!gone.current) setAsked((before) => ({ reply: before.reply, complaint }));
      },
    );
  }, [operation, text, pool, key]);
  return asked;
}

/** A figure of `learn`: its answer's numbers by name. The library says what is missing, so nothing is guessed here. */
export function useLearn<A>(request: { figure: string; [key: string]: unknown } | null): { answer: A | null; arrays: Record<string, Float32Array>; complaint: Complaint | null } {
  const { reply, complaint } = useAnswer("learn", request);
  return { answer: reply === null ? null : (reply.answer as A), arrays: reply?.arrays ?? {}, complaint };
}

/** Whether these files of the site are in the engine's folder; they are fetched when a figure first needs them. */
export function useAssets(names: readonly string[]): { ready: boolean; complaint: Complaint | null } {
  const [state, setState] = useState<{ ready: boolean; complaint: Complaint | null }>({ ready: false, complaint: null });
  const key = names.join(" ");
  useEffect(() => {
    loadAssets(key.split(" ")).then(
      () => setState({ ready: true, complaint: null }),
      (error: unknown) =>
        setState({ ready: false, complaint: error instanceof EngineError ? error.complaint : { message: String(error), help: null, place: null } }),
    );
  }, [key]);
  return state;
}
