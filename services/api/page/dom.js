// DOM elements. Every text becomes a text node, so that data is never parsed as markup.

const SVG = "http://www.w3.org/2000/svg";

// h("a.name", {href, onclick, "aria-label"}, child, [children], "text")
export function h(tag, props, ...children) {
  const [name, ...classes] = tag.split(".");
  return fill(document.createElement(name), classes, props, children);
}

export function svg(tag, props, ...children) {
  const [name, ...classes] = tag.split(".");
  return fill(document.createElementNS(SVG, name), classes, props, children);
}

function fill(element, classes, props, children) {
  if (classes.length) element.classList.add(...classes);
  for (const [key, value] of Object.entries(props ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key === "value" || key === "checked" || key === "selected") element[key] = value;
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

export function put(place, ...children) {
  place.replaceChildren(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return place;
}

export function heading(text, ...beside) {
  return h("div.heading", {}, h("h1", { tabindex: "-1" }, text), ...beside);
}

// Text with the parts between backticks as code.
export function prose(text) {
  return text.split("`").map((part, index) => (index % 2 ? h("code", {}, part) : part));
}

// The equivalent API calls and commands.
export function same(...lines) {
  return h("details.same", {}, h("summary", {}, "Without this page"),
    h("pre", { tabindex: "0", role: "group", "aria-label": "Calls and commands" }, lines.filter(Boolean).join("\n")));
}

export function select(label, options, chosen, onchange, props = {}) {
  const items = options.map((option) => {
    const [value, text] = Array.isArray(option) ? option : [option, option];
    return h("option", { value, selected: value === chosen }, text);
  });
  const box = h("select", { "aria-label": label, ...props, onchange: () => onchange(box.value) }, items);
  return h("label.field", {}, h("span", {}, label), box);
}

let columnFields = 0;

// A text field that suggests columns: `columns` is {names, suggest()} as in `numberColumns`, loaded at the first focus. Other names are accepted
// if they exist. `none` is the text for no column. changed(name) is called with each valid choice.
export function columnField(label, columns, /** @type {{ chosen: string, none?: string }} */ { chosen, none }, changed) {
  columnFields += 1;
  const list = h("datalist", { id: `columns-${columnFields}` }, none && h("option", { value: none }));
  let current = chosen || none || "";
  let isLoaded = false;
  const box = h("input.column", { type: "text", list: list.id, value: current, spellcheck: "false", autocomplete: "off", onfocus: async () => {
    // An empty field suggests every column.
    box.placeholder = current;
    box.value = "";
    if (isLoaded) return;
    isLoaded = true;
    const names = await columns.suggest().catch(() => columns.names);
    list.append(...names.map((name) => h("option", { value: name })));
  }, onchange: () => {
    const name = box.value.trim();
    const isNone = none !== undefined && name === none;
    const isKnown = isNone || columns.names.includes(name);
    box.toggleAttribute("aria-invalid", !isKnown && name !== "");
    if (!isKnown || name === current) return;
    current = name;
    changed(isNone ? "" : name);
  }, onblur: () => {
    if (box.value.trim() === "") box.value = current;
  } });
  return h("label.field", {}, h("span", {}, label), box, list);
}

// A table in a region that scrolls; a tall one has a limited height.
export function table(head, rows, /** @type {{ label?: string, isTall?: boolean }} */ props = {}) {
  return h(props.isTall ? "div.scroll.tall" : "div.scroll", { tabindex: "0", role: "region", "aria-label": props.label ?? "Table" },
    h("table", {}, h("thead", {}, h("tr", {}, head.map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, rows.map((row) => h("tr", {}, row.map((cell, at) => at === 0
        ? h("th", { scope: "row" }, cell) : h("td", {}, cell)))))));
}

// An API problem with all its members.
export function problemBox(error) {
  const errors = error.problem?.errors ?? [];
  return h("div.problem", { role: "alert" }, h("strong", {}, error.problem?.title ?? "Error"),
    h("p", {}, error.problem?.detail ?? error.message),
    errors.length > 0 && h("ul", {}, errors.map((one) => h("li", {}, one.message))),
    error.problem?.did_you_mean && h("p", {}, "Did you mean ", h("code", {}, error.problem.did_you_mean), "?"));
}

export function drawn(canvas, width, height) {
  const scale = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  return pen;
}

export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
