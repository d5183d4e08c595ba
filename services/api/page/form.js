// The form of a job: one control per field. Form and JSON edit the same document.

import { get, known } from "./api.js";
import { h, prose, put, select } from "./dom.js";
import { isNumber, typed } from "./exact.js";
import { GROUPS, JOB_FIELDS, LAMPS, NEW_LAMPS, OPEN_GROUPS, OWN, at, put as set, useUploaded } from "./fields.js";
import { lawEditor, lawOf, lawsFor, newLaw } from "./laws.js";
import { fromHex, toHex } from "./picture.js";
import { number, when } from "./text.js";

// Uploaded scenes in the selector; the Scenes view has all.
const MOST_SCENES = 200;

export class Form {
  // changed(isDragging) is called after each change of the document.
  constructor(job, changed) {
    this.job = job;
    this.changed = changed;
    this.element = h("form.compose-form", { "aria-label": "Fields of the job", onsubmit: (event) => event.preventDefault() });
    this.notes = new Map();
  }

  async start() {
    const lists = [...new Set(GROUPS.flatMap(([, fields]) => fields.map((field) => field.list)).filter(Boolean))];
    const [fields, sites, scenes, collections, ...found] = await Promise.all([known("/v1/lists/fields"), known("/v1/lists/sites"),
      get("/v1/scenes", { limit: MOST_SCENES }), get("/v1/collections"), ...lists.map(known)]);
    this.sites = sites.map((site) => [site.name, `${site.name}: ${site.about}`]);
    this.scenes = scenes.items;
    this.collections = collections.items;
    this.about = new Map(fields.map((field) => [field.name.replace(/\([a-z, ]+\)/g, ""), field]));
    this.options = new Map(lists.map((list, index) => [list, found[index].filter((one) => !one.unrenderable).map((one) => one.name)]));
    this.draw();
  }

  // Sets the drawn values of a frame. Fields that a site sets show them.
  inherit(drawn) {
    const isNew = this.job.site !== undefined && JSON.stringify([drawn?.site, drawn?.lights?.length]) !== JSON.stringify([this.drawn?.site, this.drawn?.lights?.length]);
    this.drawn = drawn;
    if (isNew && this.about) this.draw();
  }

  // The value in effect: that of the job, else that of its site in the current frame.
  value(pointer) {
    const own = at(this.job, pointer);
    return own !== undefined || this.job.site === undefined || JOB_FIELDS.has(pointer) ? own : at(this.drawn, pointer);
  }

  // Redraws every control, as after a change of the JSON.
  draw() {
    const active = document.activeElement;
    const holder = /** @type {HTMLElement} */ (active?.closest?.("[data-pointer]"));
    const pointer = holder?.dataset.pointer;
    const open = new Map([...this.element.querySelectorAll("details")].map((one) => [one.dataset.group, one.open]));
    this.notes.clear();
    const groups = GROUPS.map(([title, fields]) => h("details.panel", { "data-group": title, open: open.get(title) ?? OPEN_GROUPS.has(title) },
      h("summary", {}, title), title === "Scene" && this.sourceSelect(), title === "Lights" && this.lamps(), fields.map((field) => this.control(field))));
    put(this.element, this.siteSelect(), groups);
    const control = [...this.element.querySelectorAll("[data-pointer]")].find((one) => one.dataset.pointer === pointer);
    control?.querySelector(active.classList.contains("law-kind") ? ".law-kind" : "input, select:not(.law-kind), button")?.focus();
  }

  redraw() {
    this.changed(false);
    this.draw();
  }

  // A site replaces the description, except for dataset, count and seed of the job.
  siteSelect() {
    const { site } = this.job;
    const isOwn = site !== undefined && typeof site !== "string";
    const options = [["", isOwn ? "as in the JSON" : "none"], ...this.sites];
    return h("div.above", {}, select("Site", options, isOwn ? "" : site ?? "", (name) => {
      const { dataset, count, seed } = this.job;
      for (const key of Object.keys(this.job)) delete this.job[key];
      Object.assign(this.job, name ? { site: name } : structuredClone(OWN), { dataset, count, seed });
      this.drawn = undefined;
      this.redraw();
    }), h("p.help", {}, "A site describes a whole place. Every value that you change replaces the site's."));
  }

