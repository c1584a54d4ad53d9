/**
 * The service worker: once loaded, the page works without its server.
 *
 * All files of one version of the site are stored together, each by its content. While the server answers, it has the word: what could have changed is asked
 * for anew, so a new version is there at once, and what is stored never mixes with it. Files whose names hold a hash of their content come from the store. A new version is
 * stored beside the old one, and takes its place when no page of the old one is open any more.
 */
export {};

declare const self: ServiceWorkerGlobalScope;

/** The site's files and hashes of what they hold; put in when the site is built. */
declare const SITE_FILES: Record<string, string>;

const FILES = SITE_FILES;

const STORE = "gonio-explorer";

/** Where a file is stored: by name and content, so that versions share what they have in common. */
const place = (name: string): string => new URL(`${name}?${FILES[name]}`, self.registration.scope).href;

/** The file that an address means; undefined for what is not the site's. */
function named(address: string): string | undefined {
  const { origin, pathname } = new URL(address);
  const scope = new URL(self.registration.scope);
  if (origin !== scope.origin || !pathname.startsWith(scope.pathname)) return undefined;
  const name = pathname.slice(scope.pathname.length) || "index.html";
  return Object.hasOwn(FILES, name) ? name : undefined;
}

async function store(): Promise<void> {
  const cache = await caches.open(STORE);
  const stored = new Set((await cache.keys()).map((request) => request.url));
  const missing = Object.keys(FILES).filter((name) => !stored.has(place(name)));
  await Promise.all(
    missing.map(async (name) => {
      const response = await fetch(new URL(name, self.registration.scope), { cache: "no-cache" });
      // Half a site is worse than none: the old version stays.
      if (!response.ok) throw new Error(`${name}: ${response.status}`);
      await cache.put(place(name), response);
    }),
  );
}

async function tidy(): Promise<void> {
  const cache = await caches.open(STORE);
  const kept = new Set(Object.keys(FILES).map(place));
  for (const request of await cache.keys()) if (!kept.has(request.url)) await cache.delete(request);
}

async function stored(name: string): Promise<Response | undefined> {
  return (await caches.open(STORE)).match(place(name));
}

async function answer(request: Request, name: string): Promise<Response> {
  if (name.startsWith("assets/")) return (await stored(name)) ?? fetch(request);
  try {
    const response = await fetch(request);
    if (response.ok || response.type === "opaqueredirect" || response.status === 304) return response;
    return (await stored(name)) ?? response;
  } catch (error) {
    const kept = await stored(name);
    if (kept === undefined) throw error;
    return kept;
  }
}

self.addEventListener("install", (event) => event.waitUntil(store()));
self.addEventListener("activate", (event) => event.waitUntil(tidy().then(() => self.clients.claim())));
self.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET") return;
  const name = named(event.request.url);
  if (name !== undefined) event.respondWith(answer(event.request, name));
});
