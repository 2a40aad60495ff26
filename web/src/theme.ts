// SPDX-License-Identifier: Apache-2.0
// Light and dark: follows the system until the user presses the button.
import {button} from "./controls";
import {halfMoon} from "./icons";

/** Colours of the scene, with their names in the style sheet. */
const SCENE = {
  clay: "--clay",
  inside: "--inside",
  paper: "--paper",
  paperInside: "--paper-inside",
  ink: "--edge",
  section: "--section",
  cap: "--cap",
};

export class Theme {
  readonly button = button("theme", halfMoon(), () => this.set(!this.dark), {
    class: "bare-icon",
    "aria-pressed": "false",
    "aria-label": "Dark theme",
    title: "Light or dark",
  });

  /** @param changed gets the colours of the scene */
  constructor(private readonly changed: (colours: Record<string, string>) => void) {}

  start(): void {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.set(dark.matches));
    this.set(dark.matches);
  }

  get dark(): boolean {
    return document.documentElement.dataset.theme === "dark";
  }

  private set(dark: boolean): void {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    this.button.setAttribute("aria-pressed", `${dark}`);
    const style = getComputedStyle(document.documentElement);
    const colours = Object.entries(SCENE).map(([name, property]) => [
      name,
      style.getPropertyValue(property).trim(),
    ]);
    this.changed(Object.fromEntries(colours) as Record<string, string>);
  }
}
