// Histograms and curves as SVG with keyboard access.

import { h, put, svg } from "./dom.js";
import { number } from "./text.js";

const WIDTH = 320;
const HEIGHT = 110;

// Bars of a histogram. A drag or two numbers select a range: chosen(low, high).
export function histogram(bins, /** @type {{ chosen?: (min: number, max: number) => void, label: string, other?: any }} */ how) {
  const { chosen, label, other } = how;
  const { edges, counts } = bins;
  const most = Math.max(1, ...counts, ...(other?.counts ?? []));
  const wide = WIDTH / counts.length;
  const bars = (values, name) => values.map((value, at) => {
    const high = value === 0 ? 0 : Math.max(1, (HEIGHT * value) / most);
    return svg(`rect.${name}`, { x: at * wide, y: HEIGHT - high, width: Math.max(0.5, wide - 0.6), height: high },
      svg("title", {}, `${number(edges[at])} to ${number(edges[at + 1])}: ${number(value)}`));
  });
  const brush = svg("rect.brush", { y: 0, height: HEIGHT, width: 0 });
  const all = counts.reduce((sum, one) => sum + one, 0);
  const plot = svg("svg.histogram", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img",
    "aria-label": `Histogram of ${label}: ${number(all)} values from ${number(edges[0])} to ${number(edges.at(-1))}` },
  bars(counts, "bar"), other ? bars(other.counts, "other") : [], brush);
  if (chosen) brushed(plot, brush, (a, b) => chosen(at(edges, a), at(edges, b)));
  return h("div.plot", {}, plot, h("div.ends", {}, h("span", {}, number(edges[0])), h("span", {}, number(edges.at(-1)))));
}

function at(edges, share) {
  return edges[0] + (edges.at(-1) - edges[0]) * share;
}

// Selects part of the width by pointer.
function brushed(plot, brush, chosen) {
  let from = null;
  const share = (event) => {
    const box = plot.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  };
  const mark = (to) => {
    brush.setAttribute("x", Math.min(from, to) * WIDTH);
    brush.setAttribute("width", Math.abs(to - from) * WIDTH);
  };
  plot.addEventListener("pointerdown", (event) => {
    from = share(event);
    plot.setPointerCapture(event.pointerId);
    mark(from);
  });
  plot.addEventListener("pointermove", (event) => from !== null && mark(share(event)));
  plot.addEventListener("pointerup", (event) => {
    const to = share(event);
    const [low, high] = [Math.min(from, to), Math.max(from, to)];
    from = null;
    if (high - low > 0.01) chosen(low, high);
  });
  plot.addEventListener("pointercancel", () => {
    from = null;
    brush.setAttribute("width", 0);
  });
}

// Sizes of a chart in CSS pixels: margins around the plot, limits of its width, and its shape.
const CHART = { left: 58, right: 12, top: 22, bottom: 40, least: 240, most: 640, shape: 0.58, lowest: 190 };
// Least distance of the numbers below a chart, in CSS pixels.
const TICK_PX = 46;
// Distance in CSS pixels within which the pointer selects a mark.
const REACH_PX = 40;

// Round values between two bounds: powers of ten or their simple multiples if `isLog`, otherwise about five equal steps.
export function ticks(low, high, isLog) {
  if (!isLog) {
    const rough = (high - low) / 5;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, index) => (first + index) * step);
  }
  const decades = Math.log10(high / low);
  const factors = decades > 3 ? [1] : decades > 1.3 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 7];
  const values = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1) values.push(...factors.map((factor) => factor * 10 ** power));
  return values.filter((value) => value >= low * 0.999 && value <= high * 1.001);
}

// One axis: {position(value), values}. Positions run from `start` to `end`.
function axis(values, isLog, start, end) {
  const scale = isLog ? Math.log10 : (value) => value;
  const known = values.filter((value) => Number.isFinite(scale(value)));
  let [low, high] = [Math.min(...known), Math.max(...known)];
  if (low === high) [low, high] = isLog ? [low / 2, high * 2] : [low - 0.5, high + 0.5];
  else if (isLog) [low, high] = [low / 1.15, high * 1.15];
  const [from, to] = [scale(low), scale(high)];
  return { position: (value) => start + ((scale(value) - from) / (to - from)) * (end - start), values: ticks(low, high, isLog) };
}

