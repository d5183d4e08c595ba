// Tables of an image's record.

import { h, table } from "./dom.js";
import { print } from "./exact.js";
import { lawOf } from "./laws.js";
import { instanceColor } from "./picture.js";
import { number } from "./text.js";

const OPTICS_UNITS = { spread_px_per_m: "px/m", spread_offset_px: "px", backscatter_fraction: "" };

// Initially open groups, which differ most between images.
const OPEN_GROUPS = new Set(["job", "labels", "scene", "water"]);

// The parameters in groups with a search field. `job` is the description of the job, if known: its distributions are shown next to the values.
export function parameters(record, fields, job, waters) {
  const groups = Map.groupBy(parameterRows(record, fields, job), (row) => row.group);
  const elements = [...groups].map(([name, rows]) => parameterGroup(name, rows));
  const search = h("input", { type: "search", "aria-label": "Find a parameter", placeholder: "Find a parameter",
    oninput: () => showMatches(elements, search.value.trim().toLowerCase()) });
  const { optics = {} } = record;
  const source = waters?.find((water) => water.name === optics.preset)?.source;
  const coefficients = coefficientRows(optics);
  return [search, elements, source && h("p.quiet", {}, `Water ${optics.preset}: ${source}`), coefficients.length > 0
    && h("details.group", {}, h("summary", {}, `Coefficients of ${optics.preset ?? "the water"} in this frame (R, G, B)`),
      table(["coefficient", "value"], coefficients, { label: "Coefficients" }))];
}

// [{group, name, value, unit, about, distribution}]; a group is the first part of the names, or "job" for names of one part.
function parameterRows(record, fields, job) {
  const known = new Map(fields.map((field) => [field.name.replace(/\([a-z, ]+\)/g, ""), field]));
  const rows = [];
  flatten(record.parameters, "", rows);
  return rows.filter(([name, value]) => value !== "" && !/^(artifacts|metrics)\b/.test(name)).map(([name, value]) => {
    const field = known.get(name.replace(/\[\d+\]/g, "[]"));
    const [first] = name.split(/[.[]/);
    return { group: first === name ? "job" : first, name: first === name ? name : name.slice(first.length).replace(/^\./, ""), value,
      unit: field?.unit, about: field?.about, distribution: distributionAt(job, name) };
  });
}

function parameterGroup(name, rows) {
  const isDrawn = rows.some((row) => row.distribution);
  const cells = rows.map((row) => [h("span", { title: row.about }, row.name), [row.value, row.unit && ` ${row.unit}`],
    ...(isDrawn ? [h("span.quiet.mono", {}, row.distribution)] : [])]);
  return h("details.group", { open: OPEN_GROUPS.has(name), "data-group": name }, h("summary", {}, name, h("span.quiet", {}, ` ${rows.length}`)),
    table(["parameter", "value", ...(isDrawn ? ["distribution"] : [])], cells, { label: `Parameters of ${name}` }));
}

// Shows the rows that contain the text and opens their groups; without a text, all rows and the first groups.
function showMatches(groups, text) {
  for (const group of groups) {
    const name = group.dataset.group;
    let matches = 0;
    for (const row of group.querySelectorAll("tbody tr")) {
      row.hidden = !`${name}.${row.textContent}`.toLowerCase().includes(text);
      matches += row.hidden ? 0 : 1;
    }
    group.hidden = matches === 0;
    group.open = text ? matches > 0 : OPEN_GROUPS.has(name);
  }
}

function coefficientRows(optics) {
  const derived = new Set(optics.derived ?? []);
  const isNumeric = (value) => typeof [value].flat()[0] === "number";
  return Object.entries(optics).filter(([, value]) => isNumeric(value)).map(([name, value]) => [name,
    [[value].flat().map((one) => number(one)).join(", "), ` ${OPTICS_UNITS[name] ?? (name.endsWith("_per_m") ? "1/m" : "")}`,
      derived.has(name) && h("em.quiet", {}, " derived")]]);
}

// The distribution at a parameter or its parent, as text.
function distributionAt(job, name) {
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
  // Long names break after a point.
  const rows = plan.map((stage) => [stage.stage.replaceAll(".", ".\u200b"), [stage.variant, stage.terms ? ` ${stage.terms}` : ""], stage.bound === undefined ? "–"
    : number(stage.bound, 3) + (stage.relative_share ? ` + ${number(100 * stage.relative_share, 2)} %` : ""), stage.share === undefined ? "–" : number(stage.share, 3), stage.cost_ms === undefined ? "–" : number(stage.cost_ms, 3)]);
  const skipped = record.plan.length - plan.length;
  const times = Object.entries(record.timings_ms ?? {}).filter(([name, ms]) => name !== "total" && ms >= 0.05).sort((a, b) => b[1] - a[1]);
  const total = record.timings_ms?.total ?? times.reduce((sum, [, ms]) => sum + ms, 0);
  return [table(["stage", "variant", "bound", "tolerance", "planned ms"], rows, { label: "Plan" }),
    h("p.quiet", {}, `${skipped} stages are skipped. A bound is the largest error in linear light at the output of its stage; a percentage is a share of that light.`),
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
    patch.style.background = `rgb(${instanceColor(one.number).join(" ")})`;
    const button = h("button.link", { type: "button", onclick: () => point(one.number), onfocus: () => point(one.number), onblur: () => point(null),
      onpointerenter: () => point(one.number), onpointerleave: () => point(null) }, patch, `${one.category ?? "object"} ${one.number}`);
    return [button, `${number(one.range_m, 3)} m`, number(one.visibility, 2), one.visible ? "yes" : "no", number(one.pixels)];
  });
  return table(["object", "range", "visibility", "visible", "pixels"], rows, { label: "Objects", isTall: rows.length > 14 });
}

export function provenance(record) {
  const { inputs = {}, ...rest } = record.provenance ?? {};
  const rows = [["rendered", record.created_at], ...Object.entries(rest).map(([name, value]) => [name, number(value)]),
    ...Object.entries(inputs).map(([name, value]) => [name, String(value)]), ...Object.entries(record.counts ?? {}).map(([name, value]) => [name, number(value)])];
  return table(["", ""], rows.map(([name, value]) => [name, h("span.mono", {}, value ?? "–")]), { label: "Provenance" });
}
