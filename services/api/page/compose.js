// A job next to a live frame. Form and JSON edit one document, and the frame follows it.

import { ProblemError, get, pause, post, read } from "./api.js";
import { h, heading, problemBox, put, same } from "./dom.js";
import { parse, print } from "./exact.js";
import { START, at } from "./fields.js";
import { Form } from "./form.js";
import { settled } from "./laws.js";
import { DragSize, EXACT, LampHandles, Live, ROUGH, pictureOf, rendered, singleScene, watchWorkers } from "./live.js";
import { bytes, count, duration, number } from "./text.js";

const STRIP = 12;
// Images after the last change: a smaller one first, because a full one can need seconds.
const AT_REST = [[0.5, EXACT], [1, EXACT]];

export async function show(root, route) {
  const view = new Compose(root, route);
  await view.start();
}

class Compose {
  constructor(root, route) {
    this.root = root;
    this.route = route;
    this.job = opened(route.query.job);
    this.frame = Number(route.query.frame) || 0;
    this.first = [];
    this.dragSize = new DragSize();
    this.form = new Form(this.job, (isDragging) => this.changed(isDragging));
    this.json = h("textarea.mono", { id: "json", spellcheck: "false", rows: 18, "aria-label": "The job as JSON", oninput: () => this.read() });
    this.canvas = h("canvas", { width: 768, height: 492, role: "img", "aria-label": "The live frame" });
    this.handles = new LampHandles(this.canvas, () => this.current(), (index, values, isDragging) => this.moveLamp(index, values, isDragging));
    this.workers = h("div");
    this.speed = h("p.quiet", { "data-speed": "" }, "Rendering …");
    this.wrong = h("div", { "aria-live": "polite" });
    this.facts = h("div.note", { role: "status" }, "…");
    this.strip = h("div.frames", { role: "group", "aria-label": "Twelve sample frames" });
    this.submit = h("button.primary", { type: "button", onclick: () => this.send() }, "Submit");
    this.plan = h("div");
    this.live = new Live(route.signal, (shown) => this.shown(shown), (error) => this.failed(error));
    root.append(heading("Compose"), h("div.compose", {}, h("div.view-side", {}, h("div.live", {}, this.canvas, this.handles.element), this.speed, this.workers, this.wrong,
      h("div.row", {}, this.submit, this.facts), this.strip, this.plan), h("div", {}, this.form.element,
      h("details.panel", { open: true }, h("summary", {}, "JSON"), this.json))),
    same("POST /v1/jobs/preview?frames=12", "POST /v1/renders", "POST /v1/jobs", "fathom plan job.json --frame 0", "fathom submit job.json --wait"));
  }

  async start() {
    this.write();
    watchWorkers(this.workers, this.route.signal, (isConnected) => this.workersChanged(isConnected)).catch(() => {});
    this.changed(false);
    await this.form.start();
    this.form.inherit(this.drawn());
  }

  workersChanged(isConnected) {
    const isBack = isConnected && this.isConnected === false;
    this.isConnected = isConnected;
    if (!isConnected) this.speed.textContent = "No worker is connected.";
    if (!isBack) return;
    this.speed.textContent = "Rendering …";
    this.changed(false);
  }

  write() {
    this.json.value = print(this.job, 2);
  }

  // After an edit of the JSON, update the form.
  read() {
    let parsed;
    try {
      parsed = parse(this.json.value);
      if (!parsed || typeof parsed !== "object" || Array.isArray(parsed)) throw new Error("a job must be an object");
    } catch (error) {
      this.json.setAttribute("aria-invalid", "true");
      put(this.wrong, h("p.wrong", {}, `JSON: ${error.message}`));
      // The document still holds the job before this edit, which must not be checked or submitted in its place.
      clearTimeout(this.timer);
      this.working?.abort();
      this.submit.disabled = true;
      return;
    }
    for (const key of Object.keys(this.job)) delete this.job[key];
    Object.assign(this.job, parsed);
    this.json.removeAttribute("aria-invalid");
    this.form.draw();
    this.changed(false, true);
  }

