// The live frame, which follows the latest description, and the handles of its lamps.

import { get, pause, post } from "./api.js";
import { h, put, svg } from "./dom.js";

// Concurrent requests: the service renders two at a time, or transfers one image while it renders the next.
const MOST = 2;

export class Live {
  // shown({bitmap, ms, share, isRough}) is called for each image, in order; failed(error) on errors.
  constructor(signal, shown, failed) {
    this.signal = signal;
    this.shown = shown;
    this.failed = failed;
    this.open = 0;
    this.asked = 0;
    this.newest = 0;
    this.queue = [];
  }

  // Renders these frames, [{frame, share, isRough}], in place of the earlier ones that are not started yet.
  ask(frames) {
    this.queue = frames;
    this.start();
  }

  start() {
    while (this.queue.length > 0 && this.open < MOST && !this.signal.aborted) {
      this.asked += 1;
      this.run(this.queue.shift(), this.asked);
    }
  }

  async run({ frame, ...how }, number) {
    const begun = performance.now();
    this.open += 1;
    try {
      const bitmap = await rendered(frame, this.signal);
      if (number > this.newest) {
        this.newest = number;
        this.shown({ bitmap, ...how, ms: performance.now() - begun });
      }
    } catch (error) {
      if (!this.signal.aborted && number === this.asked) this.failed(error);
    } finally {
      this.open -= 1;
      this.start();
    }
  }
}

// Renders a frame that the service does not store.
export async function rendered(frame, signal) {
  const response = await post("/v1/renders", frame, { signal, accept: "image/*", prefer: "wait=30" });
  if (response.status === 202) throw new Error("the service is too busy to render this now");
  return createImageBitmap(await response.blob());
}

// A scene as `/v1/renders` accepts it: the drawn scene of a collection becomes an uploaded scene.
export function singleScene(scene) {
  if (scene?.kind !== "collection" || typeof scene.id !== "string") return scene;
  const { name, each, ...own } = scene;
  return { ...own, kind: "uploaded" };
}

// A preview during a drag: errors of 0.02 of white are not visible in it, and no time is spent on a choice of effects.
export const ROUGH = { quality: 82, tolerance: 0.02 };
// A preview as exact as the frame.
export const EXACT = { quality: 90, tolerance: 0 };

// The part of a description that affects the image, at a share of its size.
export function pictureOf(frame, share, { quality, tolerance } = EXACT) {
  const { count, dataset, labels, enhance, metrics, ...rest } = frame;
  const camera = { ...(frame.camera ?? {}) };
  // An uploaded scene has its own size.
  if (frame.scene?.kind === "procedural") {
    camera.width = Math.max(16, Math.round((camera.width ?? 768) * share));
    camera.height = Math.max(16, Math.round((camera.height ?? 492) * share));
  }
  const fidelity = tolerance > (rest.fidelity?.tolerance ?? 0) ? { fidelity: { tolerance } } : {};
  return { ...rest, ...fidelity, scene: singleScene(frame.scene), camera, artifacts: ["rgb"], enhance: [], metrics: [], encode: { format: "jpeg", quality } };
}

// Shares of the full size during a drag. It starts with the smallest, so that the first image comes soon.
const DRAG_SHARES = [0.25, 0.375, 0.5];
// Milliseconds from the request to the image. With two requests in flight, 110 ms are 18 images/s.
const SLOW_MS = 110;
const FAST_MS = 60;

// The size of the images of a drag: larger while they come fast, and smaller for its remainder once they are slow.
export class DragSize {
  constructor() {
    this.begin();
  }

  begin() {
    this.index = 0;
    this.most = DRAG_SHARES.length - 1;
  }

  get share() {
    return DRAG_SHARES[this.index];
  }

  note(ms) {
    if (ms > SLOW_MS && this.index > 0) {
      this.index -= 1;
      this.most = this.index;
    } else if (ms < FAST_MS && this.index < this.most) this.index += 1;
  }
}

// Shows a notice in `place` while no worker is connected. changed(isConnected) is called first and after each change.
export async function watchWorkers(place, signal, changed = (isConnected) => {}) {
  let before;
  while (!signal.aborted) {
    const { items } = await get("/v1/workers", {}, signal);
    const isConnected = items.length > 0;
    if (isConnected !== before) {
      put(place, !isConnected && noWorker());
      changed(isConnected);
    }
    before = isConnected;
    await pause(isConnected ? 10_000 : 1500, signal);
  }
}

export function noWorker() {
  return h("div.problem", { role: "alert" }, h("strong", {}, "No worker is connected"), h("p", {}, "Jobs and previews wait until one is. Start a worker with ",
    h("code", {}, `fathom worker --server ${location.origin}`), " or restart the service without ", h("code", {}, "--workers 0"), "."));
}

// Minimum distance for the handles of lamps: closer ones would be far outside the image.
const NEAREST_M = 1;
// Distance of a beam's handle from the camera.
const AIM_M = 3;
// Smallest share ahead of a beam with a handle.
const LEAST_AHEAD = 0.1;

// A handle for the position of each lamp, and one for the direction of each spot.
export class LampHandles {
  // moved(index, values, isDragging) is called with the new fields of a lamp; frame() returns the current frame.
  constructor(canvas, frame, moved) {
    this.canvas = canvas;
    this.frame = frame;
    this.moved = moved;
    this.lines = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none", "aria-hidden": "true" });
    this.buttons = h("div");
    this.element = h("div.handles", {}, this.lines, this.buttons);
    this.shown = "";
  }