  // Selects procedural scenes, an uploaded scene or a collection.
  sourceSelect() {
    const kind = this.value("/scene/kind") ?? "procedural";
    const sources = [["procedural", "procedural"], ["uploaded", "an uploaded scene"], ["collection", "a collection of uploaded scenes"]]
      .filter(([name]) => name === "procedural" || name === kind || (name === "uploaded" ? this.scenes : this.collections).length > 0);
    const source = h("select", { id: "scene-source", onchange: () => this.useSource(source.value) }, sources.map(([name, text]) => h("option",
      { value: name, selected: name === kind }, text)));
    const isEmpty = this.scenes.length === 0 && kind === "procedural";
    return h("div.control", { "data-pointer": "/scene/kind" }, h("div.control-head", {}, h("label", { for: "scene-source" }, "Source of the scenes")), source,
      isEmpty && h("p.help", {}, "No scenes are uploaded. ", h("a", { href: "#/scenes" }, "Scenes"), " shows how."), this.uploadedSelect(kind));
  }

  uploadedSelect(kind) {
    const { scene } = this.job;
    if (kind !== "procedural" && (lawOf(scene?.id ?? scene?.name) || !scene)) return h("p.help", {}, "Random; edit it in the JSON.");
    if (kind === "uploaded") {
      const options = this.scenes.map((one) => [one.id, `${one.width}×${one.height}, ${one.range_kind ? "with range" : "no range"}, ${when(one.created_at)}, …${one.id.slice(-6)}`]);
      if (!this.scenes.some((one) => one.id === scene?.id)) options.push([scene?.id ?? "", scene?.id ?? ""]);
      return select("Uploaded scene", options, scene?.id, (id) => this.useScene(id));
    }
    if (kind !== "collection") return null;
    const names = [...new Set([...this.collections.map((one) => one.name), scene?.name].filter(Boolean))];
    return [select("Collection", names, scene?.name, (name) => this.useCollection(name)), h("label.checks", {}, h("input", { type: "checkbox", checked: scene?.each === true,
      onchange: (event) => {
        this.job.scene = { ...scene, each: event.target.checked };
        this.redraw();
      } }), "every scene in turn, with “Frames” frames each")];
  }

  useSource(kind) {
    if (kind === "uploaded") return this.useScene(this.scenes[0].id);
    if (kind === "collection") return this.useCollection(this.collections[0].name);
    if (this.job.site === undefined) Object.assign(this.job, { scene: structuredClone(OWN.scene), camera: { ...OWN.camera, ...this.job.camera } });
    else for (const key of ["scene", "camera", "artifacts"]) delete this.job[key];
    return this.redraw();
  }

  useScene(id) {
    const scene = this.scenes.find((one) => one.id === id);
    useUploaded(this.job, { kind: "uploaded", id }, { hasRange: Boolean(scene.range_kind), hasMask: Boolean(scene.instances_digest) });
    this.redraw();
  }

  async useCollection(name) {
    const { items } = await get(`/v1/collections/${encodeURIComponent(name)}`);
    useUploaded(this.job, { kind: "collection", name, each: true }, { hasRange: items.every((one) => one.range_kind), hasMask: items.every((one) => one.instances) });
    this.redraw();
  }

  // A control with its label in words, unit, distribution, editor, help and errors; null where the field has no effect.
  control(field, label = field.label) {
    const own = at(this.job, field.pointer);
    if (field.below && typeof this.value(field.below) !== "object") return null;
    if (own === undefined && field.when && !field.when((pointer) => this.value(pointer))) return null;
    const value = this.value(field.pointer);
    const name = field.pointer.slice(1).replaceAll("/", ".").replace(/\.(\d+)/g, "[$1]");
    const about = this.about.get(name.replace(/\[\d+\]/g, "[]").replace(/(position_m|direction)\[\]$/, "$1"));
    const law = lawOf(value);
    const id = `f${field.pointer.replaceAll("/", "-")}`;
    const note = h("p.wrong", { id: `${id}-wrong`, hidden: true });
    this.notes.set(field.pointer, note);
    const options = field.options ?? this.options.get(field.list) ?? [];
    const editor = law ? lawEditor(law, value, field, options, (next, isNew) => {
      this.change(field, next);
      if (isNew) this.draw();
    }) : this.plain(field, value, id, options);
    const unit = about?.unit && h("span.quiet", {}, `, ${about.unit}`);
    return h("div.control", { "data-pointer": field.pointer }, h("div.control-head", {}, h("label", { for: law || field.kind === "list" ? undefined : id }, label, unit),
      h("span.state", {}, this.siteState(field, own), this.kindSelect(field, value, law, label))), editor, h("p.help", {}, h("code", {}, name), about && [": ", prose(helpOf(about.about))]), note);
  }

