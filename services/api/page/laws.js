// Distributions: editing and drawing.

import { h, svg } from "./dom.js";
import { print, typed } from "./exact.js";
import { number } from "./text.js";

const NAMES = ["uniform", "log_uniform", "int", "normal", "choice", "grid"];

export function lawOf(value) {
  if (!value || typeof value !== "object" || Array.isArray(value)) return null;
  return NAMES.find((name) => name in value) ?? null;
}

// Distributions allowed for a field.
export function lawsFor(field) {
  if (field.noLaw || !["choice", "number"].includes(field.kind)) return [];
  if (field.kind === "choice") return ["choice"];
  return field.whole ? ["int", "choice"] : ["uniform", ...(field.low > 0 ? ["log_uniform"] : []), "normal", "choice"];
}

// A distribution around a value.
export function newLaw(name, field, value) {
  const tidy = (one) => (field.whole ? Math.round(one) : Number(one.toPrecision(3)));
  if (name === "choice" || name === "grid") return { [name]: [value ?? field.value] };
  const [low, high] = [field.low, field.high];
  if (name === "normal") {
    const sd = (high - low) / 8;
    return { normal: [tidy(value ?? (low + high) / 2), tidy(sd)], clip: [low, high] };
  }
  const mean = typeof value === "number" ? value : (low + high) / 2;
  if (name === "log_uniform") return { log_uniform: [tidy(Math.max(low, mean / 2)), tidy(Math.min(high, mean * 2))] };
  const half = (high - low) / 6;
  return { [name]: [tidy(Math.max(low, mean - half)), tidy(Math.min(high, mean + half))] };
}

// A middle value, for a frame that the service has not resolved yet.
export function middle(value) {
  const name = lawOf(value);
  const law = value[name];
  if (name === "choice" || name === "grid") return law[0];
  if (name === "normal") return law[0];
  const [low, high] = law.map(Number);
  if (name === "int") return Math.round((low + high) / 2);
  return name === "log_uniform" ? Math.sqrt(low * high) : (low + high) / 2;
}

// A description with values in place of distributions, from a resolved frame if available.
export function settled(value, resolved) {
  if (lawOf(value)) return resolved === undefined ? settled(middle(value), undefined) : resolved;
  if (Array.isArray(value)) return value.map((one, at) => settled(one, resolved?.[at]));
  if (value && typeof value === "object") {
    return Object.fromEntries(Object.entries(value).map(([key, one]) => [key, settled(one, resolved?.[key])]));
  }
  return value;
}

// Inputs for the numbers of a distribution; changed(law) is called with each change.
export function lawEditor(name, value, field, options, changed) {
  const law = value[name];
  if (name === "choice" || name === "grid") return choices(name, value, field, options, changed);
  const input = (label, number_, give) => {
    const box = h("input", { type: "number", step: "any", value: number_, "aria-label": `${field.pointer} ${label}`,
      oninput: () => box.value !== "" && changed(give(typed(box.value))) });
    return h("label.field", {}, h("span", {}, label), box);
  };
  const pair = (key, labels) => labels.map((label, at) => input(label, value[key][at], (one) => {
    const both = [...value[key]];
    both[at] = one;
    value = { ...value, [key]: both };
    return value;
  }));
  const labels = name === "normal" ? ["mean", "sd"] : ["from", "to"];
  return h("div.row", {}, pair(name, labels), name === "normal" && value.clip && pair("clip", ["lowest", "highest"]), shape(name, value, law));
}

function choices(name, value, field, options, changed) {
  const shown = value[name].map((one) => (typeof one === "string" ? one : print(one))).join(", ");
  const isText = field.kind === "choice";
  const box = h("input", { type: "text", value: shown, "aria-label": `${field.pointer} values`, oninput: () => {
    const parts = box.value.split(",").map((part) => part.trim()).filter(Boolean);
    changed({ ...value, [name]: isText ? parts : parts.map(typed) });
  } });
  const add = isText && options.length > 0 && h("select", { "aria-label": `Add a value to ${field.pointer}`, onchange: (event) => {
    changed({ ...value, [name]: [...new Set([...value[name], event.target.value])] }, true);
  } }, h("option", { value: "" }, "add …"), options.map((one) => h("option", { value: one }, one)));
  return h("div.row.grow", {}, box, add);
}

// A small plot of a distribution's density.
function shape(name, value, exact) {
  const law = exact.map(Number);
  const [a, b] = name === "normal" ? value.clip ?? [law[0] - 3 * law[1], law[0] + 3 * law[1]] : law;
  const density = (x) => {
    if (name === "normal") return Math.exp(-(((x - law[0]) / law[1]) ** 2) / 2);
    return name === "log_uniform" ? a / x : 1;
  };
  const points = Array.from({ length: 41 }, (_, at) => {
    const x = a + ((b - a) * at) / 40;
    return `${2 + at * 2.4},${30 - 26 * density(x)}`;
  });
  return svg("svg.law", { viewBox: "0 0 100 32", role: "img", "aria-label": `${name} from ${number(a)} to ${number(b)}` },
    svg("polygon", { points: `2,30 ${points.join(" ")} 98,30` }));
}
