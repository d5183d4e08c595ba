// Cards with live pictures: waters and styles, each with the same scene, and uploaded scenes.

import { get, list, pause, send } from "./api.js";
import { curves } from "./chart.js";
import { h, heading, problemBox, put, same, table } from "./dom.js";
import { print } from "./exact.js";
import { uploadedJob } from "./fields.js";
import { pictureOf, rendered, watchWorkers } from "./live.js";
import { picture } from "./picture.js";
import { count, number, path, when } from "./text.js";

const SCENE = { scene: { kind: "procedural", family: "structure", seed: 4 }, camera: { width: 320, height: 205, hfov_deg: 80 } };
// The scene of the styles has edges near and far, and enough of its own contrast to recognize them.
const STYLE_SEED = 7;
const STYLE_ALPHA = 0.6;
const COLORS = [["r", 0], ["g", 1], ["b", 2]];
const NAMES = { r: "red", g: "green", b: "blue" };

// Uploaded scenes shown at first, and added by each press of the button.
const SCENES_SHOWN = 24;
// Scenes of a collection in its mosaic.
const TILES = 3;

export async function show(root, route) {
  const views = { styles, waters, scenes };
  await views[route.name](root, route);
}

function searchField(label) {
  return h("input", { id: "filter", type: "search", "aria-label": label, placeholder: label });
}

// Waters in groups by the origin of their coefficients; the search covers names, water types and sources.
async function waters(root, route) {
  const search = searchField("Find a water");
  search.value = route.query.search ?? "";
  const place = h("div");
  const notice = h("div");
  root.append(heading("Waters", search, h("p.quiet", {}, "The same scene in each, at a quarter of the range.")), notice, place,
    same("GET /v1/waters", "fathom waters"));
  const all = await list("/v1/waters", route.signal);
  const wall = new Wall(route, notice);
  const groups = [...Map.groupBy(all, originOf)].map(([origin, members]) => {
    const cards = members.map((water) => ({ text: [water.name, water.jerlov_type && `jerlov ${water.jerlov_type}`, water.source].join(" ").toLowerCase(), element: waterCard(water, wall) }));
    const element = h("details.origin", { open: members.some((water) => !water.unrenderable) }, h("summary", {}, h("h2", {}, origin), h("span.quiet", {}, ` ${count(members.length, "water")}`)),
      h("div.cards", {}, cards.map((card) => card.element)));
    return { element, cards, isOpen: element.open };
  });
  const none = h("p", { hidden: true }, "No water matches.");
  put(place, groups.map((group) => group.element), none);
  search.addEventListener("input", () => {
    route.set({ search: search.value.trim() });
    none.hidden = showMatches(groups, search.value);
  });
  none.hidden = showMatches(groups, search.value);
}

