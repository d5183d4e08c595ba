// Two layers of an image with a divider, moved by pointer or keyboard.

import { drawBoxes } from "./set.js";
import { h, prose, put, select } from "./dom.js";
import { legendOf, pixels } from "./picture.js";
import { path } from "./text.js";

// In the order of the light path; other layers follow.
const ORDER = ["rgb", "rgb_right", "clean", "direct", "forward_scatter", "backscatter", "scattered", "styled", "hazed", "range", "transmittance",
  "semantics", "semantics.visible", "instances", "findings", "normals", "flow", "disparity", "snow_mask"];

export class Layers {
  constructor(route, base, record, about) {
    this.route = route;
    this.base = base;
    this.record = record;
    this.about = about;
    this.files = new Map(record.artifacts.filter((file) => file.media_type !== "application/json").map((file) => [file.kind, file]));
    const rank = (kind) => (ORDER.includes(kind) ? ORDER.indexOf(kind) : ORDER.length);
    const kinds = [...this.files.keys()].sort((a, b) => rank(a) - rank(b));
    this.left = h("canvas", { role: "img" });
    this.right = h("canvas.right", { role: "img" });
    this.boxes = h("canvas.boxes", { "aria-hidden": "true", hidden: !route.query.boxes });
    this.line = h("div.divider", { "aria-hidden": "true" });
    this.stage = h("div.stage", {}, this.left, this.right, this.boxes, this.line);
    this.slider = h("input.wide", { type: "range", min: 0, max: 100, step: 0.5, value: route.query.at ?? 50, "aria-label": "Divider, percent from the left",
      oninput: () => this.move(this.slider.value) });
    this.words = h("p.quiet", { role: "status" });
    const start = { left: route.query.left ?? "rgb", right: route.query.right ?? kinds.find((kind) => kind === "clean") ?? kinds[1] ?? "rgb" };
    const choose = (side, label) => select(label, kinds, start[side], (kind) => {
      this.route.set({ [side]: kind });
      this.draw(side, kind);
    });
    const toggle = h("button", { type: "button", "aria-pressed": String(Boolean(route.query.boxes)), onclick: () => {
      this.boxes.hidden = !this.boxes.hidden;
      toggle.setAttribute("aria-pressed", String(!this.boxes.hidden));
      this.route.set({ boxes: this.boxes.hidden ? "" : 1 });
    } }, "Boxes");
    this.element = h("section.layers", { "aria-label": "Layers" }, h("div.row", {}, choose("left", "Left"), choose("right", "Right"),
      record.scene?.instances?.length ? toggle : null), this.stage, this.slider, this.words);
    this.drag();
    this.move(this.slider.value);
    this.notes = {};
    if (record.scene?.instances) drawBoxes(this.boxes, record);
    this.draw("left", start.left);
    this.draw("right", start.right);
  }

  move(percent) {
    this.right.style.clipPath = `inset(0 0 0 ${percent}%)`;
    this.line.style.left = `${percent}%`;
  }

  drag() {
    const to = (event) => {
      const box = this.stage.getBoundingClientRect();
      this.slider.value = Math.min(100, Math.max(0, (100 * (event.clientX - box.left)) / box.width));
      this.move(this.slider.value);
    };
    this.stage.addEventListener("pointerdown", (event) => {
      this.stage.setPointerCapture(event.pointerId);
      to(event);
    });
    this.stage.addEventListener("pointermove", (event) => event.buttons && to(event));
    this.stage.addEventListener("pointerup", () => this.route.set({ at: this.slider.value }));
    this.slider.addEventListener("change", () => this.route.set({ at: this.slider.value }));
  }

  // Draws the boxes of all objects, or of one.
  point(number) {
    drawBoxes(this.boxes, this.record, number);
    this.boxes.hidden = number === null && !this.route.query.boxes;
  }

  async draw(side, kind) {
    const file = this.files.get(kind);
    const canvas = this[side];
    canvas.setAttribute("aria-label", `Layer ${kind}, ${side}`);
    if (!file) {
      this.notes[side] = `${kind} is not stored`;
      return this.tell();
    }
    canvas.classList.add("waiting");
    try {
      const image = await pixels(`${this.base}/artifacts/${path(kind)}`, kind, file.media_type, this.route.signal);
      canvas.width = image.width;
      canvas.height = image.height;
      this.stage.style.aspectRatio = `${image.width} / ${image.height}`;
      this.stage.style.maxWidth = `calc(70vh * ${image.width / image.height})`;
      canvas.getContext("2d").putImageData(image, 0, 0);
      const legend = await legendOf(kind, image, new Map((this.record.scene?.categories ?? []).map((one) => [one.id, one.name])));
      this.notes[side] = [`${kind}: `, prose(this.about.get(kind) ?? ""), legend && [h("br"), legend]];
    } catch (error) {
      if (this.route.signal.aborted) return undefined;
      this.notes[side] = `${kind}: ${error.message}`;
    }
    canvas.classList.remove("waiting");
    return this.tell();
  }

  tell() {
    put(this.words, h("span", {}, "Left: ", this.notes.left ?? "…"), h("br"), h("span", {}, "Right: ", this.notes.right ?? "…"));
  }
}
