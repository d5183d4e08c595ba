// A job next to a live frame. Form and JSON edit one document, and the frame follows it.

import { ProblemError, get, pause, post, read } from "./api.js";
import { h, heading, problemBox, put, same } from "./dom.js";
import { parse, print } from "./exact.js";
import { START, at, put as set } from "./fields.js";
import { Form } from "./form.js";
import { settled } from "./laws.js";
import { Live, pictureOf, rendered } from "./live.js";
import { bytes, count, duration, number } from "./text.js";

const STRIP = 12;
// Minimum distance for the handles of lamps: closer ones would be far outside the image.
const NEAREST = 1;

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
    this.form = new Form(this.job, (isDragging) => this.changed(isDragging));
    this.json = h("textarea.mono", { id: "json", spellcheck: "false", rows: 18, "aria-label": "The job as JSON", oninput: () => this.read() });
    this.canvas = h("canvas", { width: 768, height: 492, role: "img", "aria-label": "The live frame" });
    this.handles = h("div.handles");
    this.speed = h("p.quiet", { "data-speed": "" }, "Rendering …");
    this.wrong = h("div", { "aria-live": "polite" });
    this.facts = h("div.note", { role: "status" }, "…");
    this.strip = h("div.frames", { role: "group", "aria-label": "Twelve sample frames" });
    this.submit = h("button.primary", { type: "button", onclick: () => this.send() }, "Submit");
    this.plan = h("div");
    this.live = new Live(route.signal, (shown) => this.shown(shown), (error) => this.failed(error));
    root.append(heading("Compose"), h("div.compose", {}, h("div.view-side", {}, h("div.live", {}, this.canvas, this.handles), this.speed, this.wrong,
      h("div.row", {}, this.submit, this.facts), this.strip, this.plan), h("div", {}, this.form.element,
      h("details.panel", { open: true }, h("summary", {}, "JSON"), this.json))),
    same("POST /v1/jobs/preview?frames=12", "POST /v1/renders", "POST /v1/jobs", "fathom plan job.json --frame 0", "fathom submit job.json --wait"));
  }

  async start() {
    this.write();
    await this.form.start();
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
    this.live.ask(pictureOf(this.current(), 0.5, 82), false);
    this.drawHandles();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.settle(), isDragging ? 350 : 200);
  }

  current() {
    const drawn = this.first[this.frame]?.parameters;
    const own = settled(this.job, drawn);
    // The values of a site are known once a frame is drawn.
    return this.job.site !== undefined && drawn?.site ? replaced(drawn, own) : own;
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
      this.form.fault([]);
      put(this.wrong, preview.warnings.map((text) => h("p.note", {}, text)));
      this.tell(preview);
      this.submit.disabled = false;
      this.live.ask(pictureOf(this.current(), 1), true);
      this.drawHandles();
      await this.showPlan(signal);
      await this.showStrip(signal);
    } catch (error) {
      if (signal.aborted) return;
      this.submit.disabled = true;
      this.fault(error);
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
    put(this.facts, `${count(frames, "frame")}, about ${duration(estimate.seconds)} with ${count(estimate.slots, "slot")}, `
      + `${bytes(estimate.bytes)}, error within ${typeof tolerance === "number" || tolerance === undefined ? number(tolerance ?? 3e-4) : "the tolerance"}`);
  }

  shown({ bitmap, isFull, ms }) {
    this.canvas.width = bitmap.width;
    this.canvas.height = bitmap.height;
    this.canvas.getContext("2d").drawImage(bitmap, 0, 0);
    bitmap.close();
    const now = performance.now();
    this.times = [...(this.times ?? []).filter((time) => now - time < 1500), now];
    this.drawn = (this.drawn ?? 0) + 1;
    this.speed.dataset.speed = JSON.stringify({ drawn: this.drawn, ms: Math.round(ms), isFull });
    const rate = this.times.length > 2 ? (1000 * (this.times.length - 1)) / (now - this.times[0]) : 0;
    this.speed.textContent = `${this.canvas.width}×${this.canvas.height}, ${Math.round(ms)} ms${!isFull && rate > 1 ? `, ${number(rate, 2)} frames/s` : ""}`;
  }

  failed(error) {
    if (!(error instanceof ProblemError && error.problem.errors)) this.speed.textContent = error.message;
  }

  // The plan of the frame: error bound and time of each stage.
  async showPlan(signal) {
    await pause(400, signal);
    const frame = this.current();
    const { count: _, dataset, labels, ...rest } = frame;
    const response = await post("/v1/renders", { ...rest, artifacts: ["rgb"], metrics: [], enhance: [] }, { signal, prefer: "wait=30" });
    if (response.status !== 200) return;
    const record = await read(response);
    const { planTable } = await import("./record.js");
    const isOpen = this.plan.querySelector("details")?.open ?? false;
    const bound = record.promise ? `error at most ${number(record.promise.bound, 2)}, ` : "";
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
        this.live.ask(pictureOf(this.current(), 1), true);
        this.drawHandles();
      } }, canvas, h("span.caption", {}, `${one.frame}`));
      return { button, canvas, frame: settled(one.parameters, undefined) };
    });
    put(this.strip, tiles.map((tile) => tile.button));
    for (const { canvas, frame } of tiles) {
      const share = 192 / (frame.camera?.width ?? 768);
      const bitmap = await rendered(pictureOf(frame, share, 80), signal);
      canvas.width = bitmap.width;
      canvas.height = bitmap.height;
      canvas.getContext("2d").drawImage(bitmap, 0, 0);
      canvas.classList.remove("waiting");
    }
  }

  // A handle for each light that can be moved in the image.
  drawHandles() {
    const now = this.current();
    const lights = Array.isArray(now.lights) ? now.lights : [];
    if (this.handles.children.length !== lights.length) put(this.handles, lights.map((_, index) => this.handle(index)));
    lights.forEach((light, index) => {
      const { x, y } = inPicture(light, now.camera ?? {});
      const button = this.handles.children[index];
      button.style.left = `${100 * Math.min(0.97, Math.max(0.03, x))}%`;
      button.style.top = `${100 * Math.min(0.96, Math.max(0.04, y))}%`;
      button.setAttribute("aria-label", `lights[${index}] ${light.kind}: move with the arrow keys`);
    });
  }

  handle(index) {
    const move = (dx, dy, isDragging) => {
      const now = this.current();
      const light = now.lights[index];
      this.job.lights ??= structuredClone(now.lights);
      const { x, y } = inPicture(light, now.camera ?? {});
      for (const [pointer, value] of Object.entries(placed(light, now.camera ?? {}, x + dx, y + dy))) {
        set(this.job, `/lights/${index}/${pointer}`, value);
      }
      this.changed(isDragging);
    };
    let last = null;
    const button = h("button.handle", { type: "button", onpointerdown: (event) => {
      last = event;
      button.setPointerCapture(event.pointerId);
    }, onpointermove: (event) => {
      if (!last) return;
      const box = this.canvas.getBoundingClientRect();
      move((event.clientX - last.clientX) / box.width, (event.clientY - last.clientY) / box.height, true);
      last = event;
    }, onpointerup: () => {
      last = null;
      this.form.draw();
    }, onkeydown: (event) => {
      const way = { ArrowLeft: [-0.02, 0], ArrowRight: [0.02, 0], ArrowUp: [0, -0.02], ArrowDown: [0, 0.02] }[event.key];
      if (!way) return;
      event.preventDefault();
      move(...way, true);
    } }, "✦");
    return button;
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

// The position of a light in the image, as shares of its sides.
function inPicture(light, camera) {
  if (light.kind === "haze") return { x: light.x, y: light.y };
  const [right, down, ahead] = light.position_m ?? [0, 0, 1];
  const { focal, shape } = lens(camera);
  const depth = Math.max(NEAREST, ahead);
  return { x: 0.5 + (focal * right) / depth, y: 0.5 + (focal * shape * down) / depth };
}

// The fields of a light at this position; a lamp keeps its distance from the camera.
function placed(light, camera, x, y) {
  const tidy = (value) => Number(value.toFixed(4));
  if (light.kind === "haze") return { x: tidy(x), y: tidy(y) };
  const { focal, shape } = lens(camera);
  const depth = Math.max(NEAREST, light.position_m[2]);
  return { position_m: [tidy(((x - 0.5) * depth) / focal), tidy(((y - 0.5) * depth) / (focal * shape)), light.position_m[2]] };
}

function lens(camera) {
  const half = ((camera.hfov_deg ?? 80) * Math.PI) / 360;
  return { focal: 0.5 / Math.tan(half), shape: (camera.width ?? 768) / (camera.height ?? 492) };
}
