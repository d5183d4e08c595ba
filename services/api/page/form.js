// The form of a job: one control per field. Form and JSON edit the same document.

import { known } from "./api.js";
import { h, put, select } from "./dom.js";
import { isNumber, typed } from "./exact.js";
import { GROUPS, LAMPS, NEW_LAMPS, START, at, put as set } from "./fields.js";
import { lawEditor, lawOf, lawsFor, newLaw } from "./laws.js";
import { number } from "./text.js";

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
    const found = await Promise.all([known("/v1/lists/fields"), ...lists.map(known)]);
    this.sites = (await known("/v1/lists/sites")).map((site) => [site.name, `${site.name}: ${site.about}`]);
    this.about = new Map(found.shift().map((field) => [field.name.replace(/\([a-z]+\)/g, ""), field]));
    this.options = new Map(lists.map((list, index) => [list, found[index].map((one) => one.name)]));
    this.draw();
  }

  // Redraws every control, as after a change of the JSON.
  draw() {
    const active = document.activeElement;
    const holder = /** @type {HTMLElement} */ (active?.closest?.("[data-pointer]"));
    const pointer = holder?.dataset.pointer;
    const open = new Map([...this.element.querySelectorAll("details")].map((one) => [one.dataset.group, one.open]));
    this.notes.clear();
    const groups = GROUPS.map(([title, fields], index) => h("details.panel", { "data-group": title, open: open.get(title) ?? ![1, 2].includes(index) },
      h("summary", {}, title), fields.filter((field) => title === "Job" || this.isShown(field)).map((field) => this.control(field))));
    groups.splice(3, 0, this.lamps(open));
    put(this.element, this.siteSelect(), groups);
    const control = [...this.element.querySelectorAll("[data-pointer]")].find((one) => one.dataset.pointer === pointer);
    control?.querySelector(active.classList.contains("law-kind") ? ".law-kind" : "input, select:not(.law-kind), button")?.focus();
  }

  // With a site the form shows the fields that override the site's.
  isShown(field) {
    return this.job.site === undefined || at(this.job, field.pointer) !== undefined;
  }

  // A site replaces the description, except for dataset, count and seed of the job.
  siteSelect() {
    const { site } = this.job;
    const isOwn = site !== undefined && typeof site !== "string";
    const options = [["", isOwn ? "as in the JSON" : "none"], ...this.sites];
    return select("Site", options, isOwn ? "" : site ?? "", (name) => {
      const { dataset, count, seed } = this.job;
      for (const key of Object.keys(this.job)) delete this.job[key];
      Object.assign(this.job, name ? { site: name } : structuredClone(START), { dataset, count, seed });
      this.draw();
      this.changed(false);
    });
  }

  control(field, label) {
    if (field.below && typeof at(this.job, field.below) !== "object") return null;
    const value = at(this.job, field.pointer);
    const name = field.pointer.slice(1).replaceAll("/", ".").replace(/\.(\d+)/g, "[$1]");
    const about = this.about.get(name.replace(/\[\d+\]/g, "[]").replace(/(position_m)\[\]$/, "$1"));
    const law = lawOf(value);
    const id = `f${field.pointer.replaceAll("/", "-")}`;
    const note = h("p.wrong", { id: `${id}-wrong`, hidden: true });
    this.notes.set(field.pointer, note);
    const laws = lawsFor(field);
    const kind = laws.length > 0 && h("select.law-kind", { "aria-label": `Value or distribution of ${name}`, onchange: (event) => {
      this.change(field, event.target.value === "" ? plain(value, field) : newLaw(event.target.value, field, plain(value, field)));
      this.draw();
    } }, [["", "value"], ...[...new Set([...laws, law].filter(Boolean))].map((one) => [one, one])].map(([key, text]) => h("option",
      { value: key, selected: key === (law ?? "") }, text)));
    const options = field.options ?? this.options.get(field.list) ?? [];
    const editor = law ? lawEditor(law, value, field, options, (next, isNew) => {
      this.change(field, next);
      if (isNew) this.draw();
    }) : this.plain(field, value, id, options);
    return h("div.control", { "data-pointer": field.pointer }, h("div.control-head", {}, h("label", { for: law ? undefined : id, title: about?.about },
      label ?? name, about?.unit && h("span.quiet", {}, ` ${about.unit}`)), kind), editor, note);
  }

  plain(field, value, id, options) {
    if (field.kind === "list") return this.many(field, value ?? [], options);
    if (field.kind === "text") {
      const box = h("input", { id, type: "text", value: value ?? "", oninput: () => this.change(field, box.value || undefined) });
      return box;
    }
    if (field.kind === "choice") {
      const now = typeof value === "string" ? value : value?.preset ?? "";
      const all = [...new Set([now, ...options].filter(Boolean))];
      const box = h("select", { id, onchange: () => this.change(field, box.value || undefined) },
        [...(field.none ? [["", field.none]] : []), ...all.map((one) => [one, one])].map(([key, text]) => h("option",
          { value: key, selected: key === now }, text)));
      return box;
    }
    return this.slider(field, value, id);
  }

  slider(field, value, id) {
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
    const tidy = (one) => (field.whole ? Math.round(one) : Number(one.toPrecision(3)));
    const box = h("input", { type: "number", step: "any", value: now, "aria-label": `${field.pointer.slice(1).replaceAll("/", ".")} as a number`, oninput: () => {
      if (box.value === "") return;
      range.value = to(Number(box.value));
      this.change(field, typed(box.value));
    } });
    const range = h("input", { id, type: "range", min: low, max: high, step: field.whole && !field.log ? 1 : (high - low) / 400, value: to(now),
      "aria-valuetext": number(now), oninput: () => {
        const next = tidy(from(Number(range.value)));
        box.value = next;
        range.setAttribute("aria-valuetext", number(next));
        this.change(field, next, true);
      }, onchange: () => this.changed(false) });
    const away = field.optional && h("button", { type: "button", "aria-label": `Remove ${field.pointer}`, onclick: () => {
      const parent = GROUPS.flatMap(([, fields]) => fields).some((one) => one.below && field.pointer.startsWith(`${one.below}/`));
      set(this.job, parent || field.pointer === "/fidelity/tolerance" ? field.pointer.replace(/\/[^/]*$/, "") : field.pointer, undefined);
      this.changed(false);
      this.draw();
    } }, "×");
    return h("div.slider", {}, range, box, away);
  }

  many(field, value, options) {
    const chosen = new Set(Array.isArray(value) ? value : []);
    return h("div.checks", {}, options.map((one) => h("label", {}, h("input", { type: "checkbox", checked: chosen.has(one), onchange: (event) => {
      if (event.target.checked) chosen.add(one);
      else chosen.delete(one);
      this.change(field, [...chosen]);
    } }), one)));
  }

  lamps(open) {
    const all = at(this.job, "/lights");
    const list = Array.isArray(all) ? all : [];
    const add = (kind) => h("button", { type: "button", onclick: () => {
      set(this.job, "/lights", [...list, structuredClone(NEW_LAMPS[kind])]);
      this.changed(false);
      this.draw();
    } }, `Add ${kind}`);
    return h("details.panel", { "data-group": "Lights", open: open.get("Lights") ?? true }, h("summary", {}, "Lights"),
      list.map((lamp, index) => h("fieldset", {}, h("legend", {}, `lights[${index}] ${lamp.kind ?? ""}`),
        (LAMPS[lamp.kind] ?? []).map((field) => this.control({ ...field, pointer: `/lights/${index}/${field.pointer}` }, field.pointer)),
        h("button", { type: "button", onclick: () => {
          set(this.job, `/lights/${index}`, undefined);
          this.changed(false);
          this.draw();
        } }, "Remove"))),
      h("div.row", {}, Object.keys(NEW_LAMPS).map(add)));
  }

  change(field, value, isDragging = false) {
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
      note.closest("details").open = true;
      return false;
    });
  }
}

// A value in place of a distribution.
function plain(value, field) {
  if (!lawOf(value)) return value ?? field.value;
  const first = Object.values(value)[0];
  return Array.isArray(first) ? first[0] : field.value;
}
