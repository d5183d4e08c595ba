// Jobs with live progress; failures with their errors; the workers.

import { follow, get, lines, list, pause, post, read } from "./api.js";
import { h, heading, problemBox, put, same, table } from "./dom.js";
import { bytes, count, duration, number, path, when } from "./text.js";

// A browser has six connections to a service; images and queries need some of them.
const STREAMS = 3;
const OPEN = ["queued", "running", "paused"];

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
    : table(["set", "progress", "state", "bytes", "submitted"], jobs.map(row), { label: "Jobs" }));
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
  put(place, h("h2", {}, count(items.length, "worker")), items.length === 0 ? h("p.bad", {}, "No workers are connected; jobs wait.")
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
    const { done, failed, frames, state } = this.job;
    this.meter.value = done + failed;
    put(this.numbers, `${number(done)} of ${number(frames)}`, failed > 0 && h("span.bad", {}, `, ${number(failed)} failed`));
    const rate = this.rate();
    const rest = state === "running" && rate > 0 ? `, ${duration((frames - done - failed) / rate)} left` : "";
    put(this.words, state.replaceAll("_", " "), rate > 0 && ` · ${number(rate, 3)} frames/s${rest}`);
  }
}

async function one(root, route, id) {
  const base = `/v1/jobs/${path(id)}`;
  const job = await get(base, {}, route.signal);
  const bar = new Bar(job);
  const controls = h("div.row");
  const wrong = h("div", { "aria-live": "polite" });
  const failures = h("section.panel", { hidden: true });
  const warned = h("section.panel", { hidden: true });
  const facts = h("div");
  root.append(heading(`Job of ${job.dataset}`, h("a", { href: `#/set/${path(job.dataset)}` }, "To its set")), h("div.note.big", {}, bar.element, bar.words),
    controls, wrong, facts, warned, failures, same(`GET ${base}`, `GET ${base}/events`, `POST ${base}/pause`, `POST ${base}/retry-failed`, `fathom wait ${id}`,
      `fathom pause ${id}`, `fathom errors ${id}`, `fathom retry ${id}`));
  const act = (name) => async () => {
    try {
      const now = await read(await post(`${base}/${name}`, undefined, { signal: route.signal }));
      bar.tell("state", now.job ?? now);
      put(wrong);
      watch();
    } catch (error) {
      if (!route.signal.aborted) put(wrong, problemBox(error));
    }
    draw();
  };
  const button = (name, text, isThere) => isThere && h("button", { type: "button", onclick: act(name) }, text);
  let shownFailed = -1;
  const draw = () => {
    const isOpen = OPEN.includes(bar.job.state);
    put(controls, button("pause", "Pause", isOpen && bar.job.state !== "paused"), button("resume", "Resume", bar.job.state === "paused"),
      button("cancel", "Cancel", isOpen), button("retry-failed", "Retry failed frames", bar.job.failed > 0 && !isOpen));
    put(facts, table(["", ""], [["id", h("code", {}, id)], ["submitted", when(bar.job.created_at)], ["started", when(bar.job.started_at)],
      ["finished", when(bar.job.finished_at)], ["bytes", bytes(bar.job.bytes)], ["digest", h("code", {}, bar.job.digest ?? "–")]], { label: "Job" }));
    showWarnings(warned, base, route).catch(() => {});
    if (bar.job.failed !== shownFailed) {
      shownFailed = bar.job.failed;
      showFailures(failures, base, route).catch(() => {});
    }
  };
  let isWatched = false;
  const watch = async () => {
    if (isWatched) return;
    isWatched = true;
    await follow(`${base}/events`, route.signal, (kind, data) => {
      const before = bar.job.state;
      bar.tell(kind, data);
      if (before !== bar.job.state || bar.job.failed !== shownFailed) draw();
    }).catch(() => {});
    isWatched = false;
    await pause(300, route.signal).catch(() => {});
    if (!route.signal.aborted) draw();
  };
  draw();
  if (OPEN.includes(job.state)) watch();
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
