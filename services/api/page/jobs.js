// Jobs with live progress; failures with their errors; the workers.

import { follow, get, lines, list, pause, post, read } from "./api.js";
import { h, heading, problemBox, put, same, table } from "./dom.js";
import { print } from "./exact.js";
import { noWorker } from "./live.js";
import { picture } from "./picture.js";
import { bytes, count, duration, number, path, queryOf, when } from "./text.js";

// A browser has six connections to a service; images and queries need some of them.
const STREAMS = 3;
const OPEN = ["queued", "running", "paused"];
// Thumbnails of a job, and the least time between two queries for them.
const TILES = 12;
const TILES_MS = 1500;

export async function show(root, route) {
  return route.args[0] ? one(root, route, route.args[0]) : all(root, route);
}

async function all(root, route) {
  const place = h("div.above");
  const workers = h("section.panel");
  root.append(heading("Jobs"), place, workers, same("GET /v1/jobs", "GET /v1/workers", "fathom jobs"));
  const jobs = await list("/v1/jobs", route.signal);
  const watched = [];
  const row = (job) => {
    const bar = new Bar(job);
    if (OPEN.includes(job.state)) watched.push({ job, bar });
    return [h("a", { href: `#/jobs/${path(job.id)}` }, job.dataset), bar.element, bar.words, bytes(job.bytes), when(job.created_at)];
  };
  put(place, jobs.length === 0 ? h("p", {}, "There are no jobs. ", h("a", { href: "#/compose" }, "Compose one."))
    : table(["dataset", "progress", "state", "bytes", "submitted"], jobs.map(row), { label: "Jobs" }));
  watched.slice(0, STREAMS).forEach(({ job, bar }) => follow(`/v1/jobs/${path(job.id)}/events`, route.signal,
    (kind, data) => bar.tell(kind, data)).catch(() => {}));
  ask(watched.slice(STREAMS), route).catch(() => {});
  await showWorkers(workers, route);
}

// Jobs without a stream are polled.
async function ask(watched, route) {
  while (watched.length > 0) {
    await pause(3000, route.signal);
    for (const { job, bar } of watched) bar.tell("state", await get(`/v1/jobs/${path(job.id)}`, {}, route.signal));
    watched = watched.filter(({ bar }) => OPEN.includes(bar.job.state));
  }
}

async function showWorkers(place, route) {
  const { items } = await get("/v1/workers", {}, route.signal);
  put(place, h("h2", {}, count(items.length, "worker")), items.length === 0 ? noWorker()
    : table(["worker", "slots", "frames in progress", "last heard", "version"], items.map((one) => [one.name, number(one.slots),
      number(one.leased_frames), `${duration(one.silent_ms / 1000)} ago`, one.code_version]), { label: "Workers" }));
}

// The progress of a job, with rate and remaining time from recent events.
class Bar {
  constructor(job) {
    this.job = job;
    this.told = [];
    this.meter = h("progress", { max: Math.max(1, job.frames), "aria-label": `Progress of ${job.dataset}` });
    this.words = h("span");
    this.element = h("span.progress", {}, this.meter, this.numbers = h("span"));
    this.draw();
  }

  tell(kind, data) {
    if (kind === "progress" || kind === "state") Object.assign(this.job, data);
    if (kind === "progress") this.told = [...this.told, { at: performance.now(), done: data.done + data.failed }].slice(-12);
    this.draw();
  }

  rate() {
    const [first, last] = [this.told[0], this.told.at(-1)];
    if (first && last.at - first.at > 400) return (1000 * (last.done - first.done)) / (last.at - first.at);
    if (this.job.started_at && this.job.finished_at) {
      const seconds = (Date.parse(this.job.finished_at) - Date.parse(this.job.started_at)) / 1000;
      return seconds > 0 ? this.job.done / seconds : 0;
    }
    return 0;
  }

