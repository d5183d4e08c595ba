// The fields in the form of Compose: words, units, and the usual range of their sliders. The service checks the limits: the number
// next to a slider accepts any value.

// The first job of Compose.
export const START = { dataset: "composed", count: 24, seed: 3, site: "shaft" };

// The description of a job without a site.
export const OWN = {
  scene: { kind: "procedural", family: "structure", seed: { int: [0, 1000000] }, lighting: "water" },
  camera: { width: 768, height: 492, hfov_deg: 80 },
  water: { optics: "jerlov-II", depth_m: 4 },
  artifacts: ["rgb", "range", "instances"],
};

const slider = (pointer, label, low, high, more = {}) => ({ pointer, label, kind: "number", low, high, ...more });
const choice = (pointer, label, list, more = {}) => ({ pointer, label, kind: "choice", list, ...more });
// Conditions on the fields that are in effect.
const isProcedural = (get) => get("/scene/kind") === "procedural";
const hasStyle = (get) => Boolean(get("/water/style"));

/** @type {[string, any[]][]} */
export const GROUPS = [
  ["Scene", [
    choice("/scene/family", "Family", "/v1/lists/families", { value: "structure", when: isProcedural }),
    slider("/scene/seed", "Seed of the scene", 0, 1000000, { whole: true, value: 0, when: isProcedural }),
    choice("/scene/lighting", "Lighting", null, { options: ["water", "in_air"], none: "default" }),
  ]],
  ["Water", [
    choice("/water/optics", "Water", "/v1/waters", { value: "jerlov-1C", none: "no water" }),
    slider("/water/range_scale", "Scale of the coefficients", 0.02, 4, { log: true, value: 1 }),
    slider("/water/depth_m", "Depth of the camera", 0, 60, { value: 5, optional: true }),
    choice("/water/style", "Style", "/v1/styles?role=style", { none: "no style" }),
    slider("/alpha", "Strength of the style", 0, 1, { value: 1, when: hasStyle }),
  ]],
  ["Lights", []],
  ["Daylight", [
    choice("/daylight", "Daylight", null, { options: ["none"], none: "auto, or the sky below" }),
    slider("/daylight/sun_elevation_deg", "Elevation of the sun", 5, 90, { value: 45, optional: true }),
    slider("/daylight/sun_azimuth_deg", "Azimuth of the sun", 0, 360, { value: 0, below: "/daylight" }),
    slider("/daylight/cloud_cover", "Cloud cover", 0, 1, { value: 0.5, below: "/daylight" }),
    slider("/daylight/wind_m_per_s", "Wind", 0, 20, { value: 4, below: "/daylight" }),
  ]],
  ["Turbidity and snow", [
    slider("/water/turbidity/contrast", "Contrast of turbidity patches", 0, 0.95, { value: 0.5, optional: true }),
    slider("/water/turbidity/scale_m", "Size of turbidity patches", 0.1, 20, { log: true, value: 2, below: "/water/turbidity" }),
    slider("/water/snow/density_per_m3", "Density of marine snow", 1, 20000, { log: true, value: 1000, optional: true }),
    slider("/water/snow/radius_m", "Radius of the particles", 0.0002, 0.01, { log: true, value: 0.001, below: "/water/snow" }),
  ]],
  ["Camera", [
    choice("/camera/preset", "Camera", "/v1/lists/cameras", { none: "pinhole" }),
    slider("/camera/hfov_deg", "Horizontal field of view", 20, 150, { value: 80 }),
    slider("/camera/width", "Image width", 64, 2048, { whole: true, value: 768, when: isProcedural }),
    slider("/camera/height", "Image height", 64, 1536, { whole: true, value: 492, when: isProcedural }),
  ]],
  ["Job", [
    { pointer: "/dataset", label: "Dataset", kind: "text", value: "default" },
    slider("/count", "Frames", 1, 10000, { whole: true, log: true, value: 1, noLaw: true }),
    slider("/seed", "Seed of the job", 0, 1000, { whole: true, value: 0, noLaw: true }),
    slider("/fidelity/tolerance", "Tolerance", 1e-5, 1e-2, { log: true, value: 3e-4, optional: true }),
    { pointer: "/artifacts", label: "Artifacts", kind: "list", list: "/v1/lists/artifacts" },
    { pointer: "/enhance", label: "Enhancements", kind: "list", list: "/v1/lists/enhancements" },
  ]],
];
// Initially open groups.
export const OPEN_GROUPS = new Set(["Scene", "Water", "Lights", "Job"]);
// Fields that belong to the job and never to a site.
export const JOB_FIELDS = new Set(["/dataset", "/count", "/seed"]);

