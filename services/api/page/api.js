// API client: token, problems, and retries while the service is unreachable.

import { parse, print } from "./exact.js";
import { queryOf } from "./text.js";

// sessionStorage keeps the token when the tab is reloaded and forgets it when the tab is closed.
const TOKEN_KEY = "fathom.token";
let token = sessionStorage.getItem(TOKEN_KEY);
let asking = null;
let waiting = null;

export class ProblemError extends Error {
  constructor(status, problem) {
    super(problem.detail ?? problem.title ?? `status ${status}`);
    this.status = status;
    this.problem = problem;
  }
}

export function hasToken() {
  return token !== null;
}

function headers(more) {
  return token === null ? more : { ...more, authorization: `Bearer ${token}` };
}

// Sends a request. Reads are retried when the connection returns; writes are not.
export async function send(path, options = {}) {
  for (;;) {
    let response;
    const used = token;
    try {
      response = await fetch(path, { ...options, headers: headers(options.headers ?? {}) });
    } catch (error) {
      if (options.signal?.aborted || error.name === "AbortError") throw error;
      await back(options.signal);
      if (options.method && options.method !== "GET") throw new Error("the connection was lost; the service is back");
      continue;
    }
    if (response.status === 401) {
      const problem = await problemOf(response);
      // Another request may have got a new token meanwhile.
      if (used === token) {
        sessionStorage.removeItem(TOKEN_KEY);
        await askToken(problem);
      }
      continue;
    }
    if ((response.status === 503 || response.status === 429) && !options.method) {
      await pause(1000 * (Number(response.headers.get("retry-after")) || 1), options.signal);
      continue;
    }
    if (!response.ok) throw new ProblemError(response.status, await problemOf(response));
    return response;
  }
}

async function problemOf(response) {
  return read(response).catch(() => ({ title: `status ${response.status}` }));
}

// The JSON of a response.
export async function read(response) {
  return parse(await response.text());
}

export async function get(path, query = {}, signal = undefined) {
  return read(await send(path + queryOf(query), { signal }));
}

export async function post(path, body, /** @type {{ signal?: AbortSignal, accept?: string, method?: string, prefer?: string }} */ how = {}) {
  const { signal, accept, method = "POST", prefer } = how;
  const all = { accept: accept ?? "application/json" };
  if (body !== undefined) all["content-type"] = "application/json";
  if (prefer) all.prefer = prefer;
  const text = body === undefined || typeof body === "string" ? body : print(body);
  return send(path, { method, headers: all, body: text, signal });
}

export async function binary(path, signal) {
  return (await send(path, { signal })).arrayBuffer();
}

// All items of a list.
export async function list(path, signal) {
  const items = [];
  let cursor;
  do {
    const page = await get(path, { cursor }, signal);
    items.push(...page.items);
    cursor = page.next_cursor;
  } while (cursor);
  return items;
}

const kept = new Map();
// A list that is constant while the service runs.
export function known(path) {
  if (!kept.has(path)) {
    const asked = list(path);
    kept.set(path, asked);
    asked.catch(() => kept.delete(path));
  }
  return kept.get(path);
}

// Images whose values show which columns of a dataset are in use.
const SAMPLE = 12;

// The number columns of a dataset: all `names`, and `suggest()` for those with a value in one of its first or newest images.
export function numberColumns({ name, columns }, signal) {
  const names = columns.filter((column) => column.kind === "number").map((column) => column.name);
  let found = null;
  const load = async () => {
    const query = { dataset: name, limit: SAMPLE, fields: names.join(",") };
    const pages = await Promise.all(["", "-created_ms"].map((order_by) => get("/v1/images", { ...query, order_by }, signal)));
    const used = new Set(pages.flatMap(({ items }) => items.flatMap((row) => Object.keys(row).filter((key) => row[key] !== null))));
    return names.filter((column) => used.has(column));
  };
  return { names, suggest: () => (found ??= load()) };
}

// Lines of JSON.
export async function lines(path, signal) {
  const text = await (await send(path, { signal })).text();
  return text.split("\n").filter(Boolean).map((line) => parse(line));
}

// Server-sent events until the job ends. EventSource cannot send a token.
export async function follow(path, signal, tell) {
  let last = null;
  while (!signal.aborted) {
    try {
      const response = await send(path, { signal, headers: last ? { "last-event-id": last } : {} });
      if (response.status === 204) return;
      for await (const event of events(response.body)) {
        if (event.id) last = event.id;
        if (event.event) tell(event.event, parse(event.data));
      }
    } catch (error) {
      if (signal.aborted || error instanceof ProblemError) return;
      await back(signal);
    }
    await pause(500, signal);
  }
}

async function* events(body) {
  const decoder = new TextDecoder();
  let text = "";
  const reader = body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    text += decoder.decode(value, { stream: true }).replaceAll("\r", "");
    const blocks = text.split("\n\n");
    text = blocks.pop();
    for (const block of blocks) {
      const event = {};
      for (const line of block.split("\n")) {
        const at = line.indexOf(":");
        if (at > 0) event[line.slice(0, at)] = line.slice(at + 1).trim();
      }
      yield event;
    }
  }
}

export function pause(ms, signal) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, ms);
    signal?.addEventListener("abort", () => {
      clearTimeout(timer);
      reject(signal.reason);
    });
  });
}

// Waits until the service responds, and shows a notice meanwhile.
export async function back(signal) {
  waiting ??= untilBack().finally(() => { waiting = null; });
  await waiting;
  signal?.throwIfAborted();
}

async function untilBack() {
  const note = document.getElementById("gone");
  note.textContent = "The service does not respond. This page continues as soon as it does.";
  note.hidden = false;
  for (;;) {
    await pause(1000);
    const alive = await fetch("/livez").then((response) => response.ok, () => false);
    if (alive) break;
  }
  note.hidden = true;
}

function askToken(problem) {
  asking ??= new Promise((resolve) => {
    const dialog = /** @type {HTMLDialogElement} */ (document.getElementById("token"));
    document.getElementById("token-why").textContent = token === null
      ? "Its operator has set FATHOM_TOKEN." : `The last token was rejected: ${problem.detail}.`;
    const form = dialog.querySelector("form");
    form.reset();
    form.onsubmit = () => {
      token = form.querySelector("input").value;
      sessionStorage.setItem(TOKEN_KEY, token);
      form.reset();
      asking = null;
      resolve();
    };
    dialog.oncancel = (event) => event.preventDefault();
    dialog.showModal();
  });
  return asking;
}