  draw() {
    const { done, failed, frames, state, unproven } = this.job;
    this.meter.value = done + failed;
    put(this.numbers, `${number(done)} of ${number(frames)}`, failed > 0 && h("span.bad", {}, `, ${number(failed)} failed`),
      unproven > 0 && h("span.bad", {}, `, ${number(unproven)} unproven`));
    const rate = this.rate();
    const rest = state === "running" && rate > 0 ? `, ${duration((frames - done - failed) / rate)} left` : "";
    put(this.words, state.replaceAll("_", " "), rate > 0 && ` · ${number(rate, 3)} frames/s${rest}`);
  }
}

async function one(root, route, id) {
  const job = await get(`/v1/jobs/${path(id)}`, {}, route.signal);
  await new JobView(root, route, id, job).start();
}

// One job: progress and controls, first images, description, warnings and failures.
class JobView {
  constructor(root, route, id, job) {
    this.route = route;
    this.id = id;
    this.base = `/v1/jobs/${path(id)}`;
    this.bar = new Bar(job);
    this.controls = h("div.row.above");
    this.wrong = h("div", { "aria-live": "polite" });
    this.workers = h("div");
    this.machines = h("div", { "aria-live": "polite" });
    this.facts = h("section.panel");
    this.tiles = h("div.tiles");
    this.images = h("section.panel", { hidden: true }, h("h2", {}, "First images"), this.tiles);
    this.description = h("details.panel", { open: true }, h("summary", {}, "Description"));
    this.failures = h("section.panel", { hidden: true });
    this.warnings = h("section.panel", { hidden: true });
    this.shownFailed = -1;
    this.shownTiles = 0;
    this.isWatched = false;
    root.append(heading(`Job of ${job.dataset}`, h("a", { href: `#/dataset/${path(job.dataset)}` }, "To its dataset")), h("div.note.big", {}, this.bar.element, this.bar.words),
      this.controls, this.wrong, this.machines, this.workers, this.images, this.warnings, this.failures, this.facts, this.description,
      same(`GET ${this.base}`, `GET ${this.base}/description`, `GET ${this.base}/events`, `POST ${this.base}/pause`, `POST ${this.base}/retry-failed`, `POST ${this.base}/finish-elsewhere`, `POST ${this.base}/start-again`, `fathom wait ${id}`,
        `fathom pause ${id}`, `fathom errors ${id}`, `fathom retry ${id}`));
  }

  async start() {
    this.draw();
    if (OPEN.includes(this.bar.job.state)) this.watch();
    this.watchMachines().catch(() => {});
    await Promise.all([this.showDescription(), this.showTiles()]);
  }

  draw() {
    const { job } = this.bar;
    const isOpen = OPEN.includes(job.state);
    const compose = this.composed && h("a", { href: `#/compose?job=${encodeURIComponent(print(this.composed))}` }, "Compose from this");
    put(this.controls, this.button("pause", "Pause", isOpen && job.state !== "paused"), this.button("resume", "Resume", job.state === "paused"),
      this.button("cancel", "Cancel", isOpen), this.button("retry-failed", "Retry failed frames", job.failed > 0 && !isOpen),
      this.button("finish-elsewhere", "Finish on other machines", isOpen && !job.mixed && job.warnings?.length > 0),
      this.button("start-again", "Start again", (isOpen && job.warnings?.length > 0) || job.unproven > 0), compose);
    put(this.machines, (job.warnings ?? []).map((warning) => h("p.note.bad", {}, warning)));
    put(this.facts, h("h2", {}, "Job"), table(["", ""], [["id", h("code", {}, this.id)], ["submitted", when(job.created_at)], ["started", when(job.started_at)],
      ["finished", when(job.finished_at)], ["bytes", bytes(job.bytes)],
      ["price", job.price ? `${duration(job.price.slot_seconds)} of slots, ${bytes(job.price.bytes)}` : "–"], ["digest", h("code", {}, job.digest ?? "–")]], { label: "Job" }));
    showWarnings(this.warnings, this.base, this.route).catch(() => {});
    if (job.failed !== this.shownFailed) {
      this.shownFailed = job.failed;
      showFailures(this.failures, this.base, this.route).catch(() => {});
    }
    if (isOpen) this.showNoWorker().catch(() => {});
    else put(this.workers);
  }

