// A 2-D histogram of two columns. A selected rectangle becomes a filter.

import { get } from "./api.js";
import { color, columnField, h } from "./dom.js";
import { shade } from "./picture.js";
import { number, path } from "./text.js";

// Maximum and minimum cells along each axis: few images need few cells.
const CELLS = 64;
const FEWEST = 12;

// The panel, with the columns as in `numberColumns`; chosen({column, min, max}, {column, min, max}) is called with the selection.
export function densityPanel(route, { name, images }, columns, chosen) {
  const bins = Math.min(CELLS, Math.max(FEWEST, Math.ceil(Math.sqrt(images))));
  const canvas = h("canvas.density", { width: 320, height: 320, role: "img", "aria-label": "Density" });
  const brush = h("div.brush", { hidden: true });
  const words = h("p.quiet", { role: "status" });
  const choose = (key, label, preset) => columnField(label, columns, { chosen: route.query[key] ?? preset }, (value) => {
    route.set({ [key]: value });
    update();
  });
  const third = columnField("Colored by the mean of", columns, { chosen: route.query.mean ?? "", none: "number of images" }, (value) => {
    route.set({ mean: value });
    update();
  });
  let shown = null;
  async function update() {
    const [x, y] = [route.query.x ?? "alpha", route.query.y ?? "uiqm"];
    try {
      const answer = await get(`/v1/datasets/${path(name)}/density`, { x, y, bins, filter: route.query.filter,
        mean_of: route.query.mean }, route.signal);
      shown = answer;
      paint(canvas, answer);
      const all = answer.counts.reduce((sum, one) => sum + one, 0);
      words.textContent = `${x} → ${number(answer.x.min)} to ${number(answer.x.max)}; ${y} ↑ ${number(answer.y.min)} to `
        + `${number(answer.y.max)}; ${number(all)} images${answer.missing ? `, ${number(answer.missing)} without a value` : ""}`;
      canvas.setAttribute("aria-label", `Density: ${words.textContent}`);
    } catch (error) {
      if (!route.signal.aborted) words.textContent = error.message;
    }
  }
  brushed(canvas, brush, (low, high) => {
    const range = (axis, share) => axis.min + (axis.max - axis.min) * share;
    chosen({ column: shown.x.column, min: range(shown.x, low.x), max: range(shown.x, high.x) },
      { column: shown.y.column, min: range(shown.y, low.y), max: range(shown.y, high.y) });
  });
  const panel = h("details.panel", { open: Boolean(route.query.x) }, h("summary", {}, "Density of two columns"),
    h("div.row", {}, choose("x", "Along", "alpha"), choose("y", "Up", "uiqm"), third), h("div.over", {}, canvas, brush), words);
  panel.addEventListener("toggle", () => panel.open && update());
  return { panel, update: () => panel.open && update() };
}

function paint(canvas, { bins, counts, means }) {
  const pen = canvas.getContext("2d");
  const size = canvas.width / bins;
  pen.fillStyle = color("--sunken");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  const known = means?.filter((value) => value !== null) ?? [];
  const [low, high] = means ? [Math.min(...known), Math.max(...known)] : [0, Math.log1p(Math.max(...counts))];
  counts.forEach((count, at) => {
    if (count === 0) return;
    const value = means ? means[at] : Math.log1p(count);
    if (value === null) return;
    const share = high > low ? (value - low) / (high - low) : 1;
    pen.fillStyle = `rgb(${shade(0.15 + 0.85 * share).join(" ")})`;
    pen.fillRect((at % bins) * size, canvas.height - (Math.floor(at / bins) + 1) * size, size, size);
  });
}

function brushed(canvas, brush, chosen) {
  let from = null;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    const share = (value) => Math.min(1, Math.max(0, value));
    return { x: share((event.clientX - box.left) / box.width), y: share(1 - (event.clientY - box.top) / box.height) };
  };
  const corners = (a, b) => [{ x: Math.min(a.x, b.x), y: Math.min(a.y, b.y) }, { x: Math.max(a.x, b.x), y: Math.max(a.y, b.y) }];
  canvas.addEventListener("pointerdown", (event) => {
    from = place(event);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!from) return;
    const [low, high] = corners(from, place(event));
    brush.hidden = false;
    brush.style.left = `${100 * low.x}%`;
    brush.style.top = `${100 * (1 - high.y)}%`;
    brush.style.width = `${100 * (high.x - low.x)}%`;
    brush.style.height = `${100 * (high.y - low.y)}%`;
  });
  canvas.addEventListener("pointerup", (event) => {
    const [low, high] = corners(from, place(event));
    from = null;
    brush.hidden = true;
    if (high.x - low.x > 0.01 && high.y - low.y > 0.01) chosen(low, high);
  });
}
