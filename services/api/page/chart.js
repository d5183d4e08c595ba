// Histograms and curves as SVG with keyboard access.

import { h, svg } from "./dom.js";
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

// Curves over a common axis: [{name, color, points: [[x, y], …]}].
export function curves(lines, { label, x, y, log = false, marks = [] }) {
  const [left, top, bottom, width, height] = [46, 20, 26, 420, 222];
  const scale = log ? Math.log10 : (value) => value;
  const all = [...lines.flatMap((line) => line.points), ...marks.map((mark) => [mark.x, mark.y])];
  const range = (axis) => {
    const values = all.map((point) => scale(point[axis])).filter(Number.isFinite);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return low < high ? [low, high] : [low - 0.5, high + 0.5];
  };
  const [[x0, x1], [y0, y1]] = [range(0), range(1)];
  const px = (value) => left + ((scale(value) - x0) / (x1 - x0)) * (width - left - 8);
  const py = (value) => top + (1 - (scale(value) - y0) / (y1 - y0)) * (height - bottom - top);
  const paths = lines.map((line) => svg("polyline.line", { points: line.points.map(([a, b]) => `${px(a)},${py(b)}`).join(" "),
    class: `line ${line.color}` }, svg("title", {}, line.name)));
  const dots = marks.map((mark) => svg("circle", { cx: px(mark.x), cy: py(mark.y), r: mark.strong ? 6 : 3.2,
    class: `dot ${mark.color}${mark.strong ? " strong" : ""}` }, svg("title", {}, mark.name)));
  const unscale = log ? (value) => 10 ** value : (value) => value;
  const texts = [[x0, 0], [(x0 + x1) / 2, 0.5], [x1, 1]].map(([value, place]) => svg("text", { y: height - 12,
    x: left + place * (width - left - 8), "text-anchor": ["start", "middle", "end"][place * 2] }, number(unscale(value), 3)));
  const sides = [[y0, height - bottom], [y1, top + 6]].map(([value, place]) => svg("text", { x: left - 4, y: place, "text-anchor": "end" },
    number(unscale(value), 2)));
  return svg("svg.curves", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label },
    svg("path.axis", { d: `M${left} 6V${height - bottom}H${width - 6}` }), paths, dots, texts, sides,
    svg("text.title", { x: width - 8, y: height - 1, "text-anchor": "end" }, x), svg("text.title", { x: left + 4, y: 12 }, y));
}
