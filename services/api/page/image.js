// One image: its layers with a divider, its record, and its verification.

import { get, known, post, read } from "./api.js";
import { columnField, h, heading, problemBox, prose, put, same } from "./dom.js";
import { print } from "./exact.js";
import { Layers } from "./layers.js";
import { singleScene } from "./live.js";
import { picture } from "./picture.js";
import { boxesTable, measurements, parameters, planTable, provenance } from "./record.js";
import { bytes, number, path, queryOf } from "./text.js";

export async function show(root, route) {
  const [job, frame] = route.args;
  const base = `/v1/images/${path(job ?? "", frame ?? "")}`;
  const [record, info, fields, description, waters] = await Promise.all([get(base, {}, route.signal), known("/v1/lists/artifacts"),
    known("/v1/lists/fields"), get(`/v1/jobs/${path(job ?? "")}/description`, {}, route.signal).catch(() => null), known("/v1/waters").catch(() => [])]);
  const about = new Map(info.map((kind) => [kind.name, kind.about]));
  const copy = await jobOfFrame(record, route.signal);
  const layers = new Layers(route, base, record, about);
  const neighbors = h("nav.beside", { "aria-label": "Neighbors" });
  const verdict = h("div", { "aria-live": "polite" });
  const again = h("button", { type: "button", onclick: () => verify(base, again, verdict, route) }, "Render again and compare");
  root.append(heading(`${record.dataset} · frame ${frame}`, neighbors), layers.element,
    h("div.row", {}, again, h("a", { href: `#/compose?job=${encodeURIComponent(print(copy))}` }, "Open in Compose"),
      h("a", { href: `#/dataset/${path(record.dataset)}` }, "To its dataset"), h("a", { href: `#/jobs/${path(job)}` }, "To its job")), verdict,
    h("div.columns", {}, section("Parameters", parameters(record, fields, description, waters)), section("Plan and time", planTable(record)),
      section("Metrics", measurements(record)), section("Objects", boxesTable(record, (one) => layers.point(one))),
      section("Along a column", await along(record, route)), section("Files", files(record, base, about)),
      section("Provenance", provenance(record))),
    same(`GET ${base}`, `GET ${base}/artifacts/rgb`, `POST ${base}/verify {"rerender": true}`,
      `fathom query 'job == "${job}" and frame == ${frame}' --dataset ${record.dataset}`));
  await showNeighbors(neighbors, record, route);
  root.tabIndex = -1;
  const step = (event) => {
    if (event.target.closest("input, select, textarea, button, [tabindex='0']") || event.ctrlKey || event.metaKey || event.altKey) return;
    const way = { ArrowLeft: "prev", ArrowRight: "next" }[event.key];
    const link = way && neighbors.querySelector(`a[rel=${way}]`);
    if (link) location.hash = link.getAttribute("href");
  };
  document.addEventListener("keydown", step, { signal: route.signal });
}

function section(title, ...content) {
  return h("section.panel", {}, h("h2", {}, title), ...content);
}

// The frame as a separate description. An uploaded scene sets the size of its images, and the field of view if it has a camera.
async function jobOfFrame(record, signal) {
  const { scene, camera } = record.parameters;
  const job = { ...record.parameters, scene: singleScene(scene), count: 1 };
  if (job.scene.kind !== "uploaded") return job;
  const uploaded = await get(`/v1/scenes/${path(job.scene.id)}`, {}, signal).catch(() => null);
  const { width, height, hfov_deg, ...rest } = camera;
  return { ...job, camera: uploaded?.hfov_deg ? rest : { ...rest, hfov_deg } };
}

