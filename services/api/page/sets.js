// All datasets as cards, and a comparison of two.

import { get, list, numberColumns } from "./api.js";
import { histogram } from "./chart.js";
import { columnField, h, heading, put, same, select, table } from "./dom.js";
import { picture } from "./picture.js";
import { bytes, count, number, path } from "./text.js";

const TILES = 6;

export async function show(root, route) {
  if (route.name === "compare") return compare(root, route);
  const place = h("div.cards", { "aria-busy": "true" }, Array.from({ length: 3 }, () => h("div.card.waiting")));
  const search = h("input", { id: "filter", type: "search", "aria-label": "Find a dataset", placeholder: "Find a dataset" });
  root.append(heading("Datasets", search), place, same("GET /v1/datasets", "fathom datasets"));
  const [datasets, jobs] = await Promise.all([list("/v1/datasets", route.signal), list("/v1/jobs", route.signal)]);
  const draw = () => {
    const found = datasets.filter((dataset) => dataset.name.includes(search.value.trim()));
    put(place, found.map((dataset) => card(dataset, jobs, route)));
    if (datasets.length === 0) put(place, empty());
    else if (found.length === 0) put(place, h("p", {}, "No dataset matches this name."));
  };
  search.addEventListener("input", draw);
  place.removeAttribute("aria-busy");
  draw();
  return undefined;
}

function empty() {
  return h("div.empty", {}, h("h2", {}, "There are no images yet"),
    h("p", {}, h("a", { href: "#/compose" }, "Compose a job"), " and watch its first frame change while you do, or start with a site:"),
    h("pre", { tabindex: "0", role: "group", "aria-label": "Commands" }, "fathom new shaft > shaft.json\nfathom submit shaft.json --wait"));
}

function card(dataset, jobs, route) {
  const ours = jobs.filter((job) => job.dataset === dataset.name);
  const failed = ours.reduce((sum, job) => sum + job.failed, 0);
  const open = ours.filter((job) => ["queued", "running", "paused"].includes(job.state));
  const rate = rateOf(ours);
  const mosaic = h("div.mosaic", { "aria-hidden": "true" });
  fillMosaic(mosaic, dataset, route);
  return h("article.card", {}, mosaic, h("h2", {}, h("a", { href: `#/dataset/${path(dataset.name)}` }, dataset.name)),
    h("p", {}, `${count(dataset.images, "image")} · ${bytes(dataset.bytes)} · ${count(dataset.jobs, "job")}`),
    h("p.quiet", {}, rate ? `last job ${number(rate, 3)} frames/s` : "",
      open.length > 0 && h("a", { href: `#/jobs/${path(open[0].id)}` }, ` ${count(open.length, "open job")}`),
      failed > 0 && h("span.bad", {}, ` ${count(failed, "frame")} failed`)));
}

function rateOf(jobs) {
  const job = jobs.find((one) => one.started_at && one.finished_at && one.done > 1);
  const seconds = job && (Date.parse(job.finished_at) - Date.parse(job.started_at)) / 1000;
  return seconds > 0 ? job.done / seconds : null;
}

async function fillMosaic(mosaic, dataset, route) {
  try {
    const page = await get("/v1/images", { dataset: dataset.name, limit: TILES, fields: "job,frame" }, route.signal);
    put(mosaic, page.items.map((row) => picture(`/v1/images/${path(row.job, String(row.frame))}/preview`, "")));
  } catch {
    mosaic.classList.add("missing");
  }
}

async function compare(root, route) {
  const datasets = (await list("/v1/datasets", route.signal)).map((dataset) => dataset.name);
  if (datasets.length === 0) return root.append(heading("Two datasets"), empty(), same("GET /v1/datasets"));
  const a = route.query.a ?? datasets[0];
  const b = route.query.b ?? datasets.find((name) => name !== a) ?? a;
  const place = h("div");
  root.append(heading("Two datasets"), h("div.row.above", {}, select("First", datasets, a, (value) => change({ a: value })),
    select("Second", datasets, b, (value) => change({ b: value })), h("span.legend", {}, h("i.bar"), "first ", h("i.other"), "second")), place);
  const state = { a, b };
  async function change(values) {
    Object.assign(state, values);
    route.set(state);
    await draw();
  }
  async function draw() {
    const names = [state.a, state.b];
    const infos = await Promise.all(names.map((name) => get(`/v1/datasets/${path(name)}`, {}, route.signal)));
    const metrics = ["uiqm", "uciqe", "uicm", "uism", "uiconm", "entropy", "psnr", "ssim"];
    const asked = names.map((name) => get(`/v1/datasets/${path(name)}/stats`, { metrics: metrics.join(",") }, route.signal));
    const stats = (await Promise.all(asked)).map((answer) => answer.groups);
    const columns = numberColumns(infos[0], route.signal);
    const column = route.query.column ?? "uiqm";
    const plot = h("div");
    const value = (at, metric) => {
      const one = stats[at].find((row) => row.metric === metric);
      return one?.count ? `${number(one.mean)} ± ${number(one.sd, 3)}` : "–";
    };
    put(place, h("div.split", {}, table(["", state.a, state.b], [
      ["images", ...infos.map((info) => number(info.images))], ["bytes", ...infos.map((info) => bytes(info.bytes))],
      ...metrics.map((metric) => [metric, value(0, metric), value(1, metric)]).filter(([, ...both]) => both.some((one) => one !== "–"))], { label: "Both datasets" }),
    h("section.panel", {}, columnField("Column", columns, { chosen: column }, (name) => {
      route.set({ column: name });
      draw();
    }), plot)), same(...names.map((name) => `GET /v1/datasets/${name}/stats?metrics=${metrics.join(",")}`),
      `fathom stats ${names.join(" ")}`));
    await drawBoth(plot, names, column, route);
  }
  return draw();
}

async function drawBoth(plot, names, column, route) {
  const ask = (name, more) => get(`/v1/datasets/${path(name)}/histogram`, { column, bins: 40, ...more }, route.signal);
  const own = await Promise.all(names.map((name) => ask(name, {})));
  const known = own.filter((bins) => bins.counts.some((one) => one > 0));
  if (known.length === 0) return put(plot, h("p.quiet", {}, `Neither dataset has values of ${column}.`));
  const min = Math.min(...known.map((bins) => bins.edges[0]));
  const max = Math.max(...known.map((bins) => bins.edges.at(-1)));
  const [a, b] = await Promise.all(names.map((name) => ask(name, { min, max })));
  return put(plot, histogram(a, { label: `${column} of ${names[0]} and ${names[1]}`, other: b }));
}