// The publication or program that the coefficients are from.
function originOf(water) {
  if (water.created_at) return "Added to this service";
  const origin = water.source?.split(/[:(]/)[0].replace(/,.*/, "").trim() || water.name;
  return origin[0].toUpperCase() + origin.slice(1);
}

// Hides the cards without all words of the text and their empty groups. Returns whether any card is left.
function showMatches(groups, text) {
  const words = text.trim().toLowerCase().split(/\s+/).filter(Boolean);
  let isAny = false;
  for (const { element, cards, isOpen } of groups) {
    for (const card of cards) card.element.hidden = !words.every((word) => card.text.includes(word));
    const isFound = cards.some((card) => !card.element.hidden);
    element.hidden = !isFound;
    element.open = words.length > 0 ? isFound : isOpen;
    isAny ||= isFound;
  }
  return isAny;
}

async function scenes(root, route) {
  const notice = h("div");
  const collections = h("section");
  const place = h("section");
  root.append(heading("Scenes"), notice, collections, place,
    same("GET /v1/scenes", "GET /v1/collections", "fathom scenes", "fathom upload dock.png --range dock-range.png --unit-m 0.001 --invalid-code 0 --hfov-deg 80",
      "fathom upload shots --unit-m 0.001 --invalid-code 0 --collection dock"));
  const [all, named] = await Promise.all([list("/v1/scenes", route.signal), get("/v1/collections", {}, route.signal)]);
  const wall = new Wall(route, notice);
  const found = await Promise.all(named.items.map(({ name }) => get(`/v1/collections/${path(name)}`, {}, route.signal)));
  if (named.items.length > 0) put(collections, h("h2", {}, "Collections"), h("div.cards", {}, named.items.map(({ name }, index) => collectionCard(name, found[index].items, wall))));
  if (all.length === 0) return put(place, h("div.empty", {}, h("h2", {}, "No scenes are uploaded yet"),
    h("p", {}, "A scene is a picture in air, usually with the range of each pixel, that jobs render under water. Upload one, or a folder as a collection:"),
    h("pre", { tabindex: "0", role: "group", "aria-label": "Commands" }, "fathom upload dock.png --range dock-range.png --unit-m 0.001 --invalid-code 0 --hfov-deg 80\n"
      + "fathom upload shots --unit-m 0.001 --invalid-code 0 --hfov-deg 80 --collection dock"),
    h("p", {}, "Without uploads, ", h("a", { href: "#/compose" }, "compose a job"), " over procedural scenes.")));
  const names = new Map(found.flatMap(({ items }, index) => items.map((one) => [one.id, `${named.items[index].name} / ${one.name}`])));
  const cards = h("div.cards");
  let shown = 0;
  const more = h("button", { type: "button", onclick: () => {
    const next = all.slice(shown, shown + SCENES_SHOWN);
    cards.append(...next.map((scene) => sceneCard(scene, names.get(scene.id), wall)));
    shown += next.length;
    more.hidden = shown === all.length;
  } }, "Show more");
  more.click();
  return put(place, h("h2", {}, count(all.length, "uploaded scene")), cards, more);
}

function composeLink(job) {
  return h("p", {}, h("a", { href: `#/compose?job=${encodeURIComponent(print(job))}` }, "Compose with it"));
}

function sceneFrame(id) {
  return { scene: { kind: "uploaded", id } };
}

function collectionCard(name, items, wall) {
  const available = { hasRange: items.every((one) => one.range_kind), hasMask: items.every((one) => one.instances) };
  const mosaic = h("div.mosaic.low", {}, items.slice(0, TILES).map((one) => wall.picture(`Scene ${one.name} of ${name}`, sceneFrame(one.id))));
  const facts = [count(items.length, "scene"), available.hasRange ? "range" : "no range in some", available.hasMask && "masks"];
  return h("article.card", {}, mosaic, h("h3", {}, name), h("p", {}, facts.filter(Boolean).join(" · ")),
    composeLink(uploadedJob({ kind: "collection", name, each: true }, available)));
}

function sceneCard(scene, name, wall) {
  const available = { hasRange: Boolean(scene.range_kind), hasMask: Boolean(scene.instances_digest) };
  const facts = [`${scene.width}×${scene.height}`, scene.range_kind ? scene.range_kind.replace("_", "-") : "no range", available.hasMask && "mask",
    scene.classes && count(Object.keys(scene.classes).length, "class", "classes"), scene.world_from_camera && "pose", scene.hfov_deg && `${number(scene.hfov_deg, 3)}° wide`];
  return h("article.card", {}, wall.picture(`Uploaded scene ${name ?? scene.id}`, sceneFrame(scene.id)), h("h3", {}, name ?? `Scene …${scene.id.slice(-6)}`),
    h("p", {}, facts.filter(Boolean).join(" · ")), h("p.quiet", {}, `Uploaded ${when(scene.created_at)}`), h("p.quiet", {}, h("code", {}, scene.id)),
    composeLink(uploadedJob({ kind: "uploaded", id: scene.id }, available)));
}

function waterCard(water, wall) {
  const canvas = water.unrenderable ? h("p.note", {}, `Cannot be rendered: ${water.unrenderable}.`)
    : wall.picture(`The scene in ${water.name}`, { ...SCENE, water: { optics: water.name, range_scale: 0.25 } });
  const c = water.beam_attenuation_per_m;
  const steps = Array.from({ length: 41 }, (_, step) => step / 2);
  const through = c && COLORS.filter(([, index]) => typeof c[index] === "number" && c[index] > 0).map(([color, index]) => ({ name: NAMES[color], color, points: steps.map((range) => [range, Math.exp(-c[index] * range)]) }));
  const spectrum = ["absorption_per_m", "scattering_per_m", "beam_attenuation_per_m", "diffuse_attenuation_per_m"].filter((name) => water[name]);
  return h("article.card", {}, canvas, h("h3", {}, water.name), h("p.quiet", {}, [water.jerlov_type && `Jerlov ${water.jerlov_type}. `, water.source]),
    through && curves(through, { label: `Transmittance of ${water.name} over 20 m in red, green and blue`, x: "range, m", y: "transmittance" }),
    h("details", {}, h("summary", {}, "Coefficients"), table(["1/m", ...(water.wavelength_nm ?? ["R", "G", "B"]).map((one) => (typeof one === "number" ? `${one} nm` : one))],
      spectrum.map((name) => [[name.replace("_per_m", ""), water.derived?.includes(name) && h("em.quiet", {}, " derived")], ...water[name].map((one) => number(one, 3))]),
      { label: `Coefficients of ${water.name}` }), h("p.quiet", {}, `License: ${water.licence ?? "unknown"}`),
    (water.caveats ?? []).concat(water.warnings ?? []).map((text) => h("p.quiet", {}, text))),
    !water.unrenderable && composeLink({ ...SCENE, water: { optics: water.name, range_scale: 0.25 } }));
}

// Images rendered one by one as they become visible.
class Wall {
  // `notice` shows a warning while no worker is connected.
  constructor(route, notice) {
    this.signal = route.signal;
    watchWorkers(notice, route.signal).catch(() => {});
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
      canvas.height = Math.round((canvas.width * bitmap.height) / bitmap.width);
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
  const notice = h("div");
  const wall = new Wall(route, notice);
  const draw = async () => put(place, (await list("/v1/styles?role=style", route.signal)).map((style) => styleCard(style, wall)));
  root.append(heading("Styles", h("p.quiet", {}, "The same scene in each: ", h("code", {}, "alpha"), ` ${STYLE_ALPHA} mixes the style with the computed water.`)), notice, place, trainer(route, draw), same("GET /v1/styles", "POST /v1/styles/train", "fathom styles", "fathom train dock.png --name dock"));
  await draw();
}

function styleCard(style, wall) {
  const frame = { ...SCENE, scene: { ...SCENE.scene, seed: STYLE_SEED }, water: { optics: "jerlov-II", range_scale: 0.06, style: style.name }, alpha: STYLE_ALPHA };
  return h("article.card", {}, wall.picture(`The scene with the style ${style.name}`, frame), h("h2", {}, style.name),
    h("p.quiet", {}, style.source ?? ""), h("p.quiet", {}, `License: ${style.licence ?? "unknown"}. ${count(style.parameters ?? 0, "parameter")}.`),
    (style.caveats ?? []).map((text) => h("p.quiet", {}, text)),
    composeLink(frame));
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
    h("span.checks", {}, h("label", { title: "Contrast falls with range as in the photos; scenes need a range" }, range, "follows the range")), h("button.primary", {}, "Train")), words);
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