// The previous and next image in the last view of the dataset.
async function showNeighbors(place, record, route) {
  const { filter, order } = route.query;
  const column = order?.replace(/^-/, "");
  const dataset = route.query.dataset ?? route.query.set ?? record.dataset;
  const link = (row, rel, text) => row && h("a", { rel, href: `#/image/${path(row.job, String(row.frame))}${queryOf({ dataset, filter, order })}` }, text);
  const ask = async (condition, by) => {
    const all = filter ? `(${filter}) and ${condition}` : condition;
    const page = await get("/v1/images", { dataset, filter: all, order_by: by, limit: 1, fields: "job,frame" }, route.signal);
    return page.items[0];
  };
  const value = column ? valueOf(record, column) : record.frame;
  if (typeof value !== "number") return;
  const name = column ?? "frame";
  const own = column ? "" : ` and job == "${record.job}"`;
  const [less, more] = [`${name} < ${value}${own}`, `${name} > ${value}${own}`];
  const isDown = order?.startsWith("-");
  const [before, after] = await Promise.all([ask(isDown ? more : less, isDown ? name : `-${name}`), ask(isDown ? less : more, isDown ? `-${name}` : name)]);
  put(place, link(before, "prev", "← before"), link(after, "next", "after →"));
}

// A column of the record: a parameter, or a metric.
function valueOf(record, column) {
  const metric = record.measurements.rgb?.[column];
  if (metric !== undefined) return metric;
  if (column === "frame") return record.frame;
  return column.split(".").reduce((value, key) => value?.[key], record.parameters);
}

// Images with the adjacent values of a column.
async function along(record, route) {
  const numbers = Object.keys(flat(record.parameters)).concat(Object.keys(record.measurements.rgb ?? {}));
  const place = h("div.strip");
  const chosen = route.query.along ?? Object.keys(record.measurements.rgb ?? {})[0] ?? "alpha";
  const draw = async (column) => {
    const value = valueOf(record, column);
    if (typeof value !== "number") return put(place, h("p.quiet", {}, `This image has no ${column}.`));
    const ask = (sign, by) => get("/v1/images", { dataset: record.dataset, filter: `${column} ${sign} ${value}`, order_by: by, limit: 3,
      fields: `job,frame,${column}` }, route.signal);
    const [less, more] = await Promise.all([ask("<", `-${column}`), ask(">", column)]);
    const shown = (row) => h("a", { href: `#/image/${path(row.job, String(row.frame))}?along=${encodeURIComponent(column)}` },
      picture(`/v1/images/${path(row.job, String(row.frame))}/preview`, `Frame ${row.frame}`), h("span.caption", {}, number(row[column], 4)));
    return put(place, less.items.reverse().map(shown), h("strong.here", {}, `this image: ${number(value)}`), more.items.map(shown));
  };
  await draw(chosen).catch((error) => put(place, h("p.quiet", {}, error.message)));
  return h("div", {}, columnField("Column", { names: numbers, suggest: async () => numbers }, { chosen }, (column) => {
    route.set({ along: column });
    draw(column).catch((error) => put(place, h("p.quiet", {}, error.message)));
  }), place);
}

// Numbers of the description by column name.
function flat(value, name = "", found = {}) {
  if (typeof value === "number") found[name] = value;
  else if (value && typeof value === "object" && !Array.isArray(value)) {
    for (const [key, one] of Object.entries(value)) flat(one, name ? `${name}.${key}` : key, found);
  }
  return found;
}

function files(record, base, about) {
  return h("ul.plain", {}, record.artifacts.map((file) => h("li", {}, h("a", { href: `${base}/artifacts/${path(file.kind)}`, download: "" },
    file.kind), ` ${bytes(file.bytes)} `, h("span.quiet", {}, prose(about.get(file.kind) ?? "")))));
}

async function verify(base, button, place, route) {
  button.disabled = true;
  put(place, h("p", {}, "Rendering again …"));
  try {
    const found = await read(await post(`${base}/verify`, { rerender: true }, { signal: route.signal }));
    const kinds = found.artifacts.map((one) => h("li", {}, one.kind, ": stored ", one.stored, one.largest_difference !== null
      && `, largest difference ${number(one.largest_difference)}`, one.rerendered_digest === one.digest && ", the same bytes again"));
    put(place, h("div.note", {}, h("strong", { class: found.intact && found.reproduced ? "good" : "bad" }, found.reproduced
      ? "The bytes are the same." : "The bytes differ."), found.intact ? "" : " Stored bytes are damaged.",
    h("ul", {}, kinds, found.differences.map((one) => h("li", {}, one)))));
  } catch (error) {
    if (!route.signal.aborted) put(place, problemBox(error));
  }
  button.disabled = false;
}
