// Cost and error of each variant, and times of the frames of a dataset.

import { get, list, send } from "./api.js";
import { curves } from "./chart.js";
import { h, heading, put, same, select, table } from "./dom.js";
import { shade, textColor } from "./picture.js";
import { count, number, path } from "./text.js";

const SAMPLE = 24;
// Stages that take less are left out.
const LEAST_MS = 0.05;

export async function show(root, route) {
  const chart = h("section.panel");
  const frames = h("section.panel");
  const maps = h("section.panel");
  root.append(heading("Speed and accuracy"), chart, maps, frames, same("fathom plan examples/tour.json --frame 3",
    "cargo run --release -p lab -- experiment chart --out charts", "GET /v1/images/{job}/{frame}"));
  await Promise.all([figures(chart, route), stability(maps, route), ofDataset(frames, route)]);
}

async function figures(place, route) {
  const [text, machine] = await Promise.all([send("/assets/chart.csv", { signal: route.signal }).then((one) => one.text()),
    get("/assets/machine.json", {}, route.signal)]);
  const [head, ...rows] = text.trim().split("\n").map((line) => line.split(","));
  const all = rows.map((row) => Object.fromEntries(head.map((name, at) => [name, row[at]])));
  const stages = [...new Set(all.map((row) => row.stage))];
  const draw = () => {
    const stage = stages.includes(route.query.stage) ? route.query.stage : stages[0];
    const scenes = [...new Set(all.filter((row) => row.stage === stage).map((row) => row.scene))];
    const scene = scenes.includes(route.query.scene) ? route.query.scene : scenes.at(-1);
    const shown = all.filter((row) => row.stage === stage && row.scene === scene && Number(row.error_max) > 0 && Number(row.ms_min) > 0);
    const variants = [...new Set(shown.map((row) => row.variant))];
    const front = shown.filter((row) => row.pareto === "true").sort((a, b) => Number(a.ms_min) - Number(b.ms_min));
    const point = (row) => [Number(row.ms_min), Number(row.error_max)];
    const name = (row) => `${row.variant}${row.terms ? ` ${row.terms}` : ""}: ${number(Number(row.ms_min), 3)} ms, error ${number(Number(row.error_max), 2)}`;
    const marks = shown.map((row) => ({ x: Number(row.ms_min), y: Number(row.error_max), name: name(row), strong: row.default === "true",
      color: `c${variants.indexOf(row.variant) % 8}` }));
    put(place, h("h2", {}, "Error against time"), h("p.quiet", {}, `Left is faster, down is more exact; both axes are logarithmic. A ring marks the `
      + `default, the line joins the best variants. Shipped figures, not of this machine: ${machine.machine}, ${machine.runs} runs of each.`),
    h("div.row", {}, select("Stage", stages, stage, (value) => change({ stage: value })), select("Scene", scenes, scene, (value) => change({ scene: value }))),
    h("div.split.even", {}, h("div", {}, shown.length > 0 ? curves([{ name: "front", color: "front", points: front.map(point) }], { label: `Error against time of ${stage}, ${scene}`,
      x: "time of a 768×492 frame, ms", y: "largest error, linear light (white = 1)", log: true, marks }) : h("p", {}, "All variants are exact."),
    h("p.legend", {}, variants.map((variant, at) => [h(`i.key.c${at % 8}`), variant]))),
    h("details", { open: matchMedia("(min-width: 900px)").matches }, h("summary", {}, "As a table"), table(["variant", "ms", "largest error", "codes", ""], shown.map((row) => [
      `${row.variant} ${row.terms}`, number(Number(row.ms_min), 3), number(Number(row.error_max), 2), row.codes_max,
      [row.default === "true" && "default ", row.pareto === "true" && "front"]]), { label: "Variants", isTall: true }))));
  };
  const change = (values) => {
    route.set(values);
    draw();
  };
  draw();
}

