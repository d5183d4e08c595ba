// The fields in the form of Compose, with the usual range of their sliders. The service checks the limits: the number
// next to a slider accepts any value.

export const START = {
  dataset: "composed",
  count: 24,
  seed: 7,
  scene: { kind: "procedural", family: "structure", seed: { int: [0, 1000000] } },
  camera: { width: 768, height: 492, hfov_deg: 80 },
  water: { optics: "jerlov-1C", range_scale: 0.4, style: "atlantic" },
  alpha: 0.5,
  artifacts: ["rgb", "range", "instances"],
};

const slider = (pointer, low, high, more = {}) => ({ pointer, kind: "number", low, high, ...more });
const choice = (pointer, list, more = {}) => ({ pointer, kind: "choice", list, ...more });

/** @type {[string, any[]][]} */
export const GROUPS = [
  ["Water", [
    choice("/water/optics", "/v1/waters", { value: "jerlov-1C", none: "no water" }),
    slider("/water/range_scale", 0.02, 4, { log: true, value: 1 }),
    choice("/water/style", "/v1/styles", { none: "no style" }),
    slider("/alpha", 0, 1, { value: 1 }),
    slider("/water/depth_m", 0, 60, { value: 5, optional: true }),
  ]],
  ["Daylight", [
    choice("/daylight", null, { options: ["none"], none: "auto, or the sky below" }),
    slider("/daylight/sun_elevation_deg", 5, 90, { value: 45, optional: true }),
    slider("/daylight/sun_azimuth_deg", 0, 360, { value: 0, below: "/daylight" }),
    slider("/daylight/cloud_cover", 0, 1, { value: 0.5, below: "/daylight" }),
    slider("/daylight/wind_m_per_s", 0, 20, { value: 4, below: "/daylight" }),
  ]],
  ["Turbidity and snow", [
    slider("/water/turbidity/contrast", 0, 0.95, { value: 0.5, optional: true }),
    slider("/water/turbidity/scale_m", 0.1, 20, { log: true, value: 2, below: "/water/turbidity" }),
    slider("/water/snow/density_per_m3", 1, 20000, { log: true, value: 1000, optional: true }),
    slider("/water/snow/radius_m", 0.0002, 0.01, { log: true, value: 0.001, below: "/water/snow" }),
  ]],
  ["Scene and camera", [
    choice("/scene/family", "/v1/lists/families", { value: "structure" }),
    choice("/scene/lighting", null, { options: ["water", "in_air"], none: "default" }),
    slider("/scene/seed", 0, 1000000, { whole: true, value: 0 }),
    choice("/camera/preset", "/v1/lists/cameras", { none: "pinhole" }),
    slider("/camera/hfov_deg", 20, 150, { value: 80 }),
    slider("/camera/width", 64, 2048, { whole: true, value: 768 }),
    slider("/camera/height", 64, 1536, { whole: true, value: 492 }),
  ]],
  ["Job", [
    { pointer: "/dataset", kind: "text", value: "default" },
    slider("/count", 1, 10000, { whole: true, log: true, value: 1, noLaw: true }),
    slider("/seed", 0, 1000, { whole: true, value: 0, noLaw: true }),
    slider("/fidelity/tolerance", 1e-5, 1e-2, { log: true, value: 3e-4, optional: true }),
    { pointer: "/enhance", kind: "list", list: "/v1/lists/enhancements" },
    { pointer: "/artifacts", kind: "list", list: "/v1/lists/artifacts" },
  ]],
];

// Fields of one entry of /lights.
export const LAMPS = {
  haze: [slider("x", 0, 1, { value: 0.5 }), slider("y", 0, 1, { value: 0.5 }), slider("size", 0.02, 0.6, { value: 0.2 }),
    slider("intensity", 0, 1, { value: 0.6 })],
  point: [slider("position_m/0", -3, 3, { value: 0.4 }), slider("position_m/1", -3, 3, { value: -0.2 }),
    slider("position_m/2", -1, 8, { value: 0.2 }), slider("radius_m", 0, 0.5, { value: 0.02 })],
  spot: [slider("position_m/0", -3, 3, { value: 0.4 }), slider("position_m/1", -3, 3, { value: -0.2 }),
    slider("position_m/2", -1, 8, { value: 0 }), slider("cone_deg", 1, 90, { value: 35 }), slider("radius_m", 0, 0.5, { value: 0.02 })],
};
export const NEW_LAMPS = {
  haze: { kind: "haze", x: 0.5, y: 0.6, size: 0.2, intensity: 0.6 },
  point: { kind: "point", position_m: [0.4, -0.3, 0.3], intensity: [2, 2, 2] },
  spot: { kind: "spot", position_m: [0.4, -0.3, 0.0], intensity: [6, 6, 6], cone_deg: 35 },
};

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
