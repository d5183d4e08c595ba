// Decodes images and layers: thumbnails, 16-bit PNG, NPY, and the colors of ranges and masks.

import { binary, hasToken, known, send } from "./api.js";
import { h } from "./dom.js";

// An image of the service. An img element can neither send a token nor wait for a busy service.
export function picture(path, alt, props = {}) {
  const image = h("img", { alt, decoding: "async", ...props });
  if (hasToken()) {
    load(image, path);
  } else {
    image.onerror = () => load(image, path);
    image.src = path;
  }
  return image;
}

async function load(image, path) {
  image.onerror = () => image.classList.add("missing");
  try {
    const response = await send(path);
    const address = URL.createObjectURL(await response.blob());
    image.onload = () => URL.revokeObjectURL(address);
    image.src = address;
  } catch {
    image.classList.add("missing");
  }
}

// Kinds whose pixels are numbers of categories, bits of findings or numbers of objects.
const CODE_COLORS = new Map([["instances", instanceColor], ["semantics", categoryColor], ["semantics.visible", categoryColor], ["findings", findingColor]]);

// A file in the format of its kind as ImageData. The background of an overlay is transparent.
/** @returns {Promise<ImageData & { codes?: number[], nearM?: number, farM?: number }>} */
export async function pixels(path, kind, mediaType, signal, isOverlay = false) {
  const data = await binary(path, signal);
  if (mediaType === "application/x-npy") return ofArray(readNpy(data), kind);
  if (kind === "range") return ofRange(await readPng16(data));
  const color = CODE_COLORS.get(kind);
  return color ? ofCodes(await readCodes(data, mediaType), color, isOverlay) : readPicture(data, mediaType);
}

// The numbers of a mask of 8 or 16 bits: {width, height, values}.
async function readCodes(data, mediaType) {
  if (new DataView(data).getUint8(24) === 16) return readPng16(data);
  const { width, height, data: channels } = await readPicture(data, mediaType);
  return { width, height, values: Uint8Array.from({ length: width * height }, (_, index) => channels[4 * index]) };
}

async function readPicture(data, mediaType) {
  const bitmap = await createImageBitmap(new Blob([data], { type: mediaType }), { colorSpaceConversion: "none" });
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  pen.drawImage(bitmap, 0, 0);
  return pen.getImageData(0, 0, bitmap.width, bitmap.height);
}

// NPY 1.0 of float32: {shape, values}.
export function readNpy(data) {
  const view = new DataView(data);
  const length = view.getUint16(8, true);
  const head = new TextDecoder("latin1").decode(data.slice(10, 10 + length));
  const shape = head.match(/\(([^)]*)\)/)[1].split(",").map(Number).filter(Boolean);
  if (!head.includes("<f4")) throw new Error(`the array is not float32: ${head.trim()}`);
  return { shape, values: new Float32Array(data.slice(10 + length)) };
}

function ofArray({ shape, values }, kind) {
  const [height, width, channels = 1] = shape;
  const image = new ImageData(width, height);
  // Motions of up to 32 px to either side.
  const motion = (v) => 127.5 + 4 * v;
  const code = { normals: (v) => 127.5 * (v + 1), transmittance: (v) => 255 * v, flow: motion, disparity: motion }[kind] ?? encoded;
  for (let at = 0; at < width * height; at += 1) {
    for (let c = 0; c < 3; c += 1) image.data[4 * at + c] = code(values[at * channels + Math.min(c, channels - 1)]);
    image.data[4 * at + 3] = 255;
  }
  return image;
}

// Linear light to sRGB code.
function encoded(value) {
  return 255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);
}

// The share of an sRGB code in linear light, both in 0..1.
function decoded(code) {
  return code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4;
}

// A color of shares, linear or display-encoded, as `#rrggbb`.
export function toHex(color, isLinear) {
  return `#${color.map((share) => Math.round(Math.min(255, isLinear ? encoded(share) : 255 * share)).toString(16).padStart(2, "0")).join("")}`;
}

export function fromHex(text, isLinear) {
  return [1, 3, 5].map((start) => {
    const code = parseInt(text.slice(start, start + 2), 16) / 255;
    return Number((isLinear ? decoded(code) : code).toFixed(3));
  });
}

// A 16-bit gray PNG, not interlaced: {width, height, values}. A canvas only keeps 8 bits.
export async function readPng16(data) {
  const view = new DataView(data);
  const parts = [];
  let width = 0;
  let height = 0;
  for (let at = 8; at + 8 <= data.byteLength;) {
    const length = view.getUint32(at);
    const name = view.getUint32(at + 4);
    if (name === 0x49484452) {
      [width, height] = [view.getUint32(at + 8), view.getUint32(at + 12)];
      if (view.getUint8(at + 16) !== 16 || view.getUint8(at + 17) !== 0) throw new Error("the PNG is not gray with 16 bits");
    } else if (name === 0x49444154) parts.push(new Uint8Array(data, at + 8, length));
    at += 12 + length;
  }
  const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream("deflate"));
  const raw = new Uint8Array(await new Response(stream).arrayBuffer());
  return { width, height, values: unfiltered(raw, width, height) };
}

function unfiltered(raw, width, height) {
  const row = 2 * width;
  const values = new Uint16Array(width * height);
  let above = new Uint8Array(row);
  for (let y = 0; y < height; y += 1) {
    const filter = raw[y * (row + 1)];
    const line = raw.subarray(y * (row + 1) + 1, (y + 1) * (row + 1));
    for (let x = 0; x < row; x += 1) {
      const left = x >= 2 ? line[x - 2] : 0;
      const corner = x >= 2 ? above[x - 2] : 0;
      const guess = [0, left, above[x], (left + above[x]) >> 1, filter === 4 ? paeth(left, above[x], corner) : 0];
      line[x] += guess[filter];
    }
    for (let x = 0; x < width; x += 1) values[y * width + x] = (line[2 * x] << 8) | line[2 * x + 1];
    above = line;
  }
  return values;
}

