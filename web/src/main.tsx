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
import { persist } from "./persist";

void persist();
void loadCatalogue();
render(<App />, document.getElementById("app")!);
