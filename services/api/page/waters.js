// Waters and styles, each with the same scene.

import { list, pause, send } from "./api.js";
import { curves } from "./chart.js";
import { h, heading, problemBox, put, same, table } from "./dom.js";
import { print } from "./exact.js";
import { pictureOf, rendered } from "./live.js";
import { picture } from "./picture.js";
import { count, number, path } from "./text.js";

const SCENE = { scene: { kind: "procedural", family: "structure", seed: 4 }, camera: { width: 320, height: 205, hfov_deg: 80 } };
const COLORS = [["r", 0], ["g", 1], ["b", 2]];

export async function show(root, route) {
  return route.name === "styles" ? styles(root, route) : waters(root, route);
}

async function waters(root, route) {
  const place = h("div.cards");
  root.append(heading("Waters", h("p.quiet", {}, "The same scene in each, at a quarter of the range.")), place,
    same("GET /v1/waters", "fathom waters"));
  const all = await list("/v1/waters", route.signal);
  const wall = new Wall(route);
  put(place, all.map((water) => waterCard(water, wall)));
}

function waterCard(water, wall) {
  const canvas = wall.picture(`The scene in ${water.name}`, { ...SCENE, water: { optics: water.name, range_scale: 0.25 } });
  const c = water.beam_attenuation_per_m;
  const steps = Array.from({ length: 41 }, (_, step) => step / 2);
  const through = c && COLORS.map(([color, index]) => ({ name: color, color, points: steps.map((range) => [range, Math.exp(-c[index] * range)]) }));
  const spectrum = ["absorption_per_m", "scattering_per_m", "beam_attenuation_per_m", "diffuse_attenuation_per_m"].filter((name) => water[name]);
  return h("article.card", {}, canvas, h("h2", {}, water.name), h("p.quiet", {}, [water.jerlov_type && `Jerlov ${water.jerlov_type}. `, water.source]),
    through && curves(through, { label: `Transmittance of ${water.name} over 20 m in red, green and blue`, x: "range, m", y: "transmittance" }),
    h("details", {}, h("summary", {}, "Coefficients"), table(["1/m", ...(water.wavelength_nm ?? ["R", "G", "B"]).map((one) => (typeof one === "number" ? `${one} nm` : one))],
      spectrum.map((name) => [[name.replace("_per_m", ""), water.derived?.includes(name) && h("em.quiet", {}, " derived")], ...water[name].map((one) => number(one, 3))]),
      { label: `Coefficients of ${water.name}` }), h("p.quiet", {}, `License: ${water.licence ?? "unknown"}`),
    (water.caveats ?? []).concat(water.warnings ?? []).map((text) => h("p.quiet", {}, text))),
    h("a", { href: `#/compose?job=${encodeURIComponent(JSON.stringify({ ...SCENE, water: { optics: water.name, range_scale: 0.25 } }))}` }, "Compose with it"));
}

// Images rendered one by one as they become visible.
class Wall {
  constructor(route) {
    this.signal = route.signal;
    this.wanted = new Map();
    this.watch = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        if (isIntersecting && this.wanted.has(target)) {
          this.queue = (this.queue ?? Promise.resolve()).then(() => this.draw(target)).catch(() => {});
        }
      }
    }, { rootMargin: "200px" });
    this.signal.addEventListener("abort", () => this.watch.disconnect());
  }

  picture(label, frame) {
    const canvas = h("canvas.scene.waiting", { width: 320, height: 205, role: "img", "aria-label": label });
    this.wanted.set(canvas, frame);
    this.watch.observe(canvas);
    return canvas;
  }

  async draw(canvas) {
    const frame = this.wanted.get(canvas);
    if (!frame || this.signal.aborted) return;
    this.wanted.delete(canvas);
    try {
      const bitmap = await rendered(pictureOf(frame, 1), this.signal);
      canvas.getContext("2d").drawImage(bitmap, 0, 0, canvas.width, canvas.height);
    } catch (error) {
      if (this.signal.aborted) return;
      canvas.setAttribute("aria-label", error.message);
      canvas.title = error.message;
    }
    canvas.classList.remove("waiting");
  }
}

async function styles(root, route) {
  const place = h("div.cards");
  const wall = new Wall(route);
  const draw = async () => put(place, (await list("/v1/styles", route.signal)).map((style) => styleCard(style, wall)));
  root.append(heading("Styles"), place, trainer(route, draw), same("GET /v1/styles", "POST /v1/styles/train", "fathom styles", "fathom train dock.png --name dock"));
  await draw();
}