  changed(isDragging, isFromJson = false) {
    if (!isFromJson) this.write();
    this.json.removeAttribute("aria-invalid");
    this.render([[this.dragSize.share, ROUGH]]);
    this.handles.draw();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.settle(), isDragging ? 350 : 200);
  }

  // Renders the current frame as each of `steps`, [[share, how]], unless some of its values are still unknown.
  render(steps) {
    const frame = this.current();
    const isKnown = (this.job.site === undefined || frame.scene) && singleScene(frame.scene)?.kind !== "collection";
    if (isKnown) this.live.ask(steps.map(([share, how]) => ({ frame: pictureOf(frame, share, how), share, isRough: how === ROUGH })));
  }

  // The drawn values of the selected frame, once the service has checked the job.
  drawn() {
    return this.first[this.frame]?.parameters;
  }

  current() {
    const drawn = this.drawn();
    const own = settled(this.job, drawn);
    if (!drawn) return own;
    if (this.job.site !== undefined) return replaced(drawn, own);
    return completed(own, drawn);
  }

  // After the last change: errors, cost, sample frames, and the frame in full size.
  async settle() {
    this.working?.abort();
    this.working = new AbortController();
    const signal = AbortSignal.any([this.working.signal, this.route.signal]);
    this.route.set({ job: print(this.job) });
    try {
      const preview = await read(await post(`/v1/jobs/preview?frames=${STRIP}`, this.job, { signal }));
      this.first = preview.first;
      this.frame = Math.min(this.frame, this.first.length - 1);
      this.form.inherit(this.drawn());
      this.form.fault([]);
      put(this.wrong, preview.warnings.map((text) => h("p.note", {}, text)));
      this.tell(preview);
      this.submit.disabled = false;
    } catch (error) {
      if (signal.aborted) return;
      this.submit.disabled = true;
      this.fault(error);
      return;
    }
    await this.showFrames(signal);
  }

  // Pictures and plan of a valid job. It can be submitted even if they fail.
  async showFrames(signal) {
    this.dragSize.begin();
    this.render(this.pictures ? AT_REST : [[this.dragSize.share, ROUGH], ...AT_REST]);
    this.handles.draw();
    try {
      await this.showPlan(signal);
      await this.showStrip(signal);
    } catch (error) {
      if (!signal.aborted) put(this.plan, h("p.note", {}, `This frame has no preview: ${error.message}. The job is valid and can be submitted.`));
    }
  }

  fault(error) {
    const errors = error instanceof ProblemError ? error.problem.errors ?? [] : [];
    const others = this.form.fault(errors);
    if (errors.length === 0) put(this.wrong, problemBox(error));
    else put(this.wrong, others.length === 0 ? h("p.wrong", {}, `${count(errors.length, "error")}, at the fields.`)
      : h("ul.problem", {}, others.map((one) => h("li", {}, h("code", {}, one.pointer), ` ${one.message}`))));
  }

  tell({ frames, estimate }) {
    const tolerance = at(this.job.site === undefined ? this.job : this.first[0].parameters, "/fidelity/tolerance");
    put(this.facts, `${count(frames, "frame")}, about ${duration(estimate.seconds)} with ${count(estimate.slots, "slot")} `
      + `(${duration(estimate.slot_seconds)} of slots, at most ${duration(estimate.frame_seconds)} a frame), `
      + `${bytes(estimate.bytes)}, error within ${typeof tolerance === "number" || tolerance === undefined ? number(tolerance ?? 3e-4) : "the tolerance"}`);
  }

  shown({ bitmap, share, isRough, ms }) {
    this.canvas.width = bitmap.width;
    this.canvas.height = bitmap.height;
    this.canvas.getContext("2d").drawImage(bitmap, 0, 0);
    bitmap.close();
    if (isRough) this.dragSize.note(ms);
    const now = performance.now();
    this.times = [...(this.times ?? []).filter((time) => now - time < 1500), now];
    this.pictures = (this.pictures ?? 0) + 1;
    this.speed.dataset.speed = JSON.stringify({ drawn: this.pictures, ms: Math.round(ms), isFull: share === 1, width: this.canvas.width });
    const rate = this.times.length > 2 ? (1000 * (this.times.length - 1)) / (now - this.times[0]) : 0;
    this.speed.textContent = `${this.canvas.width}×${this.canvas.height}, ${Math.round(ms)} ms${isRough && rate > 1 ? `, ${number(rate, 2)} frames/s` : ""}`;
  }

  failed(error) {
    if (this.isConnected !== false && !(error instanceof ProblemError && error.problem.errors)) this.speed.textContent = error.message;
  }

  // The plan of the frame: error bound and time of each stage.
  async showPlan(signal) {
    await pause(400, signal);
    const frame = this.current();
    const { count: _, dataset, labels, ...rest } = frame;
    const response = await post("/v1/renders", { ...rest, scene: singleScene(frame.scene), artifacts: ["rgb"], metrics: [], enhance: [] }, { signal, prefer: "wait=30" });
    if (response.status !== 200) return;
    const record = await read(response);
    const { planTable } = await import("./record.js");
    const isOpen = this.plan.querySelector("details")?.open ?? false;
    const { promise } = record;
    const share = promise?.relative ? ` plus ${number(100 * promise.relative, 2)} % of its value` : "";
    const bound = promise ? `error at most ${number(promise.bound, 2)}${share}, ` : "";
    put(this.plan, h("details.panel", { open: isOpen }, h("summary", {}, `Plan of this frame: ${bound}`
      + `${number(record.timings_ms?.total ?? 0, 3)} ms`), planTable(record)));
  }

  async showStrip(signal) {
    const tiles = this.first.map((one, index) => {
      const canvas = h("canvas.waiting", { width: 192, height: 123, role: "img", "aria-label": `Frame ${one.frame}` });
      const button = h("button", { type: "button", "aria-pressed": String(index === this.frame), onclick: () => {
        this.frame = index;
        this.route.set({ frame: index || "" });
        for (const tile of this.strip.children) tile.setAttribute("aria-pressed", String(tile === button));
        this.form.inherit(this.drawn());
        this.render(AT_REST);
        this.handles.draw();
      } }, canvas, h("span.caption", {}, `${one.frame}`));
      return { button, canvas, frame: settled(one.parameters, undefined) };
    });
    put(this.strip, tiles.map((tile) => tile.button));
    for (const { canvas, frame } of tiles) {
      const share = 192 / (frame.camera?.width ?? 768);
      const bitmap = await rendered(pictureOf(frame, share, ROUGH), signal);
      canvas.width = bitmap.width;
      canvas.height = bitmap.height;
      canvas.getContext("2d").drawImage(bitmap, 0, 0);
      canvas.classList.remove("waiting");
    }
  }

  moveLamp(index, values, isDragging) {
    Object.assign(this.form.ownLights()[index], values);
    this.changed(isDragging);
    if (!isDragging) this.form.draw();
  }

  async send() {
    this.submit.disabled = true;
    try {
      const job = await read(await post("/v1/jobs", this.job, { signal: this.route.signal }));
      location.hash = `#/jobs/${encodeURIComponent(job.id)}`;
    } catch (error) {
      if (this.route.signal.aborted) return;
      this.fault(error);
      this.submit.disabled = false;
    }
  }
}

function opened(text) {
  try {
    const job = parse(text);
    if (job && typeof job === "object" && !Array.isArray(job)) return job;
  } catch {
    // A truncated address falls back to the default job.
  }
  return structuredClone(START);
}

// Merges objects and replaces everything else, as a job overrides its site.
function replaced(base, own) {
  const isObject = (one) => one !== null && typeof one === "object" && !Array.isArray(one);
  if (!isObject(base) || !isObject(own)) return own;
  return { ...base, ...Object.fromEntries(Object.entries(own).map(([key, value]) => [key, replaced(base[key], value)])) };
}

// A frame with the values that only the service draws: the scene of a collection, and the position on a path.
function completed(own, drawn) {
  const { scene, camera } = own;
  const frame = { ...own };
  if (scene?.kind === "collection" && scene.name === drawn.scene?.name) frame.scene = { ...scene, id: drawn.scene.id };
  if (camera?.path && drawn.camera?.path) frame.camera = { ...camera, path: { frame: drawn.camera.path.frame, ...camera.path } };
  return frame;
}
