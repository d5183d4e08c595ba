// A dataset: image grid, filter, and column charts.

import { ProblemError, get, numberColumns } from "./api.js";
import { histogram } from "./chart.js";
import { densityPanel } from "./density.js";
import { columnField, h, heading, put, same, select } from "./dom.js";
import { FilterLine } from "./filter.js";
import { Grid } from "./grid.js";
import { instanceColor, legendOf, picture, pixels } from "./picture.js";
import { bytes, count, number, path, queryOf, quoted } from "./text.js";

const OVERLAYS = [["", "none"], ["semantics", "categories"], ["semantics.visible", "visible categories"], ["findings", "findings"], ["instances", "instances"], ["boxes", "boxes"], ["range", "range"]];

// Size of the grid until the number of images is known.
const FIRST = 100;

export async function show(root, route) {
  const name = route.args[0] ?? "";
  const view = new DatasetView(root, route, name);
  await view.start();
}

class DatasetView {
  constructor(root, route, name) {
    this.root = root;
    this.route = route;
    this.name = name;
    this.counts = h("p.counts", { role: "status" }, "Loading …");
    this.side = h("div.side");
    this.tools = h("div.row.tools");
    this.filterPlace = h("div");
    this.samePlace = h("div");
    this.legend = h("p.legend-line", { role: "status" });
    this.codes = new Set();
    this.grid = new Grid(route.signal, (row) => this.cell(row));
    this.grid.onproblem = (error) => this.fail(error);
    root.append(heading(name, h("nav.beside", { "aria-label": "Of this dataset" }, h("a", { href: `#/compare?a=${path(name)}` }, "Compare"),
      h("a", { href: `#/speed?dataset=${path(name)}` }, "Time and bounds"))), this.filterPlace, this.counts,
    h("div.split", {}, h("div", {}, this.tools, this.legend, this.grid.element), this.side), this.samePlace);
  }

  query() {
    const { filter, order } = this.route.query;
    const fields = ["job", "frame", order?.replace(/^-/, "")].filter(Boolean);
    return { dataset: this.name, filter, order_by: order, fields: fields.join(",") };
  }

  async start() {
    // Load the first images before their number is known.
    this.grid.show(this.query(), FIRST);
    this.info = await get(`/v1/datasets/${path(this.name)}`, {}, this.route.signal);
    this.columns = numberColumns(this.info, this.route.signal);
    this.kinds = this.info.columns.filter((column) => column.name.startsWith("artifacts.")).map((column) => column.name.slice(10));
    this.filter = new FilterLine(this.info.columns, this.route.query.filter ?? "", (text) => {
      this.route.set({ filter: text });
      this.update();
    });
    this.filterPlace.append(this.filter.element);
    this.showTools();
    this.showSide();
    await this.update(true);
  }

  showTools() {
    const order = this.route.query.order ?? "";
    const direction = h("button", { type: "button", "aria-label": "Largest first", "aria-pressed": String(order.startsWith("-")),
      onclick: () => {
        const now = this.route.query.order;
        if (!now) return;
        const isDown = now.startsWith("-");
        this.route.set({ order: isDown ? now.slice(1) : `-${now}` });
        direction.setAttribute("aria-pressed", String(!isDown));
        this.update();
      } }, "↓");
    const there = OVERLAYS.filter(([kind]) => kind === "" || this.kinds.includes(kind));
    put(this.tools, columnField("Order", this.columns, { chosen: order.replace(/^-/, ""), none: "job and frame" }, (value) => {
      this.route.set({ order: value && (direction.getAttribute("aria-pressed") === "true" ? `-${value}` : value) });
      this.update();
    }), direction, there.length > 1 && select("Overlay", there, this.route.query.overlay ?? "", (value) => {
      this.route.set({ overlay: value });
      this.codes.clear();
      this.showLegend();
      this.grid.layOut(true);
    }));
    this.showLegend();
  }

  showSide() {
    this.histogramPlace = h("div");
    const low = h("input", { type: "number", step: "any", "aria-label": "From", placeholder: "from" });
    const high = h("input", { type: "number", step: "any", "aria-label": "To", placeholder: "to" });
    this.density = densityPanel(this.route, this.info, this.columns, (x, y) => this.filter.add([x, y].map(between).join(" and ")));
    put(this.side, h("section.panel", {}, h("h2", {}, "Histogram"), columnField("Column", this.columns, { chosen: this.column() }, (value) => {
      this.route.set({ column: value });
      this.showHistogram();
    }), this.histogramPlace, h("form.row", { onsubmit: (event) => {
      event.preventDefault();
      if (low.value !== "" && high.value !== "") this.filter.add(between({ column: this.column(), min: +low.value, max: +high.value }));
    } }, low, high, h("button", {}, "Filter"))), this.density.panel);
  }

  // Bins along an axis: few images need few bins.
  bins(most) {
    return Math.min(most, Math.max(10, Math.ceil(2 * Math.sqrt(this.info.images))));
  }

  column() {
    return this.route.query.column ?? "uiqm";
  }