const POSITION = [slider("position_m/0", "Position, to the right", -3, 3, { value: 0.4 }), slider("position_m/1", "Position, down", -3, 3, { value: -0.2 }),
  slider("position_m/2", "Position, ahead", -1, 8, { value: 0 })];
const EMITTER = [{ pointer: "intensity", label: "Intensity", kind: "intensity", low: 0.01, high: 200 }, slider("radius_m", "Radius of the lamp", 0, 0.5, { value: 0.02 })];
// Fields of one entry of /lights.
export const LAMPS = {
  haze: [slider("x", "Position, from the left", 0, 1, { value: 0.5 }), slider("y", "Position, from the top", 0, 1, { value: 0.5 }),
    slider("size", "Size", 0.02, 0.6, { value: 0.2 }), slider("intensity", "Intensity", 0, 1, { value: 0.6 }),
    { pointer: "color", label: "Color", kind: "color" }, choice("blend", "Blend mode", null, { options: ["over", "add"], value: "over" })],
  point: [...POSITION, ...EMITTER],
  spot: [...POSITION, slider("direction/0", "Direction, to the right", -3, 3, { value: 0, base: [0, 0, 1] }),
    slider("direction/1", "Direction, down", -3, 3, { value: 0, base: [0, 0, 1] }), slider("direction/2", "Direction, ahead", -1, 1, { value: 1, base: [0, 0, 1] }),
    slider("cone_deg", "Half angle of the beam", 1, 90, { value: 30 }), ...EMITTER],
};
export const NEW_LAMPS = {
  haze: { kind: "haze", x: 0.5, y: 0.6, size: 0.2, intensity: 0.6, color: [1, 1, 1] },
  point: { kind: "point", position_m: [0.4, -0.3, 0.3], intensity: [2, 2, 2] },
  spot: { kind: "spot", position_m: [0.4, -0.3, 0.0], intensity: [6, 6, 6], direction: [-0.1, 0.1, 1], cone_deg: 35 },
};

// A job over an uploaded scene or a collection. Water needs a range, and labels need a mask.
export function uploadedJob(scene, { hasRange, hasMask }) {
  return { dataset: "composed", count: scene.kind === "collection" ? 1 : 12, seed: 7, scene,
    ...(hasRange ? { water: { optics: "jerlov-1C", range_scale: { log_uniform: [0.2, 0.8] } } } : {}),
    artifacts: ["rgb", ...(hasRange ? ["range"] : []), ...(hasMask ? ["instances"] : [])] };
}

// Replaces the scene of a job. Null removes the fields of the site that only procedural scenes have.
export function useUploaded(job, scene, available) {
  const { width, height, view, path, hfov_deg: _, ...camera } = job.camera ?? {};
  const { artifacts } = uploadedJob(scene, available);
  const removed = { width: null, height: null, view: null, hfov_deg: null };
  Object.assign(job, { scene, artifacts, camera: job.site === undefined ? camera : { ...camera, ...removed } });
}

export function at(document, pointer) {
  return pointer.split("/").slice(1).reduce((value, key) => (value && typeof value === "object" ? value[key] : undefined), document);
}

// Sets a value, or removes the field if it is undefined.
export function put(document, pointer, value) {
  const keys = pointer.split("/").slice(1);
  const last = keys.pop();
  let place = document;
  for (const key of keys) {
    if (place[key] === undefined || place[key] === null || typeof place[key] !== "object") {
      if (value === undefined) return;
      place[key] = {};
    }
    place = place[key];
  }
  if (value !== undefined) place[last] = value;
  else if (Array.isArray(place)) place.splice(Number(last), 1);
  else delete place[last];
}
