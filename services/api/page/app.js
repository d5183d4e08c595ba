// Routing: the fragment contains the view and its state, so that every state has a link.

import { back } from "./api.js";
import { h, put, problemBox } from "./dom.js";
import { queryOf } from "./text.js";

const VIEWS = {
  "": () => import("./sets.js"),
  compare: () => import("./sets.js"),
  dataset: () => import("./set.js"),
  // The former address of a dataset.
  set: () => import("./set.js"),
  image: () => import("./image.js"),
  jobs: () => import("./jobs.js"),
  compose: () => import("./compose.js"),
  waters: () => import("./waters.js"),
  styles: () => import("./waters.js"),
  scenes: () => import("./waters.js"),
  speed: () => import("./speed.js"),
};

const main = document.getElementById("main");
let current = null;

function parsed() {
  const [path, query = ""] = location.hash.replace(/^#\/?/, "").split("?", 2);
  const [name, ...parts] = path.split("/");
  const args = parts.map((part) => decoded(part));
  return { name, args, query: Object.fromEntries(new URLSearchParams(query)), path };
}

function decoded(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

// The context of a view: its address, and how to change it without a new view.
class Route {
  constructor(place) {
    this.name = place.name;
    this.args = place.args;
    this.query = place.query;
    this.path = place.path;
    this.end = new AbortController();
    this.signal = this.end.signal;
  }

  // Changes part of the state in the address.
  set(values) {
    for (const [key, value] of Object.entries(values)) {
      if (value === undefined || value === null || value === "") delete this.query[key];
      else this.query[key] = String(value);
    }
    const address = `#/${this.path}${queryOf(this.query)}`;
    if (address !== location.hash) history.replaceState(null, "", address);
  }
}

async function show() {
  if (location.hash === "#main") return main.focus();
  current?.end.abort();
  const route = new Route(parsed());
  const isFirst = current === null;
  current = route;
  mark(route.name);
  const root = h("div.view", { "data-view": route.name || "datasets" });
  put(main, root);
  window.scrollTo(0, 0);
  try {
    const load = VIEWS[route.name];
    if (!load) throw new Error(`There is no view “${route.name}”.`);
    const view = await loaded(load, route.signal);
    if (route.signal.aborted) return;
    await view.show(root, route);
  } catch (error) {
    if (route.signal.aborted) return;
    root.append(problemBox(error), h("p", {}, h("a", { href: "#/" }, "To all datasets")));
  }
  const title = root.querySelector("h1");
  document.title = title ? `${title.textContent} · Fathom` : "Fathom";
  if (!isFirst && document.activeElement === document.body) title?.focus({ preventScroll: true });
}

// Loads the module of a view, also after the service was unreachable.
async function loaded(load, signal) {
  try {
    return await load();
  } catch {
    await back(signal);
    return load();
  }
}

function mark(name) {
  const parents = { dataset: "", set: "", image: "", compare: "" };
  const wanted = `#/${parents[name] ?? name}`;
  for (const link of document.querySelectorAll("header nav a")) {
    if (link.getAttribute("href") === wanted) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
}

const KEYS = { d: "#/", j: "#/jobs", c: "#/compose", s: "#/scenes", w: "#/waters", y: "#/styles", p: "#/speed" };
let isGoing = false;

// Shortcuts: "/" focuses the filter, "g" and a letter opens a view, "?" shows all keys.
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || /** @type {HTMLElement} */ (event.target).closest?.("input, textarea, select, dialog")) return;
  if (isGoing && KEYS[event.key]) {
    location.hash = KEYS[event.key];
    event.preventDefault();
  } else if (event.key === "/") {
    const filter = document.getElementById("filter");
    if (filter) {
      filter.focus();
      event.preventDefault();
    }
  } else if (event.key === "?") showKeys();
  isGoing = event.key === "g";
});

function showKeys() {
  /** @type {HTMLDialogElement} */ (document.getElementById("keys")).showModal();
}

document.getElementById("show-keys").addEventListener("click", showKeys);

window.addEventListener("hashchange", show);
await show();
// Preload the other views.
await Promise.allSettled(Object.values(VIEWS).map((load) => load()));
