// SPDX-License-Identifier: Apache-2.0
// Starts the page of `isoatlas view`.
import "../style.css";
import "./view.css";

import {element} from "../dom";
import {Server, type Message} from "./server";
import {ViewPage} from "./view_page";

const ICON =
  "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'%3E%3Cpath " +
  "d='M8 1 15 13H1z' fill='%232c5f86'/%3E%3C/svg%3E";

function fail(reason: unknown): void {
  const text = reason instanceof Error ? reason.message : String(reason);
  document.body.append(
    element("p", {class: "missing bad", role: "alert"}, `The volume cannot be shown: ${text}.`),
  );
}

async function start(): Promise<void> {
  // Otherwise the browser requests an icon beyond the address of the page.
  document.head.append(element("link", {rel: "icon", href: ICON}));
  let page: ViewPage | null = null;
  const server = new Server(
    (message: Message) => page?.heard(message),
    (why) => page?.end(why),
  );
  page = new ViewPage(server, await server.volume());
  Object.defineProperty(window, "isoatlas", {value: page.api});
  page.start();
}

start().catch(fail);
