// Tables of an image's record.

import { h, table } from "./dom.js";
import { print } from "./exact.js";
import { lawOf } from "./laws.js";
import { codeColor } from "./picture.js";
import { number } from "./text.js";

const OPTICS_UNITS = { spread_px_per_m: "px/m", spread_offset_px: "px", backscatter_fraction: "" };

// job is the description of the job, if known; its distributions are shown next to the values.
export function parameters(record, fields, job, waters) {
  const known = new Map(fields.map((field) => [field.name.replace(/\([a-z]+\)/g, ""), field]));
  const rows = [];
  flatten(record.parameters, "", rows);
  const described = rows.filter(([name]) => !name.startsWith("artifacts") && !name.startsWith("metrics")).map(([name, value]) => {
    const field = known.get(name.replace(/\[\d+\]/g, "[]"));
    return [h("span", { title: field?.about }, name), [value, field?.unit && ` ${field.unit}`], h("span.quiet.mono", {}, lawAt(job, name))];
  });
  const optics = record.optics ?? {};
  const derived = new Set(optics.derived ?? []);
  const water = Object.entries(optics).filter(([, value]) => Array.isArray(value) && typeof value[0] === "number" || typeof value === "number")
    .map(([name, value]) => [name, [[value].flat().map((one) => number(one)).join(", "), ` ${OPTICS_UNITS[name] ?? (name.endsWith("_per_m") ? "1/m" : "")}`,
      derived.has(name) && h("em.quiet", {}, " derived")]]);
  const source = waters?.find((one) => one.name === optics.preset)?.source;
  return [table(["parameter", "value", "law"], described, { label: "Parameters" }), source && h("p.quiet", {}, `Water ${optics.preset}: ${source}`), water.length > 0
    && h("details", {}, h("summary", {}, `Coefficients of ${optics.preset ?? "the water"} in this frame (R, G, B)`),
      table(["coefficient", "value"], water, { label: "Coefficients" }))];
}

// The distribution at a parameter or its parent, as text.
function lawAt(job, name) {
  let place = job;
  for (const key of ["", ...name.split(/[.[\]]+/).filter(Boolean)]) {
    if (key !== "") place = place && typeof place === "object" ? place[key] : undefined;
    if (lawOf(place)) return print(place);
  }
  return "";
}

function flatten(value, name, rows) {
  if (Array.isArray(value) && value.some((one) => one && typeof one === "object")) {
    value.forEach((one, at) => flatten(one, `${name}[${at}]`, rows));
  } else if (value && typeof value === "object" && !Array.isArray(value)) {
    for (const [key, one] of Object.entries(value)) flatten(one, name ? `${name}.${key}` : key, rows);
  } else rows.push([name, [value].flat().map((one) => number(one)).join(", ")]);
}

export function planTable(record) {
  const plan = record.plan.filter((stage) => stage.variant !== "skip");
  const rows = plan.map((stage) => [stage.stage, [stage.variant, stage.terms ? ` ${stage.terms}` : ""], stage.bound === undefined ? "–"
    : number(stage.bound, 3), stage.share === undefined ? "–" : number(stage.share, 3), stage.cost_ms === undefined ? "–" : number(stage.cost_ms, 3)]);
  const skipped = record.plan.length - plan.length;
  const times = Object.entries(record.timings_ms ?? {}).filter(([name, ms]) => name !== "total" && ms >= 0.05).sort((a, b) => b[1] - a[1]);
  const total = record.timings_ms?.total ?? times.reduce((sum, [, ms]) => sum + ms, 0);
  return [table(["stage", "form", "bound", "tolerance", "planned ms"], rows, { label: "Plan" }),
    h("p.quiet", {}, `${skipped} stages are skipped. A bound is the largest error in linear light at the output of its stage.`),
    record.promise ? h("p", {}, record.promise.text) : null,
    record.promise?.exceeds ? h("p.bad", {}, `The plan exceeds the tolerance: ${record.promise.exceeds}.`) : null,
    h("p", {}, `Time ${number(total, 3)} ms:`),
    h("ul.bars", {}, times.map(([name, ms]) => {
      const bar = h("i");
      bar.style.width = `${Math.max(0.5, (100 * ms) / total)}%`;
      return h("li", {}, h("span", {}, name), h("span.track", {}, bar), h("span", {}, `${number(ms, 3)} ms`));
    }))];
}

export function measurements(record) {
  const pictures = Object.keys(record.measurements).sort((a, b) => (a === "rgb" ? -1 : b === "rgb" ? 1 : a.localeCompare(b)));
  if (pictures.length === 0) return h("p.quiet", {}, "None were requested.");
  const names = [...new Set(pictures.flatMap((one) => Object.keys(record.measurements[one])))];
  return table(["metric", ...pictures], names.map((name) => [name, ...pictures.map((one) => number(record.measurements[one][name]))]),
    { label: "Metrics" });
}

// point(number) highlights one object in the image, point(null) all.
export function boxesTable(record, point) {
  const all = record.scene?.instances ?? [];
  if (all.length === 0) return h("p.quiet", {}, "The job requested no labels.");
  const rows = all.map((one) => {
    const patch = h("i.patch");
    patch.style.background = `rgb(${codeColor(one.number).join(" ")})`;
    const button = h("button.link", { type: "button", onclick: () => point(one.number), onfocus: () => point(one.number), onblur: () => point(null),
      onpointerenter: () => point(one.number), onpointerleave: () => point(null) }, patch, `${one.category ?? "object"} ${one.number}`);
    return [button, `${number(one.range_m, 3)} m`, number(one.visibility, 2), one.visible ? "yes" : "no", number(one.pixels)];
  });
  return table(["object", "range", "visibility", "visible", "pixels"], rows, { label: "Objects" });
}

export function provenance(record) {
  const { inputs = {}, ...rest } = record.provenance ?? {};
  const rows = [["rendered", record.created_at], ...Object.entries(rest).map(([name, value]) => [name, number(value)]),
    ...Object.entries(inputs).map(([name, value]) => [name, String(value)]), ...Object.entries(record.counts ?? {}).map(([name, value]) => [name, number(value)])];
  return table(["", ""], rows.map(([name, value]) => [name, h("span.mono", {}, value ?? "–")]), { label: "Provenance" });
}