function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// Near is bright and far is dark, by the logarithm as in `fathom sheet`; pixels without a range are transparent.
function ofRange({ width, height, values }) {
  let [near, far] = [Infinity, 0];
  for (const value of values) {
    if (value === 0) continue;
    if (value < near) near = value;
    if (value > far) far = value;
  }
  const image = new ImageData(width, height);
  const span = Math.log(far / near) || 1;
  for (const [index, value] of values.entries()) {
    if (value === 0) continue;
    image.data.set(shade(1 - Math.log(value / near) / span), 4 * index);
    image.data[4 * index + 3] = 255;
  }
  return Object.assign(image, { nearM: near / 1000, farM: far / 1000 });
}

// The palette of `fathom sheet` (services/cli/src/colors.rs): categories by number, findings by bit, and Viridis from far to near.
export const CATEGORY_COLORS = [[24, 38, 56], [176, 148, 104], [230, 159, 0], [204, 94, 0], [150, 74, 36], [130, 160, 190], [86, 180, 233], [240, 228, 66],
  [255, 105, 180], [120, 120, 130], [0, 158, 115], [160, 90, 210], [110, 130, 110], [214, 39, 40], [150, 160, 120], [255, 255, 255], [255, 150, 120],
  [60, 200, 60], [170, 240, 255], [0, 90, 255], [110, 60, 20]];
export const FINDING_COLORS = [[255, 40, 40], [255, 140, 0], [250, 240, 60], [70, 150, 255], [60, 210, 90], [230, 90, 230]];
export const RAMP = [[68, 1, 84], [71, 45, 123], [59, 82, 139], [44, 114, 142], [33, 145, 140], [40, 174, 128], [94, 201, 98], [173, 220, 48], [253, 231, 37]];

// The color of a share of the ramp, from dark to bright.
export function shade(share) {
  const place = Math.min(1, Math.max(0, share)) * (RAMP.length - 1);
  const low = Math.min(RAMP.length - 2, Math.floor(place));
  return RAMP[low].map((value, channel) => Math.round(value + (RAMP[low + 1][channel] - value) * (place - low)));
}

// Black or white, the one with more contrast on a color of codes 0..255 (WCAG 2): both have 4.58 at a luminance of 0.179.
export function textColor(rgb) {
  const [r, g, b] = rgb.map((code) => decoded(code / 255));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.179 ? "#000" : "#fff";
}

export function categoryColor(number) {
  return CATEGORY_COLORS[number] ?? instanceColor(number);
}

// A color for each number, far in hue from its neighbors; 0 is the background.
export function instanceColor(number) {
  if (number === 0) return CATEGORY_COLORS[0];
  const hue = ((number * 0.61803398875) % 1) * 6;
  const light = number % 2 === 0 ? 235 : 175;
  return [5, 3, 1].map((offset) => {
    const place = (offset + hue) % 6;
    return Math.trunc(light * (1 - 0.75 * Math.min(1, Math.max(0, Math.min(place, 4 - place)))));
  });
}

// The color of the first finding of a pixel.
function findingColor(bits) {
  return FINDING_COLORS.find((_, bit) => bits & (1 << bit)) ?? CATEGORY_COLORS[0];
}

function ofCodes({ width, height, values }, color, isOverlay) {
  const image = new ImageData(width, height);
  const colors = new Map([...new Set(values)].map((code) => [code, color(code)]));
  for (const [index, code] of values.entries()) {
    if (code === 0 && isOverlay) continue;
    image.data.set(colors.get(code), 4 * index);
    image.data[4 * index + 3] = 255;
  }
  return Object.assign(image, { codes: [...colors.keys()].sort((a, b) => a - b) });
}

function patch(rgb, text) {
  const square = h("i");
  square.style.background = `rgb(${rgb.join(" ")})`;
  return h("span.pair", {}, square, text);
}

// The legend of a layer or overlay, or null. `codes` are its numbers; `classes` are the names of an uploaded scene by number.
export async function legendOf(kind, { codes = [], nearM = undefined, farM = undefined } = {}, classes = new Map()) {
  if (kind === "boxes") return h("span.legend", {}, "One color per object; solid: visible, dashed: not visible");
  if (kind === "instances") return h("span.legend", {}, "One color per object");
  if (kind === "range") {
    const bar = h("i.ramp");
    bar.style.background = `linear-gradient(to right, ${[...RAMP].reverse().map((rgb) => `rgb(${rgb.join(" ")})`).join(", ")})`;
    return h("span.legend", {}, nearM ? `${nearM.toFixed(2)} m` : "nearest", bar, nearM ? `${farM.toFixed(2)} m` : "farthest of each image");
  }
  if (!CODE_COLORS.has(kind)) return null;
  const isFindings = kind === "findings";
  const named = new Map((await known(`/v1/lists/${isFindings ? "findings" : "categories"}`)).map((one) => [one.number, one.name]));
  if (!isFindings) return h("span.legend", {}, codes.map((code) => patch(categoryColor(code), classes.get(code) ?? named.get(code) ?? `category ${code}`)));
  const bits = codes.reduce((all, code) => all | code, 0);
  return h("span.legend", {}, bits === 0 ? "no findings" : FINDING_COLORS.map((rgb, bit) => (bits & (1 << bit) ? patch(rgb, named.get(bit) ?? `finding ${bit}`) : null)));
}