  draw() {
    const { lights: all, camera = {} } = this.frame();
    const lights = Array.isArray(all) ? all : [];
    const view = this.lens(camera);
    const handles = lights.flatMap((light, index) => [{ index, part: "position", place: inPicture(light, view) },
      ...(light.kind === "spot" ? [{ index, part: "direction", place: aimInPicture(light, view) }] : [])]).filter(({ place }) => place !== null);
    const key = handles.map(({ index, part }) => `${index} ${part}`).join();
    if (key !== this.shown) put(this.buttons, handles.map((handle) => this.button(handle)));
    this.shown = key;
    handles.forEach(({ index, part, place }, position) => {
      const button = /** @type {HTMLElement} */ (this.buttons.children[position]);
      const [x, y] = [clamp(place.x), clamp(place.y)];
      button.style.left = `${100 * x}%`;
      button.style.top = `${100 * y}%`;
      button.setAttribute("aria-label", `${part === "position" ? "Position" : "Direction"} of light ${index + 1} (${lights[index].kind}): move with the arrow keys`);
    });
    put(this.lines, handles.filter(({ part }) => part === "direction").map(({ index, place }) => {
      const start = inPicture(lights[index], view);
      return svg("line", { x1: 100 * clamp(start.x), y1: 100 * clamp(start.y), x2: 100 * clamp(place.x), y2: 100 * clamp(place.y), "vector-effect": "non-scaling-stroke" });
    }));
  }

  button({ index, part }) {
    let last = null;
    const button = h(`button.handle.${part}`, { type: "button", title: `${part} of light ${index + 1}`, onpointerdown: (event) => {
      last = event;
      button.setPointerCapture(event.pointerId);
    }, onpointermove: (event) => {
      if (!last) return;
      const box = this.canvas.getBoundingClientRect();
      this.move(index, part, [(event.clientX - last.clientX) / box.width, (event.clientY - last.clientY) / box.height], true);
      last = event;
    }, onpointerup: () => {
      last = null;
      this.move(index, part, [0, 0], false);
    }, onkeydown: (event) => {
      const step = { ArrowLeft: [-0.02, 0], ArrowRight: [0.02, 0], ArrowUp: [0, -0.02], ArrowDown: [0, 0.02] }[event.key];
      if (!step) return;
      event.preventDefault();
      this.move(index, part, step, true);
    } }, part === "position" ? "✦" : "◎");
    return button;
  }

  move(index, part, [dx, dy], isDragging) {
    const { lights, camera = {} } = this.frame();
    const view = this.lens(camera);
    const place = part === "position" ? inPicture(lights[index], view) : aimInPicture(lights[index], view);
    if (place === null) return;
    const target = { x: place.x + dx, y: place.y + dy };
    this.moved(index, part === "position" ? placed(lights[index], view, target) : aimed(lights[index], view, target), isDragging);
  }

  // The focal length in image widths, and the shape of the image.
  lens(camera) {
    const half = ((camera.hfov_deg ?? 80) * Math.PI) / 360;
    return { focal: 0.5 / Math.tan(half), shape: this.canvas.width / this.canvas.height };
  }
}

function clamp(share) {
  return Math.min(0.97, Math.max(0.03, share));
}

function rounded(value) {
  return Number(value.toFixed(4));
}

function project([right, down, ahead], { focal, shape }) {
  const depth = Math.max(NEAREST_M, ahead);
  return { x: 0.5 + (focal * right) / depth, y: 0.5 + (focal * shape * down) / depth };
}

// The position of a light in the image, as shares of its sides.
function inPicture(light, view) {
  return light.kind === "haze" ? { x: light.x, y: light.y } : project(light.position_m ?? [0, 0, 1], view);
}

// The fields of a light at this position; a lamp keeps its distance from the camera.
function placed(light, { focal, shape }, { x, y }) {
  if (light.kind === "haze") return { x: rounded(x), y: rounded(y) };
  const depth = Math.max(NEAREST_M, light.position_m[2]);
  return { position_m: [rounded(((x - 0.5) * depth) / focal), rounded(((y - 0.5) * depth) / (focal * shape)), light.position_m[2]] };
}

function aimDepth(light) {
  return Math.max(AIM_M, light.position_m[2] + 1);
}

// The intersection of a beam's axis with a plane ahead of the camera, or null if it points away from it.
function aimInPicture(light, view) {
  const [right, down, ahead] = light.direction ?? [0, 0, 1];
  if (ahead < LEAST_AHEAD * Math.hypot(right, down, ahead)) return null;
  const scale = (aimDepth(light) - light.position_m[2]) / ahead;
  return project([light.position_m[0] + scale * right, light.position_m[1] + scale * down, aimDepth(light)], view);
}

// The direction of a beam whose axis meets this point of the image.
function aimed(light, { focal, shape }, { x, y }) {
  const depth = aimDepth(light);
  const length = depth - light.position_m[2];
  const right = ((x - 0.5) * depth) / focal - light.position_m[0];
  const down = ((y - 0.5) * depth) / (focal * shape) - light.position_m[1];
  return { direction: [rounded(right / length), rounded(down / length), 1] };
}
