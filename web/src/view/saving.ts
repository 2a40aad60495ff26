// SPDX-License-Identifier: Apache-2.0
// Saves the mesh with all options, and shows the command line that does the same.
import {button} from "../controls";
import {copyButton} from "../copying";
import {element, number} from "../dom";
import {sentence} from "./mesh_view";
import {
  nextRequest,
  Refused,
  type Message,
  type Option,
  type SavedMessage,
  type Server,
} from "./server";
import {progressText} from "./stages";

const COMMAND_AFTER = 120;  // ms without another change

/** What formats are for. */
const FORMATS: Record<string, string> = {
  ply: ".ply – most programs",
  stl: ".stl – printing",
  "3mf": ".3mf – printing, with units",
  glb: ".glb – the web, all levels",
  obj: ".obj",
  off: ".off",
  vtp: ".vtp – ParaView, 3D Slicer",
  gii: ".gii – neuroimaging",
};

export class Saving {
  readonly fields: HTMLElement[];
  /** The command line, in a section of its own. */
  readonly commandLine: HTMLElement[];
  private readonly format: HTMLSelectElement;
  private readonly save = button("save", "Save the mesh", () => void this.start(), {
    class: "primary",
    "aria-describedby": "save-problem",
  });
  private readonly bar = element("progress", {
    id: "save-progress",
    max: "1",
    "aria-label": "Progress of saving",
  });
  private readonly stop = button("cancel-save", "Cancel", () => this.cancel());
  private readonly running = element("div", {class: "running"}, this.bar, this.stop);
  private readonly status = element("p", {id: "save-status", role: "status"});
  private readonly summary = element("pre", {
    id: "save-summary",
    tabindex: "0",
    "aria-label": "Summary",
  });
  private readonly command = element("code");
  private readonly problem = element("p", {class: "bad problem", id: "command-problem"});
  private readonly invalid = element("p", {class: "bad problem", id: "save-problem"});
  private readonly copy = copyButton(this.command, "copy-command");
  private request: number | null = null;
  private started: Promise<unknown> = Promise.resolve();
  private pending = 0;
  private latest = 0;
  private isCurrent = false;  // whether the command line is that of the options
  private isStopped = false;

  /** @param toCorrect what has invalid fields, for the user; "": all fields can be used */
  constructor(
    private readonly server: Server,
    formats: string[],
    private readonly options: () => Option[],
    private readonly toCorrect: () => string,
  ) {
    this.format = element(
      "select",
      {id: "format", "aria-label": "Format"},
      ...formats.map((value) => element("option", {value}, FORMATS[value] ?? `.${value}`)),
    );
    this.format.addEventListener("change", () => this.updateCommand());
    this.running.hidden = true;
    this.summary.hidden = true;
    this.fields = [
      element("div", {class: "buttons"}, this.format, this.save),
      this.invalid,
      this.running,
      this.status,
      this.summary,
    ];
    this.commandLine = [
      element("pre", {tabindex: "0", "aria-label": "Command", id: "command"}, this.command),
      this.problem,
      this.copy,
    ];
  }

  /** Shows the command line of the options, after a moment without another change. */
  updateCommand(): void {
    clearTimeout(this.pending);
    ++this.latest;  // an answer that is still to arrive is of other options
    this.isCurrent = false;
    this.copy.textContent = "Copy";
    const invalid = this.toCorrect();
    this.invalid.textContent = invalid && `To save, correct ${invalid}.`;
    this.setCommandProblem(invalid && `This is not the current command. Correct ${invalid}.`);
    if (!invalid)
      this.pending = window.setTimeout(() => void this.fetchCommand(), COMMAND_AFTER);
    this.show();
  }

  /** @param text why the command line is not that of the options; "": it is, or is requested */
  private setCommandProblem(text: string): void {
    this.problem.textContent = text;
    this.command.classList.toggle("soft", text !== "");
    this.copy.disabled = text !== "";
  }

