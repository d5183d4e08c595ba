// The filter line: completion of columns and words, and inline errors.

import { h, put } from "./dom.js";

const WORDS = ["and", "or", "not", "in", "between", "is null", "is not null", "true", "false"];
const KEY = "fathom.filters";

// changed(text) is called with each submitted filter.
export class FilterLine {
  constructor(columns, text, changed) {
    this.names = columns.map((column) => column.name).concat(WORDS);
    this.changed = changed;
    this.chosen = -1;
    this.list = h("ul.completions", { id: "completions", role: "listbox", "aria-label": "Completions", hidden: true });
    this.wrong = h("p.wrong", { id: "filter-wrong", role: "alert", hidden: true });
    this.input = h("input", { id: "filter", type: "text", value: text, spellcheck: "false", autocomplete: "off", role: "combobox",
      placeholder: 'uiqm > 0.5 and water.style in ("muddy")', "aria-label": "Filter", "aria-autocomplete": "list",
      "aria-expanded": "false", "aria-controls": "completions", "aria-describedby": "filter-wrong" });
    this.saved = h("select", { "aria-label": "Saved filters", onchange: () => this.take(this.saved.value) });
    this.element = h("form.filter", { role: "search", onsubmit: (event) => {
      event.preventDefault();
      this.hide();
      this.changed(this.input.value.trim());
    } }, h("div.line", {}, this.input, this.list), h("button.primary", {}, "Filter"),
    h("button", { type: "button", onclick: () => this.take("") }, "Clear"),
    h("button", { type: "button", onclick: () => this.save() }, "Save"), this.saved, this.wrong);
    this.input.addEventListener("input", () => this.complete());
    this.input.addEventListener("blur", () => setTimeout(() => this.hide(), 150));
    this.input.addEventListener("keydown", (event) => this.key(event));
    this.showSaved();
  }

  take(text) {
    this.input.value = text;
    this.changed(text);
  }

  // Adds a condition.
  add(condition) {
    const text = this.input.value.trim();
    this.take(text ? `(${text}) and ${condition}` : condition);
  }

  // The word before the cursor.
  word() {
    const end = this.input.selectionStart;
    const start = end - this.input.value.slice(0, end).match(/[\w.@]*$/)[0].length;
    return { start, end, text: this.input.value.slice(start, end) };
  }

  complete() {
    this.fault(null);
    const { text } = this.word();
    const rank = (name) => (name.startsWith(text) ? 0 : name.includes(text) ? 1 : 2);
    const found = text ? this.names.filter((name) => rank(name) < 2 && name !== text) : [];
    found.sort((a, b) => rank(a) - rank(b) || a.length - b.length);
    this.chosen = -1;
    put(this.list, found.slice(0, 8).map((name, at) => h("li", { role: "option", id: `completion-${at}`, "aria-selected": "false",
      onpointerdown: (event) => {
        event.preventDefault();
        this.insert(name);
      } }, name)));
    this.list.hidden = found.length === 0;
    this.input.setAttribute("aria-expanded", String(found.length > 0));
    this.input.removeAttribute("aria-activedescendant");
  }

  key(event) {
    if (this.list.hidden) return;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const items = [...this.list.children];
    if (step) {
      this.chosen = (this.chosen + step + items.length) % items.length;
      items.forEach((item, at) => item.setAttribute("aria-selected", String(at === this.chosen)));
      this.input.setAttribute("aria-activedescendant", `completion-${this.chosen}`);
    } else if ((event.key === "Enter" || event.key === "Tab") && this.chosen >= 0) {
      this.insert(items[this.chosen].textContent);
    } else if (event.key === "Escape") this.hide();
    else return;
    event.preventDefault();
  }

  insert(name) {
    const { start, end } = this.word();
    this.input.setRangeText(`${name} `, start, end, "end");
    this.hide();
    this.input.focus();
  }

  hide() {
    this.list.hidden = true;
    this.input.setAttribute("aria-expanded", "false");
  }

  // Shows an error at its position, in characters.
  fault(problem) {
    this.input.toggleAttribute("aria-invalid", Boolean(problem));
    this.wrong.hidden = !problem;
    if (!problem) return;
    const text = this.input.value;
    const at = problem.position ?? 0;
    const characters = [...text];
    const word = characters.slice(at).join("").match(/^\S*/)[0];
    put(this.wrong, problem.detail, " ", h("code", {}, characters.slice(Math.max(0, at - 20), at).join(""),
      h("mark", {}, word || "⌷"), characters.slice(at + [...word].length).join("").slice(0, 20)),
    problem.did_you_mean && h("button", { type: "button", onclick: () => {
      const replaced = characters.slice(0, at).join("") + problem.did_you_mean + characters.slice(at + [...word].length).join("");
      this.take(replaced);
    } }, `Use ${problem.did_you_mean}`));
  }

  save() {
    const text = this.input.value.trim();
    if (!text) return;
    localStorage.setItem(KEY, JSON.stringify([...new Set([text, ...saved()])].slice(0, 30)));
    this.showSaved();
  }

  showSaved() {
    const all = saved();
    this.saved.hidden = all.length === 0;
    put(this.saved, h("option", { value: "" }, "Saved filters"), all.map((text) => h("option", { value: text }, text)));
  }
}

function saved() {
  try {
    const all = JSON.parse(localStorage.getItem(KEY));
    return Array.isArray(all) ? all.filter((text) => typeof text === "string") : [];
  } catch {
    return [];
  }
}
