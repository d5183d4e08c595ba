// A virtual grid of thumbnails: only visible ones exist, and only nearby pages are loaded.

import { get } from "./api.js";
import { h, put } from "./dom.js";

const PAGE = 100;
const MOST_PAGES = 80;
// The maximum element height of browsers.
const TALLEST = 15_000_000;

export class Grid {
  // cell(row) creates the content of a row; query has the parameters of /v1/images without limit and cursor.
  constructor(signal, cell) {
    this.signal = signal;
    this.cell = cell;
    this.cells = new Map();
    this.onproblem = null;
    this.space = h("ul.cells", { role: "list" });
    this.element = h("div.grid", { role: "region", "aria-label": "Images", tabindex: "0" }, this.space);
    this.element.addEventListener("scroll", () => this.layOut(), { passive: true });
    this.element.addEventListener("keydown", (event) => this.key(event));
    const watch = new ResizeObserver(() => this.layOut(true));
    watch.observe(this.element);
    signal.addEventListener("abort", () => watch.disconnect());
  }

  // Shows the images of a query.
  show(query, total) {
    this.asked?.abort();
    this.asked = new AbortController();
    const stop = this.asked;
    this.signal.addEventListener("abort", () => stop.abort(), { once: true });
    this.query = query;
    this.total = total;
    this.pages = new Map();
    this.walking = null;
    this.element.scrollTop = 0;
    this.layOut(true);
  }

  resize(total) {
    this.total = total;
    this.layOut(true);
  }

  layOut(isNew = false) {
    if (!this.query) return;
    const width = this.element.clientWidth - 8;
    if (isNew) {
      this.columns = Math.max(2, Math.floor(width / 168));
      this.side = width / this.columns;
      this.high = Math.round(this.side * 0.66 + 24);
      const rows = Math.ceil(this.total / this.columns);
      this.tall = rows * this.high;
      // The end of the scroll bar is the end of the rows.
      const view = this.element.clientHeight;
      this.squeeze = this.tall > TALLEST ? (this.tall - view) / (TALLEST - view) : 1;
      this.space.style.height = `${Math.min(this.tall, TALLEST)}px`;
      this.clear();
    }
    // Beyond the maximum height a step of the scroll bar covers several rows; rows keep their size.
    const shift = this.element.scrollTop * (this.squeeze - 1);
    const top = this.element.scrollTop * this.squeeze;
    const from = Math.max(0, Math.floor(top / this.high) - 1) * this.columns;
    const to = Math.min(this.total, (Math.ceil((top + this.element.clientHeight) / this.high) + 1) * this.columns);
    for (const [at, cell] of this.cells) {
      if (at < from || at >= to) {
        cell.remove();
        this.cells.delete(at);
      }
    }
    for (let at = from; at < to; at += 1) this.place(at, shift);
    this.want(Math.floor(from / PAGE), Math.floor(Math.max(from, to - 1) / PAGE));
  }

  clear() {
    this.cells.clear();
    put(this.space);
  }

  place(at, shift) {
    let cell = this.cells.get(at);
    if (!cell) {
      cell = h("li.cell.waiting", { "data-at": at });
      this.cells.set(at, cell);
      this.space.append(cell);
      this.fill(at, cell);
    }
    cell.style.width = `${this.side - 6}px`;
    cell.style.height = `${this.high - 6}px`;
    cell.style.transform = `translate(${(at % this.columns) * this.side}px, ${Math.floor(at / this.columns) * this.high - shift}px)`;
  }

  fill(at, cell) {
    const row = this.pages.get(Math.floor(at / PAGE))?.[at % PAGE];
    if (!row || !cell.classList.contains("waiting")) return;
    cell.classList.remove("waiting");
    cell.setAttribute("aria-setsize", this.total);
    cell.setAttribute("aria-posinset", at + 1);
    put(cell, this.cell(row, at));
  }

  // Loads the visible pages, one at a time; the latest request wins.
  async want(first, last) {
    this.wish = { first, last };
    if (this.walking) return;
    const stop = this.asked;
    this.walking = stop;
    try {
      for (;;) {
        const { first: a, last: b } = this.wish;
        const missing = [...Array(b - a + 1).keys()].map((step) => a + step).find((page) => page * PAGE < this.total && !this.pages.has(page));
        if (missing === undefined) break;
        await this.load(missing, stop.signal);
      }
    } catch (error) {
      if (!stop.signal.aborted) this.onproblem?.(error);
    } finally {
      if (this.walking === stop) this.walking = null;
    }
  }

  async load(page, signal) {
    const answer = await get("/v1/images", { ...this.query, limit: PAGE, offset: page * PAGE }, signal);
    this.pages.set(page, answer.items);
    if (!answer.next_cursor) this.end(page * PAGE + answer.items.length);
    if (this.pages.size > MOST_PAGES) this.pages.delete(this.pages.keys().next().value);
    for (const [at, cell] of this.cells) this.fill(at, cell);
  }

  // There are fewer rows than reported.
  end(total) {
    if (total < this.total) this.resize(total);
  }

  key(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: this.columns, ArrowUp: -this.columns }[event.key];
    const cell = event.target.closest("li.cell");
    if (!step || event.altKey || (!cell && event.target !== this.element)) return;
    event.preventDefault();
    const at = cell ? Number(cell.dataset.at) + step : Math.floor(this.element.scrollTop * this.squeeze / this.high) * this.columns;
    if (at < 0 || at >= this.total) return;
    const top = Math.floor(at / this.columns) * this.high;
    const view = this.element.scrollTop * this.squeeze;
    if (top < view) this.element.scrollTop = top / this.squeeze;
    else if (top + this.high > view + this.element.clientHeight) this.element.scrollTop = (top + this.high - this.element.clientHeight) / this.squeeze;
    this.layOut();
    this.cells.get(at)?.querySelector("a")?.focus({ preventScroll: true });
  }
}