  button(name, text, isThere) {
    return isThere && h("button", { type: "button", onclick: () => this.act(name) }, text);
  }

  async act(name) {
    try {
      const now = await read(await post(`${this.base}/${name}`, undefined, { signal: this.route.signal }));
      this.bar.tell("state", { warnings: [], ...now.job ?? now });
      put(this.wrong);
      this.watch();
    } catch (error) {
      if (!this.route.signal.aborted) put(this.wrong, problemBox(error));
    }
    this.draw();
  }

  async watch() {
    if (this.isWatched) return;
    this.isWatched = true;
    await follow(`${this.base}/events`, this.route.signal, (kind, data) => {
      const before = this.bar.job.state;
      this.bar.tell(kind, data);
      if (before !== this.bar.job.state || this.bar.job.failed !== this.shownFailed) this.draw();
      this.showTiles().catch(() => {});
    }).catch(() => {});
    this.isWatched = false;
    await pause(300, this.route.signal).catch(() => {});
    if (this.route.signal.aborted) return;
    this.draw();
    await this.showTiles(true).catch(() => {});
  }

  // Events have no warnings about workers of another kind.
  async watchMachines() {
    while (OPEN.includes(this.bar.job.state)) {
      await pause(2000, this.route.signal);
      const { warnings = [] } = await get(this.base, {}, this.route.signal);
      const isChanged = warnings.join() !== (this.bar.job.warnings ?? []).join();
      this.bar.job.warnings = warnings;
      if (isChanged) this.draw();
    }
  }

  async showNoWorker() {
    const { items } = await get("/v1/workers", {}, this.route.signal);
    put(this.workers, items.length === 0 && noWorker());
  }

  // Queries the first images until all tiles are shown.
  async showTiles(isLast = false) {
    const now = performance.now();
    if (this.shownTiles >= Math.min(TILES, this.bar.job.frames) || (!isLast && now - (this.tilesAt ?? -Infinity) < TILES_MS)) return;
    this.tilesAt = now;
    const filter = `job == "${this.id}"`;
    const { items } = await get("/v1/images", { dataset: this.bar.job.dataset, filter, limit: TILES, fields: "job,frame" }, this.route.signal);
    if (items.length <= this.shownTiles) return;
    this.shownTiles = items.length;
    this.images.hidden = false;
    put(this.tiles, items.map((row) => h("a", { href: `#/image/${path(row.job, String(row.frame))}${queryOf({ filter })}` },
      picture(`/v1/images/${path(row.job, String(row.frame))}/preview`, `Frame ${row.frame}`), h("span.caption", {}, String(row.frame)))));
  }

  async showDescription() {
    const description = await get(`${this.base}/description`, {}, this.route.signal);
    this.composed = composable(description);
    this.description.append(h("pre", { tabindex: "0", role: "group", "aria-label": "The job as JSON" }, print(description, 2)));
    this.draw();
  }
}

// A description for a new job. A collection is read again, so the ids of its scenes are left out.
function composable(description) {
  if (description.scene?.kind !== "collection") return description;
  const { id, ...scene } = description.scene;
  return { ...description, scene };
}

async function showWarnings(place, base, route) {
  const all = await list(`${base}/warnings`, route.signal);
  place.hidden = all.length === 0;
  put(place, h("h2", {}, "Warnings"), table(["warning", "frames", "first"], all.map((one) => [one.warning, number(one.frames),
    number(one.first_frame)]), { label: "Warnings" }));
}

async function showFailures(place, base, route) {
  const all = await lines(`${base}/errors`, route.signal);
  place.hidden = all.length === 0;
  const rows = all.slice(0, 200).map((one) => [number(one.frame), one.error ?? one.reason ?? "", number(one.attempts)]);
  put(place, h("h2", {}, count(all.length, "failed frame")), table(["frame", "why", "attempts"], rows, { label: "Failed frames" }),
    all.length > 200 && h("p.quiet", {}, `The first 200 of ${number(all.length)}.`));
}