  kindSelect(field, value, law, label) {
    const laws = lawsFor(field);
    if (laws.length === 0) return null;
    const kinds = [["", "value"], ...[...new Set([...laws, law].filter(Boolean))].map((one) => [one, one])];
    return h("select.law-kind", { "aria-label": `Value or distribution of ${label}`, onchange: (event) => {
      const now = plainValue(value, field);
      this.change(field, event.target.value === "" ? now : newLaw(event.target.value, field, now));
      this.draw();
    } }, kinds.map(([key, text]) => h("option", { value: key, selected: key === (law ?? "") }, text)));
  }

  // Whether a value is the site's, or a button that restores it.
  siteState(field, own) {
    if (this.job.site === undefined || JOB_FIELDS.has(field.pointer) || field.pointer.startsWith("/lights/")) return null;
    if (own === undefined) return this.value(field.pointer) !== undefined && h("span.help", {}, "from the site");
    return h("button.link", { type: "button", onclick: () => {
      set(this.job, field.pointer, undefined);
      this.redraw();
    } }, "use the site's");
  }

  plain(field, value, id, options) {
    if (field.kind === "list") return this.many(field, value ?? [], options);
    if (field.kind === "text") {
      const box = h("input", { id, type: "text", value: value ?? "", placeholder: field.value, oninput: () => this.change(field, box.value || undefined) });
      return box;
    }
    if (field.kind === "choice") {
      const now = typeof value === "string" ? value : value?.preset ?? "";
      const all = [...new Set([now, ...options].filter(Boolean))];
      const box = h("select", { id, onchange: () => {
        this.change(field, box.value || (this.job.site === undefined ? undefined : null));
        if (field.pointer === "/water/style") this.draw();
      } }, [...(field.none ? [["", field.none]] : []), ...all.map((one) => [one, one])].map(([key, text]) => h("option",
        { value: key, selected: key === now }, text)));
      return box;
    }
    if (field.kind === "intensity") return this.intensity(field, value, id);
    if (field.kind === "color") return this.color(field, value ?? [1, 1, 1], id);
    return this.slider(field, value, id);
  }

  // Brightness and color of a lamp: its largest channel, and the channels as shares of it.
  intensity(field, value, id) {
    if (!Array.isArray(value) || !value.every(isNumber)) return h("p.quiet", {}, "Random; edit it in the JSON.");
    const channels = value.map(Number);
    const peak = Math.max(...channels);
    let shares = channels.map((one) => (peak > 0 ? one / peak : 1));
    const brightness = this.slider({ ...field, kind: "number", log: true }, peak, id, (next, isDragging) => this.change(field, shares.map((one) => tidied(one * next)), isDragging));
    const color = h("input", { type: "color", value: toHex(shares, true), "aria-label": "Color of the lamp", oninput: () => {
      shares = fromHex(color.value, true);
      const now = Number(brightness.querySelector("input[type=number]").value);
      this.change(field, shares.map((one) => tidied(one * now)), true);
    }, onchange: () => this.changed(false) });
    brightness.append(color);
    return brightness;
  }

  color(field, value, id) {
    if (!Array.isArray(value) || !value.every(isNumber)) return h("p.quiet", {}, "Random; edit it in the JSON.");
    const isLinear = this.value(field.pointer.replace(/color$/, "space")) !== "display";
    const box = h("input", { id, type: "color", value: toHex(value, isLinear), oninput: () => this.change(field, fromHex(box.value, isLinear), true), onchange: () => this.changed(false) });
    return box;
  }

  slider(field, value, id, give = (next, isDragging = false) => this.change(field, next, isDragging)) {
    if (value === undefined && field.optional) {
      return h("button", { id, type: "button", onclick: () => {
        this.change(field, field.value);
        this.draw();
      } }, "Add");
    }
    const now = isNumber(value) ? value : field.value;
    const to = (one) => (field.log ? Math.log(Math.max(one, 1e-9)) : one);
    const from = (one) => (field.log ? Math.exp(one) : one);
    const [low, high] = [to(field.low), to(field.high)];
    const box = h("input", { type: "number", step: "any", value: now, "aria-label": `${field.label} as a number`, oninput: () => {
      if (box.value === "") return;
      range.value = to(Number(box.value));
      give(typed(box.value));
    } });
    const range = h("input", { id, type: "range", min: low, max: high, step: field.whole && !field.log ? 1 : (high - low) / 400, value: to(Number(now)),
      "aria-valuetext": number(now), oninput: () => {
        const value_ = from(Number(range.value));
        const next = field.whole ? Math.round(value_) : tidied(value_);
        box.value = next;
        range.setAttribute("aria-valuetext", number(next));
        give(next, true);
      }, onchange: () => this.changed(false) });
    return h("div.slider", {}, range, box, field.optional && at(this.job, field.pointer) !== undefined && this.removeButton(field));
  }

