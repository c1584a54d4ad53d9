/** The preview's scene and panorama: files of the site that are put into the engine's folder when a picture first needs them. */
import ball from "../../../assets/preview/ball.glb?url";
import scene from "../../../assets/preview/scene.toml?url";
import stand from "../../../assets/preview/stand.glb?url";
import sunset from "../../../assets/preview/sunset.hdr?url";
import { engine } from "./client";

const ADDRESSES: Record<string, string> = { "ball.glb": ball, "stand.glb": stand, "scene.toml": scene, "sunset.hdr": sunset };

/** Puts these into the folder, if they aren't there: `sunset.hdr`, or the scene's `ball.glb`, `stand.glb`, `scene.toml`. Rejects with an `EngineError`. */
export async function loadAssets(names: readonly string[]): Promise<void> {
  await Promise.all(names.map((name) => (ADDRESSES[name] === undefined ? undefined : engine.fetchFile(name, ADDRESSES[name]))));
}

/** What `render` with the object `preview` reads. */
export const SCENE = ["ball.glb", "stand.glb", "scene.toml"] as const;