function styleCard(style, wall) {
  const frame = { ...SCENE, water: { optics: "jerlov-II", range_scale: 0.06, style: style.name }, alpha: 0.9 };
  return h("article.card", {}, wall.picture(`The scene with the style ${style.name}`, frame), h("h2", {}, style.name),
    h("p.quiet", {}, style.source ?? ""), h("p.quiet", {}, `License: ${style.licence ?? "unknown"}. ${count(style.parameters ?? 0, "parameter")}.`),
    (style.caveats ?? []).map((text) => h("p.quiet", {}, text)),
    h("a", { href: `#/compose?job=${encodeURIComponent(print(frame))}` }, "Compose with it"));
}

// Accepts a photo and plots the losses while the style is trained.
function trainer(route, done) {
  const words = h("div", { "aria-live": "polite" });
  const photo = h("input", { type: "file", accept: "image/png,image/jpeg,image/webp", multiple: true, required: true, "aria-label": "Photos of one water" });
  const name = h("input", { type: "text", required: true, pattern: "[a-z0-9_\\-]{1,64}", "aria-label": "Name of the style", placeholder: "name, such as dock" });
  const steps = h("input", { type: "number", min: 1, max: 5000, value: 300, "aria-label": "Steps" });
  const range = h("input", { type: "checkbox", "aria-label": "Follows the range" });
  const form = h("form.panel.drop", { onsubmit: async (event) => {
    event.preventDefault();
    const body = new FormData();
    body.append("name", name.value);
    body.append("steps", steps.value);
    body.append("range", range.checked);
    for (const file of photo.files) body.append("photo", file);
    try {
      const training = await (await send("/v1/styles/train", { method: "POST", body, signal: route.signal })).json();
      await watch(training, words, route);
      await done();
    } catch (error) {
      if (!route.signal.aborted) put(words, problemBox(error));
    }
  }, ondragover: (event) => event.preventDefault(), ondrop: (event) => {
    event.preventDefault();
    if (event.dataTransfer.files.length > 0) photo.files = event.dataTransfer.files;
  } }, h("h2", {}, "Train a style from a photo"), h("p.quiet", {}, "Drop photos of one water here, or choose them. A thousand steps take about a minute on four free cores."),
  h("div.row", {}, photo, name, h("label.field", {}, h("span", {}, "steps"), steps),
    h("label.field", { title: "Contrast falls with range as in the photos; scenes need a range" }, h("span", {}, "follows the range"), range), h("button.primary", {}, "Train")), words);
  return form;
}

async function watch(training, words, route) {
  const points = {};
  const scene = h("div");
  let drawn = null;
  for (;;) {
    for (const [loss, value] of Object.entries(training.losses ?? {})) (points[loss] ??= []).push([training.done, value]);
    const lines = Object.entries(points).map(([loss, all], index) => ({ name: loss, color: ["r", "g", "b"][index % 3], points: all }));
    const stop = ["queued", "running"].includes(training.state) && h("button", { type: "button", onclick: () => send(
      `/v1/styles/trainings/${encodeURIComponent(training.id)}`, { method: "DELETE" }).catch(() => {}) }, "Stop");
    if (training.preview_ms && training.preview_ms !== drawn) {
      drawn = training.preview_ms;
      // A different address for each, because the image changes.
      put(scene, picture(`/v1/styles/trainings/${path(training.id)}/preview?at=${drawn}`, `A scene in ${training.name} after ${training.done} steps`,
        { class: "learning", width: 320, height: 240 }));
    }
    put(words, h("p", {}, `${training.name}: ${training.state}, ${number(training.done)} of ${number(training.steps)} steps`,
      training.error && h("span.bad", {}, ` ${training.error}`)), h("progress", { max: training.steps, "aria-label": "Progress of the training" }), stop, scene,
    lines.some((line) => line.points.length > 1) && curves(lines, { label: `Losses: ${Object.keys(points).join(", ")}`, x: "steps", y: Object.keys(points).join(", ") }));
    words.querySelector("progress").value = training.done;
    if (!["queued", "running"].includes(training.state)) return;
    await pause(1000, route.signal);
    training = await (await send(`/v1/styles/trainings/${encodeURIComponent(training.id)}`, { signal: route.signal })).json();
  }
}
