// SPDX-License-Identifier: Apache-2.0
// Requests meshes while options change: one at a time, and the last options are always made.
import {
  nextRequest,
  Refused,
  type MadeMesh,
  type Message,
  type Option,
  type Server,
} from "./server";

interface Running {
  request: number;
  key: string;
  options: Option[];
  posted: number;
  /** Whether a first mesh has been shown. */
  hasFirst: boolean;
}

/** A mesh that is shown. */
export interface Shown {
  request: number;
  options: Option[];
  final: boolean;
  made: MadeMesh;
}

/** Times from the request to the picture, in ms. */
export interface Timing {
  request: number;
  first: number;
  final: number | null;
}

const MOST_TIMINGS = 300;

export class MeshFollower {
  private running: Running | null = null;
  private waiting: Option[] | null = null;
  private shown: Shown | null = null;
  private isStopped = false;
  private sent: Promise<void> = Promise.resolve();
  stage = "";
  fraction: number | null = null;
  /** Why there is no mesh at the last options; "" if there is one or it is being made. */
  problem = "";
  wasCancelled = false;
  readonly timings: Timing[] = [];

  /**
   * @param show shows a mesh
   * @param changed called when anything else has changed, such as the progress
   */
  constructor(
    private readonly server: Server,
    private readonly show: (shown: Shown) => void,
    private readonly changed: () => void,
  ) {}

  get isRunning(): boolean {
    return this.running !== null;
  }

  /** The number of the request that is running. */
  get runningRequest(): number | null {
    return this.running?.request ?? null;
  }

  /** The shown mesh; null: none yet. */
  get current(): Shown | null {
    return this.shown;
  }

  /** Whether the shown mesh is the final one of the last options. */
  get isUpToDate(): boolean {
    return !this.running && !this.waiting && !this.problem && !this.wasCancelled &&
      this.shown?.final === true;
  }

  /**
   * Makes the mesh of these options.
   * @param settled whether it replaces the mesh that is being made; if not, it waits until the
   *        first mesh of that is shown, so that the picture follows a handle that keeps moving
   */
  follow(options: Option[], settled: boolean): void {
    if (this.isStopped) return;
    const key = JSON.stringify(options);
    if (this.running?.key === key) {
      this.waiting = null;
      return;
    }
    if (this.isUpToDate && JSON.stringify(this.shown!.options) === key) return;
    if (this.running && !settled && !this.running.hasFirst) {
      this.waiting = options;
      return;
    }
    this.start(options);
  }

  /** Makes the mesh of these options, also if it is being made or was cancelled. */
  restart(options: Option[]): void {
    if (!this.isStopped && !this.isUpToDate) this.start(options);
  }

  cancel(): void {
    if (!this.running) return;
    const {request} = this.running;
    this.waiting = null;
    this.send(request, "cancel", {request});
  }

  /**
   * Sends after all earlier requests are answered: on several connections they can overtake each
   * other, and the server makes the one that arrives last. Leaves out what has been replaced.
   */
  private send(request: number, name: string, body: object): void {
    this.sent = this.sent.then(async () => {
      if (this.running?.request !== request) return;
      try {
        await this.server.post(name, body);
      } catch (reason) {
        this.fail(request, reason);
      }
    });
  }

  /** For ever, because no messages arrive any more. */
  stop(): void {
    this.isStopped = true;
    this.running = null;
    this.waiting = null;
    this.changed();
  }

  heard(message: Message): void {
    const {running} = this;
    if (!running || !("request" in message) || message.request !== running.request) return;
    switch (message.type) {
      case "progress":
        this.stage = message.stage;
        this.fraction = message.fraction;
        break;
      case "mesh":
        void this.fetch(running, message.id, message.final);
        return;
      case "failed":
        this.problem = message.message;
        this.finish();
        break;
      case "cancelled":
        this.wasCancelled = true;
        this.finish();
        break;
    }
    this.changed();
  }

  private start(options: Option[]): void {
    const request = nextRequest();
    const key = JSON.stringify(options);
    this.waiting = null;
    this.running = {request, key, options, posted: performance.now(), hasFirst: false};
    this.stage = "";
    this.fraction = null;
    this.problem = "";
    this.wasCancelled = false;
    this.changed();
    this.send(request, "mesh", {request, options});
  }

  private fail(request: number, reason: unknown): void {
    if (this.running?.request !== request) return;
    this.problem = reason instanceof Refused ? reason.message : String(reason);
    this.finish();
    this.changed();
  }

  private async fetch(running: Running, id: number, final: boolean): Promise<void> {
    let made: MadeMesh;
    try {
      made = await this.server.mesh(id);
    } catch (reason) {
      // The server keeps the last few meshes. This one has been replaced.
      if (this.running === running && final) this.fail(running.request, reason);
      return;
    }
    const {request, options} = running;
    const before = this.shown;
    const isOld =
      before !== null &&
      (before.request > request || (before.request === request && before.final));
    if (isOld) return;
    this.shown = {request, options, final, made};
    this.show(this.shown);
    this.time(running, final);
    if (this.running !== running) return;
    running.hasFirst = true;
    if (final) this.finish();
    else if (this.waiting) this.start(this.waiting);
    this.changed();
  }

  private time({request, posted}: Running, final: boolean): void {
    const now = performance.now() - posted;
    const last = this.timings[this.timings.length - 1];
    if (last?.request === request) last.final = final ? now : null;
    else this.timings.push({request, first: now, final: final ? now : null});
    if (this.timings.length > MOST_TIMINGS) this.timings.splice(0, 1);
  }

  private finish(): void {
    this.running = null;
    if (this.waiting) this.start(this.waiting);
  }
}
