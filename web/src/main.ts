// The page: a mesh, what can be done with it, and what is known of it.
import "./style.css";

import type {Colouring, Legend} from "./colours";
import {readMesh, readPage, type Mesh, type Result} from "./data";
import {element, error, facts} from "./facts";
import {Scene, type Style} from "./scene";

interface Option<T extends string> {
  value: T;
  text: string;
}

const STYLES: Option<Style>[] = [{value: "smooth", text: "Smooth"}, {value: "hidden-line", text: "Hidden line"}];
const COLOURINGS: Option<Colouring>[] = [
  {value: "plain", text: "Plain"},
  {value: "aspect", text: "Aspect ratio"},
  {value: "distance", text: "Distance error"},
  {value: "component", text: "Component"},
  {value: "level", text: "Level of the vertex"},
];

function choice<T extends string>(id: string, label: string, options: Option<T>[], changed: () => void): {field: HTMLElement; select: HTMLSelectElement} {
  const select = element("select", {id}, ...options.map(({value, text}) => element("option", {value}, text))) as HTMLSelectElement;
  select.addEventListener("change", changed);
  return {field: element("div", {class: "field"}, element("label", {for: id}, label), select), select};
}

function range(id: string, label: string, attributes: Record<string, string>, changed: (value: number) => void): {field: HTMLElement; input: HTMLInputElement; output: HTMLOutputElement} {
  const input = element("input", {id, type: "range", ...attributes}) as HTMLInputElement;
  const output = element("output", {for: id}) as HTMLOutputElement;
  input.addEventListener("input", () => changed(Number(input.value)));
  return {field: element("div", {class: "field"}, element("label", {for: id}, label), input, output), input, output};
}

class PageView {
  private readonly page = readPage();
  private readonly canvas = element("canvas", {
    id: "view",
    tabindex: "0",
    role: "img",
    "aria-label": "The mesh",
    "aria-describedby": "keys",
  }) as HTMLCanvasElement;
  private readonly scene = new Scene(this.canvas);
  private readonly known = element("div", {class: "facts"});
  private readonly legend = element("div", {class: "legend", "aria-live": "polite"});
  private readonly status = element("p", {class: "status", role: "status"});
  private readonly level = range("level", "Level", {min: "0", step: "1"}, () => this.update());
  private readonly style = choice("style", "Shading", STYLES, () => this.update());
  private readonly colouring = choice("colouring", "Colour", COLOURINGS, () => this.update());
  private readonly clips = ["x", "y", "z"].map((axis, i) =>
    range(`clip-${axis}`, `Cut ${axis}`, {min: "0", max: "1", step: "0.005", value: "1"}, (share) => {
      this.scene.clip(i, share);
      this.clips[i].output.value = share >= 1 ? "off" : `${Math.round(100 * share)} %`;
    }),
  );
  private result!: Result;
  private mesh!: Mesh;

  async start(): Promise<void> {
    const {results} = this.page;
    const which = choice("result", "Result", results.map((r, i) => ({value: `${i}`, text: r.title})), () => void this.open(Number(which.select.value)));
    which.field.hidden = results.length < 2;
    const worst = element("button", {type: "button", id: "worst"}, "Centre the worst triangle");
    worst.addEventListener("click", () => {
      this.status.textContent = `The worst triangle has the aspect ratio ${Number(this.scene.showWorst().toPrecision(3))}.`;
    });
    const reset = element("button", {type: "button", id: "reset"}, "Whole view");
    reset.addEventListener("click", () => this.reset());
    const theme = element("button", {type: "button", id: "theme", "aria-label": "Light or dark"}, "Light / dark");
    theme.addEventListener("click", () => this.setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
    const keys = "Drag to turn, wheel or pinch to zoom, right button or two fingers to move. Keys: arrows turn, Shift and arrows move, + and - zoom, 0 whole view, [ and ] level.";
    document.body.append(
      element("header", {}, element("h1", {id: "title"}), theme),
      element(
        "main",
        {},
        element("section", {class: "stage", "aria-label": "Mesh"}, this.canvas, this.legend),
        element(
          "section",
          {class: "controls", "aria-label": "View"},
          which.field, this.level.field, this.style.field, this.colouring.field,
          element("div", {class: "cuts"}, ...this.clips.map((c) => c.field)),
          element("div", {class: "buttons"}, worst, reset),
          this.status,
          element("p", {id: "keys", class: "keys"}, keys),
        ),
        element("section", {class: "about", "aria-label": "Facts"}, this.known),
      ),
      element("footer", {}, `isoatlas ${this.page.version}`),
    );
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.setTheme(dark.matches ? "dark" : "light"));
    this.setTheme(dark.matches ? "dark" : "light");
    await this.open(0);
  }

