// The live frame: only the latest description is rendered.

import { post } from "./api.js";

// Concurrent requests: one image is transferred while the next is rendered.
const MOST = 2;

export class Live {
  // shown({bitmap, ms, isFull}) is called for each image, in order; failed(error) on errors.
  constructor(signal, shown, failed) {
    this.signal = signal;
    this.shown = shown;
    this.failed = failed;
    this.open = 0;
    this.asked = 0;
    this.newest = 0;
    this.next = null;
  }

  ask(frame, isFull) {
    this.next = { frame, isFull };
    this.start();
  }

  start() {
    if (!this.next || this.open >= MOST || this.signal.aborted) return;
    const { frame, isFull } = this.next;
    this.next = null;
    this.asked += 1;
    this.run(frame, isFull, this.asked);
  }

  async run(frame, isFull, number) {
    const begun = performance.now();
    this.open += 1;
    try {
      const bitmap = await rendered(frame, this.signal);
      if (number > this.newest) {
        this.newest = number;
        this.shown({ bitmap, isFull, ms: performance.now() - begun });
      }
    } catch (error) {
      if (!this.signal.aborted && number === this.asked) this.failed(error);
    } finally {
      this.open -= 1;
      this.start();
    }
  }
}

// Renders a frame that the service does not store.
export async function rendered(frame, signal) {
  const response = await post("/v1/renders", frame, { signal, accept: "image/*", prefer: "wait=30" });
  if (response.status === 202) throw new Error("the service is too busy to render this now");
  return createImageBitmap(await response.blob());
}

// The part of a description that affects the image, at a share of its size.
export function pictureOf(frame, share, quality = 90) {
  const { count, dataset, labels, enhance, metrics, ...rest } = frame;
  const camera = { ...(frame.camera ?? {}) };
  // An uploaded scene has its own size.
  if (frame.scene?.kind === "procedural") {
    camera.width = Math.max(16, Math.round((camera.width ?? 768) * share));
    camera.height = Math.max(16, Math.round((camera.height ?? 492) * share));
  }
  return { ...rest, camera, artifacts: ["rgb"], enhance: [], metrics: [], encode: { format: "jpeg", quality } };
}
