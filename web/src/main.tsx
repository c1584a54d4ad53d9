import { render } from "preact";
import "./look/fonts.css";
import "./look/tokens.css";
import "./look/base.css";
import "./look/app.css";
import { App } from "./app";
import { start } from "./start";

start();
render(<App />, document.getElementById("app")!);