  private async fetchCommand(): Promise<void> {
    if (this.isStopped) return;
    const number = this.latest;
    try {
      const {command} = await this.server.post<{command: string}>("command", {
        options: this.options(),
        format: this.format.value,
      });
      if (number !== this.latest) return;
      this.command.textContent = command;
      this.isCurrent = true;
      this.setCommandProblem("");
    } catch (reason) {
      if (number === this.latest) this.setCommandProblem(sentence(wordsOf(reason)));
    }
  }

  private async start(): Promise<void> {
    if (this.toCorrect() || this.request !== null) return;
    const options = this.options();
    const request = nextRequest();
    this.request = request;
    this.summary.hidden = true;
    this.setStatus("Saving …");
    this.bar.removeAttribute("value");
    this.show();
    this.started = this.server.post("save", {request, options, format: this.format.value});
    try {
      await this.started;
    } catch (reason) {
      this.end(request, sentence(wordsOf(reason)), true);
    }
  }

  private cancel(): void {
    const {request} = this;
    if (request === null) return;
    // Afterwards, because requests on several connections can overtake each other.
    this.started
      .then(() => this.server.post("cancel", {request}))
      .catch((reason) => this.end(request, sentence(wordsOf(reason)), true));
  }

  heard(message: Message): void {
    if (!("request" in message) || message.request !== this.request) return;
    switch (message.type) {
      case "progress":
        if (message.fraction === null) this.bar.removeAttribute("value");
        else this.bar.value = message.fraction;
        this.setStatus(progressText("Saving", message.stage));
        break;
      case "saved":
        this.saved(message);
        break;
      case "failed":
        this.end(message.request, sentence(message.message), true);
        break;
      case "cancelled":
        this.end(message.request, "Cancelled. Nothing was saved.");
        break;
    }
  }

  private saved({request, id, name, bytes, satisfied, summary}: SavedMessage): void {
    const text = `Saved ${name}, ${bytesText(bytes)}`;
    if (satisfied) this.end(request, `${text}.`);
    else this.end(request, `${text}, but not all bounds are satisfied: see below.`, true);
    this.summary.replaceChildren(
      ...summary.split(/(?<=\n)/).map((line) => element("span", {class: "line"}, line)),
    );
    this.summary.hidden = summary === "";
    download(`files/${id}`, name);
  }

  /** For ever. @param why in sentences, such as that the server has ended */
  stopAll(why: string): void {
    this.isStopped = true;
    if (this.request !== null) this.end(this.request, why, true);
    this.show();
  }

  get isRunning(): boolean {
    return this.request !== null;
  }

  /** null while it is requested. */
  get commandText(): string | null {
    return this.isCurrent ? (this.command.textContent ?? "") : null;
  }

  private end(request: number, text: string, bad = false): void {
    if (this.request !== request) return;
    this.request = null;
    this.setStatus(text, bad);
    this.show();
  }

  private setStatus(text: string, bad = false): void {
    if (this.status.textContent !== text) this.status.textContent = text;
    this.status.classList.toggle("bad", bad);
  }

  private show(): void {
    const isRunning = this.request !== null;
    const focused = document.activeElement;
    this.running.hidden = !isRunning;
    this.save.disabled = isRunning || this.isStopped || this.toCorrect() !== "";
    this.format.disabled = isRunning || this.isStopped;
    // A button that disappears or is disabled passes the focus on.
    if (focused === this.save && isRunning) this.stop.focus();
    if (focused === this.stop && !isRunning)
      [this.save, this.format, this.commandLine[0]].find((part) => !part.matches(":disabled"))!
        .focus();
  }
}

const wordsOf = (reason: unknown): string =>
  reason instanceof Refused ? reason.message : String(reason);

const bytesText = (bytes: number): string =>
  bytes < 1e4
    ? `${bytes} bytes`
    : bytes < 1e6
      ? `${number(bytes / 1e3)} kB`
      : `${number(bytes / 1e6)} MB`;

function download(address: string, name: string): void {
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
}