// Failures of enhancements: rows of degradations with increasing strength.
async function stability(place, route) {
  const text = await send("/assets/stability.csv", { signal: route.signal }).then((one) => one.text());
  const [head, ...rows] = text.trim().split("\n").map((line) => line.split(";"));
  const all = rows.map((row) => Object.fromEntries(head.map((name, at) => [name, row[at]])));
  const methods = [...new Set(all.map((row) => row.method))];
  const shows = [["ssim", "change of SSIM"], ["gain", "gain of noise"]];
  const draw = () => {
    const method = methods.includes(route.query.method) ? route.query.method : methods[1];
    const what = route.query.map === "gain" ? "gain" : "ssim";
    const shown = all.filter((row) => row.method === method);
    const worse = shown.filter((row) => Number(row.ssim_after) < Number(row.ssim_before)).length;
    const cell = (row) => {
      const change = Number(row.ssim_after) - Number(row.ssim_before);
      const label = what === "ssim" ? `${change > 0 ? "+" : ""}${change.toFixed(2)}`.replace(/^[-+](0\.00)$/, "$1") : `${row.gain}×`;
      const share = what === "ssim" ? 0.5 - change : Math.log10(Math.max(1, Number(row.gain))) / 2;
      const color = shade(share);
      const td = h("td", { title: `${row.degradation} ${row.value}: SSIM ${row.ssim_before} to ${row.ssim_after}, gain ${row.gain}, failures ${row.failures}` }, label);
      td.style.background = `rgb(${color.join(" ")})`;
      td.style.color = textColor(color);
      return td;
    };
    const kinds = [...new Set(shown.map((row) => row.degradation))];
    put(place, h("h2", {}, "Where enhancements fail"), h("div.row", {}, select("Method", methods, method, (value) => change({ method: value })),
      select("Map", shows, what, (value) => change({ map: value }))),
    h("p.quiet", {}, `${worse} of ${shown.length} cells move the picture away from the clean one on average; bright is worse. Shipped figures of 8 scenes under water, each `
      + "degraded in 8 steps."),
    h("div.wide", { tabindex: "0", role: "region", "aria-label": "Where enhancements fail" }, h("table.map", { "aria-label": `${method}: ${what}` }, kinds.map((kind) => h("tr", {}, h("th", { scope: "row" }, kind),
      shown.filter((row) => row.degradation === kind).map(cell))))));
  };
  const change = (values) => {
    route.set(values);
    draw();
  };
  draw();
}

async function ofDataset(place, route) {
  const datasets = (await list("/v1/datasets", route.signal)).map((set) => set.name);
  if (datasets.length === 0) return put(place, h("h2", {}, "Frames of a dataset"), h("p.quiet", {}, "There are no datasets yet."));
  const draw = async (name) => {
    const page = await get("/v1/images", { dataset: name, limit: SAMPLE, order_by: "-created_ms", fields: "job,frame" }, route.signal);
    const records = await Promise.all(page.items.map((row) => get(`/v1/images/${path(row.job, String(row.frame))}`, {}, route.signal)));
    const stages = new Map();
    const times = new Map();
    for (const record of records) {
      for (const stage of record.plan) {
        if (stage.variant === "skip") continue;
        const key = `${stage.stage} · ${stage.variant}`;
        const one = stages.get(key) ?? { frames: 0, bound: 0, cost: 0 };
        stages.set(key, { frames: one.frames + 1, bound: Math.max(one.bound, stage.bound ?? 0), cost: one.cost + (stage.cost_ms ?? 0) });
      }
      for (const [stage, ms] of Object.entries(record.timings_ms ?? {})) times.set(stage, [...(times.get(stage) ?? []), ms]);
    }
    const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
    const medians = [...times].map(([stage, values]) => ({ stage, ms: median(values) })).filter(({ ms }) => ms >= LEAST_MS).sort((a, b) => b.ms - a.ms);
    put(place, h("h2", {}, "Frames of a dataset"), select("Dataset", datasets, name, (value) => {
      route.set({ dataset: value });
      draw(value);
    }), h("p.quiet", {}, `Of the newest ${count(records.length, "frame")}.`), h("div.split.even", {},
      table(["stage", "median ms"], medians.map(({ stage, ms }) => [stage, number(ms, 3)]), { label: "Time of each stage" }),
      stages.size > 0 && table(["stage and variant", "frames", "largest bound", "planned ms"], [...stages].map(([stage, one]) => [stage, number(one.frames),
        one.bound ? number(one.bound, 3) : "–", number(one.cost / one.frames, 3)]), { label: "Bounds of each stage" })));
  };
  const chosen = route.query.dataset ?? route.query.set;
  return draw(datasets.includes(chosen) ? chosen : datasets[0]);
}