  async update(isShown = false) {
    const { filter } = this.route.query;
    this.showSame();
    if (!isShown) this.grid.show(this.query(), FIRST);
    this.density.update();
    const drawn = this.showHistogram();
    try {
      const total = filter ? await this.total(filter) : this.info.images;
      this.filter.fault(null);
      this.grid.resize(total);
      const all = `${count(this.info.images, "image")}, ${bytes(this.info.bytes)}, ${count(this.info.jobs, "job")}`;
      this.counts.textContent = filter ? `${number(total)} of ${all}` : all;
    } catch (error) {
      this.fail(error);
    }
    await drawn;
  }

  async total(filter) {
    const bins = await get(`/v1/datasets/${path(this.name)}/histogram`, { column: "frame", bins: 1, filter }, this.route.signal);
    return bins.counts[0] + bins.below + bins.above + bins.missing;
  }

  async showHistogram() {
    const column = this.column();
    try {
      const bins = await get(`/v1/datasets/${path(this.name)}/histogram`, { column, bins: this.bins(40), filter: this.route.query.filter },
        this.route.signal);
      put(this.histogramPlace, histogram(bins, { label: column, chosen: (min, max) => this.filter.add(between({ column, min, max })) }),
        h("p.quiet", {}, bins.missing ? `${count(bins.missing, "image")} without a value. ` : "", "Drag over the bars to filter."));
    } catch (error) {
      if (!this.route.signal.aborted && !(error instanceof ProblemError)) throw error;
      put(this.histogramPlace);
    }
  }

  fail(error) {
    if (this.route.signal.aborted) return;
    if (error instanceof ProblemError && error.problem.position !== undefined) {
      this.filter?.fault(error.problem);
      this.grid.resize(0);
      this.counts.textContent = "The filter is not valid.";
    } else this.counts.textContent = error.message;
  }

  showSame() {
    const { filter, order } = this.route.query;
    const name = quoted(this.name);
    put(this.samePlace, same(`GET /v1/images${queryOf(this.query())}`,
      `fathom query ${quoted(filter ?? "")} --dataset ${name}${order ? ` --order-by ${quoted(order)}` : ""}`,
      `fathom export ${name}${filter ? ` --filter ${quoted(filter)}` : ""} --kinds ${this.kinds.join(",")} --out ${name}`));
  }

  cell(row) {
    const { order, overlay } = this.route.query;
    const column = order?.replace(/^-/, "");
    const base = `/v1/images/${path(row.job, String(row.frame))}`;
    const from = queryOf({ dataset: this.name, filter: this.route.query.filter, order });
    const link = h("a", { href: `#/image/${path(row.job, String(row.frame))}${from}` }, picture(`${base}/preview`, `Frame ${row.frame}`),
      h("span.caption", {}, column && column !== "frame" ? `${row.frame} · ${number(row[column], 3)}` : String(row.frame)));
    if (overlay) this.overlay(link, base, overlay).catch(() => {});
    return link;
  }

  // The legend of the overlay, with the categories of the images shown so far.
  async showLegend() {
    const kind = this.route.query.overlay;
    const legend = kind ? await legendOf(kind, { codes: [...this.codes].sort((a, b) => a - b) }).catch(() => null) : null;
    if (kind === this.route.query.overlay) put(this.legend, legend);
  }

  noteCodes(kind, codes) {
    const before = this.codes.size;
    for (const code of codes) if (code !== 0) this.codes.add(code);
    if (this.codes.size > before && kind !== "instances") this.showLegend();
  }

  async overlay(link, base, kind) {
    const canvas = h("canvas.overlay", { "aria-hidden": "true" });
    if (kind === "boxes") {
      const record = await get(base, {}, this.route.signal);
      drawBoxes(canvas, record);
    } else {
      const image = await pixels(`${base}/artifacts/${kind}`, kind, "image/png", this.route.signal, true);
      this.noteCodes(kind, image.codes ?? []);
      canvas.width = image.width;
      canvas.height = image.height;
      canvas.getContext("2d").putImageData(image, 0, 0);
      canvas.classList.add("mask");
    }
    link.insertBefore(canvas, link.lastChild);
  }
}

export function drawBoxes(canvas, record, chosen = null) {
  const { width, height } = record.parameters.camera;
  canvas.width = width;
  canvas.height = height;
  const pen = canvas.getContext("2d");
  const shown = record.scene.instances ?? [];
  for (const one of shown) {
    if (chosen !== null && one.number !== chosen) continue;
    const [x0, y0, x1, y1] = one.box;
    pen.lineWidth = Math.max(1.5, width / 250);
    pen.setLineDash(one.visible ? [] : [6, 4]);
    pen.strokeStyle = `rgb(${instanceColor(one.number).join(" ")})`;
    pen.strokeRect(x0 + 0.5, y0 + 0.5, x1 - x0 - 1, y1 - y0 - 1);
  }
}

function between({ column, min, max }) {
  return `${column} between ${Number(min.toPrecision(6))} and ${Number(max.toPrecision(6))}`;
}