  private async open(index: number): Promise<void> {
    this.result = this.page.results[index];
    this.mesh = await readMesh(this.result);
    const last = this.result.levels.length - 1;
    document.title = `${this.result.title} - isoatlas`;
    document.getElementById("title")!.textContent = this.result.title;
    this.level.input.max = `${last}`;
    this.level.input.value = `${last}`;
    const distance = this.colouring.select.querySelector<HTMLOptionElement>("option[value=distance]")!;
    distance.disabled = this.mesh.levels.some((l) => l.distance === null);
    distance.textContent = distance.disabled ? "Distance error (not in the file)" : "Distance error";
    if (distance.disabled && this.colouring.select.value === "distance") this.colouring.select.value = "plain";
    this.scene.show(this.mesh, this.result.unit);
    this.reset();
    this.update();
    document.documentElement.dataset.ready = `${index}`;
  }

  private update(): void {
    const shown = Number(this.level.input.value);
    const facts_of_level = this.result.levels[shown];
    const text = `${shown} of ${this.result.levels.length - 1}: ${facts_of_level.triangles.toLocaleString("en")} triangles, error ${error(facts_of_level, this.result.unit)}`;
    this.level.output.value = text;
    this.level.input.setAttribute("aria-valuetext", text);
    this.canvas.setAttribute("aria-label", `The mesh of ${this.result.title}, level ${text}`);
    this.tell(this.scene.update(shown, this.style.select.value as Style, this.colouring.select.value as Colouring));
    this.known.replaceChildren(...facts(this.result, shown));
    this.status.textContent = "";
  }

  private tell(legend: Legend): void {
    this.legend.replaceChildren();
    if (legend.title) this.legend.append(element("p", {}, legend.title));
    if (legend.scale) {
      const bar = element("span", {class: "bar"});
      bar.style.background = `linear-gradient(to right, ${legend.scale.colours.join(", ")})`;
      this.legend.append(element("p", {class: "scale"}, legend.scale.from, bar, legend.scale.to));
    }
    for (const {colour, name} of legend.classes ?? []) {
      const swatch = element("span", {class: "swatch"});
      swatch.style.background = colour;
      this.legend.append(element("p", {}, swatch, name));
    }
  }

  private reset(): void {
    this.scene.reset();
    for (const clip of this.clips) {
      clip.input.value = "1";
      clip.output.value = "off";
    }
    this.status.textContent = "";
  }

  private setTheme(theme: "light" | "dark"): void {
    document.documentElement.dataset.theme = theme;
    const style = getComputedStyle(document.documentElement);
    this.scene.theme(style.getPropertyValue("--ground").trim(), style.getPropertyValue("--ink").trim());
  }

  private step(levels: number): void {
    this.level.input.value = `${Number(this.level.input.value) + levels}`;
    this.update();
  }

  private key(event: KeyboardEvent): void {
    const actions: Record<string, () => void> = {
      ArrowLeft: () => (event.shiftKey ? this.scene.move(-0.05, 0) : this.scene.turn(0.12, 0)),
      ArrowRight: () => (event.shiftKey ? this.scene.move(0.05, 0) : this.scene.turn(-0.12, 0)),
      ArrowUp: () => (event.shiftKey ? this.scene.move(0, 0.05) : this.scene.turn(0, 0.12)),
      ArrowDown: () => (event.shiftKey ? this.scene.move(0, -0.05) : this.scene.turn(0, -0.12)),
      "+": () => this.scene.zoom(1.2),
      "=": () => this.scene.zoom(1.2),
      "-": () => this.scene.zoom(1 / 1.2),
      "0": () => this.reset(),
      "[": () => this.step(-1),
      "]": () => this.step(1),
    };
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  }
}

new PageView().start().catch((reason: unknown) => {
  document.body.append(element("p", {class: "bad", role: "alert"}, `This page cannot be shown: ${reason instanceof Error ? reason.message : String(reason)}`));
});
