/** The page works without its server once it has been loaded: see `offline/worker.ts`. */

/** When the page has drawn something: what is stored must not stand in the way of the first picture. */
const LATER = 3000;

export function storeForOffline(): void {
  if (!import.meta.env.PROD || !("serviceWorker" in navigator)) return;
  setTimeout(() => {
    // Private windows and unusual settings refuse it; the page then needs its server, and nothing else changes.
    navigator.serviceWorker.register(new URL("sw.js", document.baseURI)).catch(() => undefined);
  }, LATER);
}