// Curves and marks over common axes: lines are [{name, color, points: [[x, y], …]}], marks are [{name, color, x, y, strong}]. The pointer shows
// the name of the nearest mark, or the values of each line. The chart is drawn for its width, so that its text has the same size everywhere.
export function curves(lines, { label, x, y, log = false, marks = [] }) {
  const readout = h("p.readout", { "aria-hidden": "true" });
  const place = h("div");
  const chart = h("div.chart", {}, place, readout);
  let drawnWidth = 0;
  new ResizeObserver(() => {
    const width = Math.round(Math.min(CHART.most, Math.max(CHART.least, chart.clientWidth)));
    if (width === drawnWidth || chart.clientWidth === 0) return;
    drawnWidth = width;
    put(place, plotOf(lines, { label, x, y, log, marks, width }, readout));
  }).observe(chart);
  return chart;
}

// The chart at a width in CSS pixels.
function plotOf(lines, { label, x, y, log, marks, width }, readout) {
  const { left, right, top, bottom } = CHART;
  const height = Math.max(CHART.lowest, Math.round(CHART.shape * width));
  const all = [...lines.flatMap((line) => line.points), ...marks.map((mark) => [mark.x, mark.y])];
  const across = axis(all.map((point) => point[0]), log, left, width - right);
  const up = axis(all.map((point) => point[1]), log, height - bottom, top);
  const paths = lines.map((line) => svg("polyline.line", { points: line.points.map(([a, b]) => `${across.position(a)},${up.position(b)}`).join(" "),
    class: `line ${line.color}` }, svg("title", {}, line.name)));
  const dots = marks.map((mark) => svg("circle", { cx: across.position(mark.x), cy: up.position(mark.y), r: mark.strong ? 6.5 : 3.6,
    class: `dot ${mark.color}${mark.strong ? " strong" : ""}` }));
  const grid = [...across.values.map((value) => `M${across.position(value)} ${top}V${height - bottom}`), ...up.values.map((value) => `M${left} ${up.position(value)}H${width - right}`)];
  const plot = svg("svg.curves", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": label }, svg("path.grid-lines", { d: grid.join("") }),
    svg("path.axis", { d: `M${left} ${top}V${height - bottom}H${width - right}` }), paths, dots, tickTexts(across, up, height),
    svg("text.title", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, x), svg("text.title", { x: left, y: 12 }, y));
  plot.addEventListener("pointermove", (event) => {
    const box = plot.getBoundingClientRect();
    const scale = box.width / width;
    const pointer = [(event.clientX - box.left) / scale, (event.clientY - box.top) / scale];
    if (marks.length > 0) showNearest(marks, dots, readout, pointer, REACH_PX / scale);
    else showValues(lines, across, readout, pointer[0], x);
  });
  plot.addEventListener("pointerleave", () => {
    readout.textContent = "";
    for (const dot of dots) dot.classList.remove("near");
  });
  return plot;
}

// The numbers of both axes. Those that would touch the previous one are left out.
function tickTexts(across, up, height) {
  let last = -TICK_PX;
  const shown = across.values.filter((value) => {
    const isFree = across.position(value) - last >= TICK_PX;
    if (isFree) last = across.position(value);
    return isFree;
  });
  return [...shown.map((value) => svg("text.tick.x", { x: across.position(value), y: height - CHART.bottom + 15, "text-anchor": "middle" }, number(value, 3))),
    ...up.values.map((value) => svg("text.tick.y", { x: CHART.left - 5, y: up.position(value) + 4, "text-anchor": "end" }, number(value, 3)))];
}

function showNearest(marks, dots, readout, /** @type {number[]} */ [x, y], reach) {
  const distances = dots.map((dot) => Math.hypot(Number(dot.getAttribute("cx")) - x, Number(dot.getAttribute("cy")) - y));
  const nearest = distances.indexOf(Math.min(...distances));
  const isNear = distances[nearest] <= reach;
  dots.forEach((dot, index) => dot.classList.toggle("near", isNear && index === nearest));
  readout.textContent = isNear ? marks[nearest].name : "";
}

function showValues(lines, across, readout, pointer, label) {
  const points = lines.map(({ name, points: all }) => {
    const point = all.reduce((best, one) => (Math.abs(across.position(one[0]) - pointer) < Math.abs(across.position(best[0]) - pointer) ? one : best));
    return { name, point };
  });
  readout.textContent = `${label} ${number(points[0].point[0], 3)}: ${points.map(({ name, point }) => `${name} ${number(point[1], 3)}`).join(", ")}`;
}