  removeButton(field) {
    return h("button", { type: "button", "aria-label": `Remove ${field.label}`, onclick: () => {
      const parent = GROUPS.flatMap(([, fields]) => fields).some((one) => one.below && field.pointer.startsWith(`${one.below}/`));
      set(this.job, parent || field.pointer === "/fidelity/tolerance" ? field.pointer.replace(/\/[^/]*$/, "") : field.pointer, undefined);
      this.redraw();
    } }, "×");
  }

  many(field, value, options) {
    const chosen = new Set(Array.isArray(value) ? value : []);
    const written = [...chosen].filter((one) => typeof one !== "string").length;
    const note = written > 0 && h("p.quiet", {}, `${written} more with parameters; edit them in the JSON.`);
    return h("div.checks", { role: "group", "aria-label": field.label }, note, options.map((one) => h("label", {}, h("input", { type: "checkbox", checked: chosen.has(one), onchange: (event) => {
      if (event.target.checked) chosen.add(one);
      else chosen.delete(one);
      this.change(field, [...chosen]);
    } }), one)));
  }

  lamps() {
    const all = this.value("/lights");
    const lamps = Array.isArray(all) ? all : [];
    const add = (kind) => h("button", { type: "button", onclick: () => {
      this.ownLights().push(structuredClone(NEW_LAMPS[kind]));
      this.redraw();
    } }, `Add ${kind}`);
    return [lawOf(all) && h("p.help", {}, "The lights are random. Moving one in the picture keeps those of this frame."),
      lamps.map((lamp, index) => h("details.lamp", { "data-group": `lights[${index}]`, open: this.isLampOpen(index, lamps.length) },
        h("summary", {}, `Light ${index + 1}: ${lamp.kind ?? "?"}`), (LAMPS[lamp.kind] ?? []).map((field) => this.control({ ...field, pointer: `/lights/${index}/${field.pointer}` })),
        h("button", { type: "button", onclick: () => {
          this.ownLights().splice(index, 1);
          this.redraw();
        } }, "Remove this light"))),
      h("div.row", {}, Object.keys(NEW_LAMPS).map(add))];
  }

  // A single light and an added light are open.
  isLampOpen(index, total) {
    const before = [...this.element.querySelectorAll("details.lamp")];
    return before[index]?.hasAttribute("open") ?? (total === 1 || (before.length > 0 && index === total - 1));
  }

  // The lights of the job. A job whose site or distribution sets them gets those of the current frame.
  ownLights() {
    if (!Array.isArray(this.job.lights)) this.job.lights = structuredClone(this.drawn?.lights ?? []);
    return this.job.lights;
  }

  change(field, value, isDragging = false) {
    if (field.pointer.startsWith("/lights/")) this.ownLights();
    const parent = field.pointer.replace(/\/[^/]*$/, "");
    if (field.base && at(this.job, parent) === undefined) set(this.job, parent, [...field.base]);
    set(this.job, field.pointer, value);
    this.changed(isDragging);
  }

  // Shows each error at its field; returns those without a field here.
  fault(errors) {
    for (const note of this.notes.values()) note.hidden = true;
    return errors.filter((error) => {
      const pointer = [...this.notes.keys()].filter((one) => error.pointer === one || error.pointer?.startsWith(`${one}/`)).at(-1);
      if (pointer === undefined) return true;
      const note = this.notes.get(pointer);
      note.textContent = error.message + (error.did_you_mean ? ` – did you mean ${error.did_you_mean}?` : "");
      note.hidden = false;
      for (let group = note.closest("details"); group; group = group.parentElement.closest("details")) group.open = true;
      return false;
    });
  }
}

// A value in place of a distribution.
function plainValue(value, field) {
  if (!lawOf(value)) return value ?? field.value;
  const first = Object.values(value)[0];
  return Array.isArray(first) ? first[0] : field.value;
}

function tidied(value) {
  return Number(value.toPrecision(3));
}

// The meaning of a field without its limits, which errors name.
function helpOf(about) {
  return about.split("; ")[0];
}
