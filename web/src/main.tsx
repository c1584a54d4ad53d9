import { effect } from "@preact/signals";
import { render } from "preact";
import "./look/fonts.css";
import "./look/tokens.css";
import "./look/base.css";
import "./look/controls.css";
import "./look/app.css";
import "./look/panel.css";
import "./look/dialog.css";
import { App } from "./app";
import { loadCatalogue } from "./catalogue";
import { storeForOffline } from "./offline";
import { persist } from "./persist";
import { functions } from "./state";

void persist();
// After the first plots: it takes a tenth of a second, on processors that they need.
const stop = effect(() => {
  if (!functions.value.some((f) => f.description !== null || f.complaint !== null)) return;
  setTimeout(() => void loadCatalogue(), 300);
  queueMicrotask(() => stop());
});
render(<App />, document.getElementById("app")!);
storeForOffline();
