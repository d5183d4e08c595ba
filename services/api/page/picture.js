// Decodes images and layers: thumbnails, 16-bit PNG, NPY, and the colors of ranges and masks.

import { binary, hasToken, send } from "./api.js";
import { h } from "./dom.js";

// An image of the service. An img element cannot send a token.
export function picture(path, alt, props = {}) {
  const image = h("img", { alt, decoding: "async", ...props });
  if (hasToken()) {
    send(path).then(async (response) => {
      const address = URL.createObjectURL(await response.blob());
      image.onload = () => URL.revokeObjectURL(address);
      image.src = address;
    }, () => image.classList.add("missing"));
  } else {
    image.onerror = () => image.classList.add("missing");
    image.src = path;
  }
  return image;
}

// A file in the format of its kind as ImageData.
export async function pixels(path, kind, mediaType, signal) {
  const data = await binary(path, signal);
  if (mediaType === "application/x-npy") return ofArray(readNpy(data), kind);
  if (kind === "range") return ofRange(await readPng16(data));
  const picture = await readPicture(data, mediaType);
  if (["instances", "semantics", "semantics.visible", "findings"].includes(kind)) return ofCodes(picture);
  return picture;
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
  const code = { normals: (v) => 127.5 * (v + 1), transmittance: (v) => 255 * v }[kind] ?? encoded;
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

// A color of shares, linear or display-encoded, as `#rrggbb`.
export function toHex(color, isLinear) {
  return `#${color.map((share) => Math.round(Math.min(255, isLinear ? encoded(share) : 255 * share)).toString(16).padStart(2, "0")).join("")}`;
}

export function fromHex(text, isLinear) {
  return [1, 3, 5].map((start) => {
    const code = parseInt(text.slice(start, start + 2), 16) / 255;
    const linear = code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4;
    return Number((isLinear ? linear : code).toFixed(3));
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

// Near is bright, far is dark, holes are transparent.
function ofRange({ width, height, values }) {
  const known = values.filter((value) => value > 0).sort();
  const low = known[Math.floor(known.length * 0.01)] ?? 0;
  const high = Math.max(low + 1, known[Math.floor(known.length * 0.99)] ?? 1);
  const image = new ImageData(width, height);
  for (let at = 0; at < values.length; at += 1) {
    if (values[at] === 0) continue;
    image.data.set(shade(1 - (values[at] - low) / (high - low)), 4 * at);
    image.data[4 * at + 3] = 255;
  }
  return Object.assign(image, { legend: `bright ${(low / 1000).toFixed(1)} m, dark ${(high / 1000).toFixed(1)} m, empty: no range` });
}

const STOPS = [[13, 8, 135], [84, 2, 163], [139, 10, 165], [185, 50, 137], [219, 92, 104], [244, 136, 73], [254, 188, 43], [240, 249, 33]];

// A color scale with monotonic brightness.
export function shade(share) {
  const place = Math.min(1, Math.max(0, share)) * (STOPS.length - 1);
  const at = Math.min(STOPS.length - 2, Math.floor(place));
  return STOPS[at].map((low, c) => Math.round(low + (STOPS[at + 1][c] - low) * (place - at)));
}

// A color for each number, with contrast between neighbors; 0 is transparent.
export function codeColor(number) {
  const hue = (number * 137.508) % 360;
  const light = 0.5 + 0.14 * ((number % 3) - 1);
  const part = (n) => {
    const k = (n + hue / 30) % 12;
    return Math.round(255 * (light - 0.7 * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [part(0), part(8), part(4)];
}

function ofCodes(picture) {
  const found = new Set();
  for (let at = 0; at < picture.data.length; at += 4) {
    const code = picture.data[at];
    found.add(code);
    picture.data.set(code === 0 ? [0, 0, 0, 0] : [...codeColor(code), 255], at);
  }
  picture.codes = [...found].filter(Boolean).sort((a, b) => a - b);
  return picture;
}
