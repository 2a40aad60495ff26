// SPDX-License-Identifier: Apache-2.0
// Starts the page of `isoatlas view`.
import "../style.css";

import {element} from "../dom";

interface Volume {
  title: string;
  size: [number, number, number];
}

async function start(): Promise<void> {
  const reply = await fetch("volume");
  const volume = (await reply.json()) as Volume;
  new EventSource("events");
  document.title = `${volume.title} – isoatlas`;
  document.body.append(
    element("main", {}, element("h1", {}, volume.title), volume.size.join(" × ")),
  );
}

void start();
