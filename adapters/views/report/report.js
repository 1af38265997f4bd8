// SPDX-License-Identifier: Apache-2.0
const page = (() => {
// ---- Data -------------------------------------------------------------------------------------
// Steps come in parts, by append(): all of them at once in a report, a few at a time of a mission that goes on.
const run = JSON.parse($("run").textContent);
let n = 0;

function varints(base64) {
  const data = bytes(base64);
  let at = 0;
  return () => {
    let value = 0, unit = 1;
    for (;;) {
      const byte = data[at++];
      value += (byte & 127) * unit;
      if (byte < 128) return value;
      unit *= 128;
    }
  };
}
const push = (list, values) => { for (const value of values) list.push(value); };

const column = new Proxy({}, { get: (all, name) => (all[name] ||= []) });
const word = new Proxy({}, { get: (all, name) => (all[name] ||= []) });
const speeds = [];             // of the commands [m/s]
const terms = [];              // of the cost, by step: {name, weighted, weight_asked, weight}
const candidateTerms = [];     // their names
const candidates = [];         // at each step: the best of them
const landmarkPositions = [], landmarks = [];
const horizons = [];           // at each step: [x, y, yaw] of the predicted poses
const movers = [];             // at each step: [x, y, vx, vy, radius] of what moves by itself
const standings = [];          // at each step that asked which frontier is next: {why, x, y, area, unknown, time} of each, else []
const fields = [];             // the cost-to-go at some of the steps
const pictures = [];           // what the robot's left camera showed at some of the steps, where it has one
const modeColors = {};
let scale = [];
let hasModes = false;          // a run of an older program has none

const r = run.resolution;
// Ground cells: a cell is one number, the same for good; the rectangle that holds all of them grows.
const half = 32768;
const cellAt = (i, j) => (j + half) * 65536 + i + half;
const columnOf = (cell) => cell % 65536 - half, rowOf = (cell) => Math.floor(cell / 65536) - half;
let i0 = 0, j0 = 0, width = 0, height = 0;
let newest = new Uint8Array(0), ground = new Uint8Array(0);  // the map at the last step; at the one that is shown
const indexOf = (cell) => (rowOf(cell) - j0) * width + columnOf(cell) - i0;
// Changes of the map at each step, with the state before, so that time can run backwards.
const changes = [];
// Cells that became or ceased to be frontier at each step, and the frontier at the last one.
const frontierToggles = [];
let newestFrontier = new Set();

function grow(extent) {
  if (extent.width === 0) return;
  const left = width ? Math.min(i0, extent.i0) : extent.i0, low = width ? Math.min(j0, extent.j0) : extent.j0;
  const wide = Math.max(width ? i0 + width : left, extent.i0 + extent.width) - left;
  const high = Math.max(width ? j0 + height : low, extent.j0 + extent.height) - low;
  if (left === i0 && low === j0 && wide === width && high === height) return;
  const moved = (cells) => {
    const wider = new Uint8Array(wide * high);
    for (let j = 0; j < height; ++j) wider.set(cells.subarray(j * width, (j + 1) * width), (j + j0 - low) * wide + i0 - left);
    return wider;
  };
  newest = moved(newest);
  ground = moved(ground);
  i0 = left; j0 = low; width = wide; height = high;
}

function decode(part) {
  const count = part.steps, first = n;
  for (const [name, text] of Object.entries(part.columns)) push(column[name], floats(text));
  for (const [name, { words, steps }] of Object.entries(part.words)) {
    const next = varints(steps);
    for (let k = 0; k < count; ++k) word[name].push(words[next()]);
  }
  for (let k = first; k < first + count; ++k) speeds.push(Math.hypot(column.command_v[k], column.command_vy[k]));
  const ofTerm = ["weighted", "weight_asked", "weight"];
  for (const given of part.terms) {
    let term = terms.find((known) => known.name === given.name);
    if (!term) terms.push(term = { name: given.name, ...Object.fromEntries(ofTerm.map((key) => [key, Array(first).fill(NaN)])) });
    for (const key of ofTerm) push(term[key], floats(given[key]));
  }
  for (const term of terms) for (const key of ofTerm) while (term[key].length < first + count) term[key].push(NaN);

  grow(part.extent);
  const { i0: left, j0: low, width: wide } = part.extent;
  const cellOf = (index) => cellAt(left + index % wide, low + Math.floor(index / wide));
  {
    const next = varints(part.map);
    for (let k = 0; k < count; ++k) {
      const cells = [], now = [], before = [];
      for (let runs = next(), at = 0; runs > 0; --runs) {
        at += next();
        const code = next(), value = code % 4;
        for (const end = at + (code - value) / 4; at < end; ++at) {
          const cell = cellOf(at), index = indexOf(cell);
          cells.push(cell); now.push(value); before.push(newest[index]);
          newest[index] = value;
        }
      }
      changes.push({ cells, now, before });
    }
  }
  {
    const next = varints(part.frontiers);
    let frontier = new Set();
    for (let k = 0; k < count; ++k) {
      const toggled = [];
      for (let left = next(), at = 0; left > 0; --left) toggled.push(cellOf(at += next()));
      for (const cell of toggled) if (!frontier.delete(cell)) frontier.add(cell);
      // A part begins without a frontier, a run that goes on does not.
      frontierToggles.push(k > 0 ? toggled : [...frontier].filter((cell) => !newestFrontier.has(cell)).concat([...newestFrontier].filter((cell) => !frontier.has(cell))));
    }
    if (count > 0) newestFrontier = frontier;
  }
  {
    const next = varints(part.landmarks.steps), offset = landmarkPositions.length / 2;
    push(landmarkPositions, floats(part.landmarks.positions));
    for (let k = 0; k < count; ++k) {
      const seen = next(), index = new Uint32Array(seen), visibility = new Uint8Array(seen);
      for (let i = 0, at = 0; i < seen; ++i) { index[i] = offset + (at += next()); visibility[i] = next(); }
      landmarks.push({ index, visibility });
    }
  }
  {
    const { names, verdicts, terms: own, steps, values } = part.candidates;
    const next = varints(steps), numbers = floats(values);
    const signed = () => { const z = next(); return z % 2 ? -(z + 1) / 2 : z / 2; };
    for (const name of own) if (!candidateTerms.includes(name)) candidateTerms.push(name);
    const places = own.map((name) => candidateTerms.indexOf(name));
    let at = 0;
    for (let k = 0; k < count; ++k) {
      const list = Array.from({ length: next() }, () => {
        const c = { name: names[next()], verdict: verdicts[next()], polished: next() === 1, path: [], terms: [] };
        for (let left = next(), x = 0, y = 0; left > 0; --left) c.path.push([0.01 * (x += signed()), 0.01 * (y += signed())]);
        c.cost = numbers[at++];
        for (const place of places) c.terms[place] = numbers[at++];
        return c;
      });
      candidates.push(list);
    }
  }
  {
    const next = varints(part.horizon.counts), poses = floats(part.horizon.poses);
    for (let k = 0, at = 0; k < count; ++k) horizons.push(Array.from({ length: next() }, () => [poses[at++], poses[at++], poses[at++]]));
  }
  {
    const { counts, values: numbers } = part.movers || { counts: "", values: "" };
    const next = part.movers ? varints(counts) : () => 0, values = floats(numbers);
    for (let k = 0, at = 0; k < count; ++k) movers.push(Array.from({ length: next() }, () => Array.from({ length: 5 }, () => values[at++])));
  }
  {
    const { whys, steps, values } = part.standings || { whys: [], steps: "", values: "" };
    const next = varints(steps), numbers = floats(values);
    for (let k = 0, at = 0; k < count; ++k) {
      standings.push(Array.from({ length: part.standings ? next() : 0 }, () => ({
        why: whys[next()], x: numbers[at++], y: numbers[at++], area: numbers[at++], unknown: numbers[at++], time: numbers[at++],
      })));
    }
  }
  for (const field of part.cost_to_go) fields.push({ ...field, step: first + field.step });
  for (const picture of loadPictures(part.pictures || [])) pictures.push({ ...picture, frame: first + picture.frame });
  Object.assign(modeColors, part.palette.modes);
  scale = part.palette.scale;
  n += count;
  hasModes ||= word.mode.slice(first).some((mode) => mode !== "");
}
if (run.steps > 0) decode(run);

// ---- Numbers as text --------------------------------------------------------------------------
const percent = (x, digits = 1) => fixed(isNumber(x) ? 100 * x : x, digits);
// To a thousandth at most, and no more than about three significant digits.
function rounded(x) {
  if (!isNumber(x)) return "–";
  const size = Math.abs(x);
  if (size < 5e-4) return "0";
  if (size >= 1e5) return x.toExponential(1).replace(/-/g, "−");
  return fixed(x, size < 1 ? 3 : size < 100 ? 2 : size < 1000 ? 1 : 0);
}
const ascending = (values) => values.filter(isNumber).sort((a, b) => a - b);
const readable = (name) => name.replace(/_/g, " ");

// ---- Head and summary -------------------------------------------------------------------------
const s = run.summary;
if (run.steps !== undefined) {  // a run that goes on has no summary yet
  const end = { done: "good", failed: "bad" }[s.outcome] || "warn";
  $("facts").append(make("span", { class: `end ${end}` }, s.reason || "–"),
    ` · ${s.solver} · seed ${s.seed} · ${s.steps} planning steps`);
  const figure = (label, value, unit, bad) => $("figures").append(make("div", bad ? { class: "bad" } : {},
    make("dd", {}, value, make("small", {}, unit)), make("dt", {}, label)));
  figure("coverage", percent(s.coverage), "%");
  if (isNumber(s.time_to_95_s)) figure("time to 95 %", fixed(s.time_to_95_s, 0), "s");
  else figure("duration", fixed(s.duration_s, 0), "s");
  figure("path", fixed(s.path_length_m, 1), "m");
  figure("localization error", fixed(s.localization_rmse_m, 3), "m RMS");
  figure("collisions", fixed(s.collisions, 0), "", s.collisions > 0);
  figure("planning, p95", fixed(s.plan_ms.p95, 0), "ms");

  const cell = (value, unit = "", bad = false) => make("td", bad ? { class: "bad" } : {}, value, make("small", {}, value === "–" ? "" : unit));
  const table = (title, rows) => {
    const body = make("tbody");
    for (const [label, value, unit, bad] of rows) {
      body.append(make("tr", {}, make("th", { scope: "row" }, label),
        cell(value, unit, bad)));
    }
    $("summary").append(make("div", {}, make("h3", {}, title), make("table", {}, body)));
  };
  table("Exploration", [
    ["Coverage of the reachable area", percent(s.coverage, 2), "%"],
    ["Of it seen", fixed(s.area_m2, 1), "m²"],
    ["Reachable area", fixed(s.reachable_area_m2, 1), "m²"],
    ...(s.too_long_for_m2 > 0 ? [["Left out, as the body is too long", fixed(s.too_long_for_m2, 1), "m²"]] : []),
    ["Duration", fixed(s.duration_s, 1), "s"],
    ...(isNumber(s.turned_back_s) ? [["Turned back for want of time, after", fixed(s.turned_back_s, 1), "s"]] : []),
    ...(isNumber(s.heading_missed_deg) ? [["Left to the heading asked for, which cannot be had", fixed(s.heading_missed_deg, 0), "°"]] : []),
    ["Path", fixed(s.path_length_m, 2), "m"],
    ["Collisions", fixed(s.collisions, 0), "", s.collisions > 0]]);
  {
    const body = make("tbody");
    for (const share of [90, 95, 99]) {
      body.append(make("tr", {}, make("th", { scope: "row" }, `${share} %`),
        cell(fixed(s[`time_to_${share}_s`], 1), "s"), cell(fixed(s[`path_to_${share}_m`], 1), "m")));
    }
    $("summary").append(make("div", {}, make("h3", {}, "Time and path to coverage"), make("table", {}, body)));
  }
  table("Localization", [
    ["Error, root mean square", fixed(s.localization_rmse_m, 3), "m"],
    ["Error at the end", fixed(s.localization_final_m, 3), "m"],
    ["Drift, of the path", fixed(s.drift_percent, 2), "%"],
    ["Losses", fixed(s.losses, 0), ""]]);
  table("Planning", [
    ["Time, median", fixed(s.plan_ms.p50, 1), "ms"],
    ["Time, 95 %", fixed(s.plan_ms.p95, 1), "ms"],
    ["Time, 99 %", fixed(s.plan_ms.p99, 1), "ms"],
    ["Time, longest", fixed(s.plan_ms.max, 1), "ms"],
    ["Deadline misses", fixed(s.deadline_misses, 0), ""],
    ["Stopping tails", fixed(s.fallbacks, 0), ""],
    ["Guard stops", fixed(s.guard_stops, 0), ""],
    ["Wall clock", fixed(s.wall_s, 1), "s"]]);
  const reasons = new Map();  // of what was left when it was last asked: how many, and what they promise
  for (const { why, area } of [...standings].reverse().find((list) => list.length > 0) || []) {
    const [count, sum] = reasons.get(why) || [0, 0];
    reasons.set(why, [count + 1, sum + area]);
  }
  if (reasons.size) {
    const body = make("tbody");
    for (const [why, [count, area]] of reasons) {
      body.append(make("tr", {}, make("th", { scope: "row" }, why), cell(fixed(count, 0)), cell(fixed(area, 1), "m²")));
    }
    $("summary").append(make("div", {}, make("h3", {}, "Frontiers left, as last asked: how many, what they promise"), make("table", {}, body)));
  }
  if (run.steps > 0) {
    const body = make("tbody");
    const rank = (sorted, p) => sorted[Math.max(0, Math.ceil(p * sorted.length / 100) - 1)];
    for (const [label, name] of [["GlobalPlan", "frontiers_ms"], ["Clearance field", "clearance_ms"],
      ["Visible landmarks", "views_ms"], ["Seeds", "seeds_ms"], ["Optimisation", "polish_ms"], ["Certificate", "certify_ms"]]) {
      const sorted = ascending(column[name]);
      body.append(make("tr", {}, make("th", { scope: "row" }, label),
        cell(fixed(rank(sorted, 50), 1), "ms"), cell(fixed(rank(sorted, 95), 1), "ms")));
    }
    $("summary").append(make("div", {}, make("h3", {}, "Where planning time goes: median, 95 %"), make("table", {}, body)));
  }
}
for (const line of run.configuration.split("\n")) {
  // A comment starts at # at the beginning or after a space; that is enough for what this program writes.
  const [, code, comment] = line.match(/^(.*?)((?:^|\s)#.*)?$/);
  const [, key, value] = code.match(/^(\s*[\w-]+:)?(.*)$/);
  if (key) $("configuration").append(make("span", { class: "key" }, key));
  $("configuration").append(value);
  if (comment) $("configuration").append(make("span", { class: "comment" }, comment));
  $("configuration").append("\n");
}

// ---- State ------------------------------------------------------------------------------------
let step = -1;                   // shown now
const frontier = new Set();
let colors = {};
let dark = false;
const modeColor = (mode) => modeColors[mode] || "#64748b";
// The scale of quantities at a share in [0, 1]: without the end that is too near the page's own colour.
function scaleColor(share) {
  const [low, high] = dark ? [0.25, 1] : [0, 0.8];
  const at = (low + (high - low) * Math.min(1, Math.max(0, share || 0))) * (scale.length - 1), i = Math.min(scale.length - 2, Math.floor(at));
  const a = rgb(scale[i]), b = rgb(scale[i + 1]);
  return a.map((c, m) => Math.round(c + (b[m] - c) * (at - i)));
}
const scaleGradient = () => `linear-gradient(90deg, ${Array.from({ length: 11 }, (_, i) => `rgb(${scaleColor(i / 10).join(",")})`).join(",")})`;
let pointed = null;              // number of the candidate that is pointed at in the table
let pointedFrontier = null;      // the frontier that is pointed at in the table
// The frontiers as they stood when it was last asked which is next.
function standingsAt(k) {
  while (k > 0 && standings[k].length === 0) --k;
  return { asked: k, list: standings[k] || [] };
}
const drawn = {};                // what the last drawing really used, for the self-test

// ---- Map --------------------------------------------------------------------------------------
const canvas = $("map"), pen = canvas.getContext("2d");
const picture = make("canvas");  // one pixel a cell, y down
const picturePen = picture.getContext("2d");
let pixels, pixels32;
let palette = new Uint32Array(3);
const pixelOf = (index) => (height - 1 - Math.floor(index / width)) * width + index % width;
function paintGround() {
  if (picture.width !== Math.max(1, width) || picture.height !== Math.max(1, height) || !pixels) {
    picture.width = Math.max(1, width); picture.height = Math.max(1, height);
    pixels = picturePen.createImageData(picture.width, picture.height);
    pixels32 = new Uint32Array(pixels.data.buffer);
  }
  for (let index = 0; index < ground.length; ++index) pixels32[pixelOf(index)] = palette[ground[index]];
  picturePen.putImageData(pixels, 0, 0);
}

function rgb(text) {
  const value = parseInt(text.slice(1), 16);
  return [value >> 16, value >> 8 & 255, value & 255];
}
function readColors() {
  const style = getComputedStyle(document.documentElement);
  dark = matchMedia("(prefers-color-scheme: dark)").matches;
  for (const name of ["target", "ink", "ink-2", "ink-3", "line", "accent", "map-unknown", "map-free", "map-occupied", "estimated", "true",
    "horizon", "mover", "frontier", "keep-out", "slow", "seen-low", "seen-high", "view", "halo", "grid", "shade-warn", "shade-bad", "warn", "bad"]) {
    colors[name] = style.getPropertyValue(`--${name}`).trim();
  }
  palette = new Uint32Array(["map-unknown", "map-free", "map-occupied"].map((name) => {
    const [red, green, blue] = rgb(colors[name]);
    return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
  }));
  const low = rgb(colors["seen-low"]), high = rgb(colors["seen-high"]);
  colors.visibility = Array.from({ length: 128 }, (_, i) =>
    `rgb(${low.map((c, m) => Math.round(c + (high[m] - c) * i / 127)).join(",")})`);
  paintGround();
}

const zones = run.zones;
// Where the frame of the poses lies in that of the map, in which goals and zones are told.
const mapOrigin = (k) => (isNumber(column.map_x[k]) ? [column.map_x[k], column.map_y[k], column.map_yaw[k]] : [0, 0, 0]);
const toMap = ([x, y], k) => {
  const [ox, oy, yaw] = mapOrigin(k), c = Math.cos(yaw), s = Math.sin(yaw);
  return [ox + c * x - s * y, oy + s * x + c * y];
};
const fromMap = ([x, y], k) => {
  const [ox, oy, yaw] = mapOrigin(k), c = Math.cos(yaw), s = Math.sin(yaw);
  return [c * (x - ox) + s * (y - oy), c * (y - oy) - s * (x - ox)];
};
const isCorrected = () => column.corrected_by.some(isNumber);
const hasZones = () => Boolean(zones.bound || zones.area || zones.keep_out.length || zones.slow.length || column.goal_x.some(isNumber));
// A layer is there once there is something to be seen in it.
const layerList = [
  ["estimated", "estimated path", "", "background:var(--estimated)", true, () => true],
  ["true", "true path", "", "background:var(--true)", true, () => true],
  ["corrected", "path as told before corrections", "", "background:var(--warn)", true, isCorrected],
  ["horizon", "plan", "", "background:var(--horizon)", true, () => true],
  ["target", "target", "ring", "border-color:var(--target)", true, () => column.way_left.some(isNumber)],
  ["order", "frontiers in order", "ring", "border-color:var(--frontier)", true, () => standings.some((list) => list.length > 0)],
  ["movers", "what moves, and where in a second", "ring", "border-color:var(--mover)", true, () => movers.some((list) => list.length > 0)],
  ["zones", "zones and goal", "cell", "background:rgba(var(--keep-out),.3)", true, hasZones],
  ["view", "field of view", "cell", "background:rgba(var(--view),.3)", true, () => true],
  ["frontiers", "frontiers", "cell", "background:var(--frontier)", true, () => true],
  ["landmarks", "landmarks, by visibility", "ramp", "", true, () => true],
  ["candidates", "other candidates", "", "background:var(--ink-3)", false, () => candidates.some((list) => list.length > 0)],
  ["cost-to-go", "time to the target", "scale", "", false, () => fields.length > 0]];
const layers = Object.fromEntries(layerList.map(([name]) => [name, false]));
function addLayers() {
  for (const [name, label, mark, style, on, there] of layerList) {
    if ($(`layer-${name}`) || !there()) continue;
    layers[name] = on;
    const box = make("input", { type: "checkbox", id: `layer-${name}` });
    box.checked = on;
    box.addEventListener("change", () => { layers[name] = box.checked; draw(); });
    $("layers").append(make("label", {}, box, make("i", { class: mark, style }), label));
  }
}
addLayers();

// What the path can be coloured by: a quantity at each step, or the mode.
const pathColors = {
  plain: null,
  features: { label: "features in view", values: column.tracked_features, text: (v) => fixed(v, 0) },
  error: { label: "localization error", values: column.localization_error, text: (v) => `${fixed(v, 2)} m` },
  speed: { label: "speed", values: speeds, text: (v) => `${fixed(v, 2)} m/s` },
  mode: { label: "mode" },
};
function measureColors() {
  for (const by of Object.values(pathColors)) {
    if (!by?.values) continue;
    const sorted = ascending(by.values);
    by.end = sorted.length ? sorted[Math.ceil(0.98 * sorted.length) - 1] : 1;  // one peak does not flatten the rest
    if (!(by.end > 0)) by.end = 1;
    by.open = sorted.length > 0 && sorted[sorted.length - 1] > by.end;
  }
  for (const name of Object.keys(pathColors)) {
    if ((name === "mode" && !hasModes) || [...pathColor.options].some(({ value }) => value === name)) continue;
    pathColor.append(make("option", { value: name }, name === "plain" ? "path: plain" : `path by ${name}`));
  }
}
const pathColor = $("path-color");
measureColors();
pathColor.addEventListener("change", () => draw());

// The cost-to-go at some of the steps. An image is decoded when it is first wanted.
let tinted = { field: null, dark: null, canvas: make("canvas") };
function fieldAt(k) {
  let best = null;
  for (const f of fields) if (f.step <= k) best = f;
  return best;
}
function tintedField(f) {
  if (!f.image) {
    f.image = new Image();
    f.ready = new Promise((resolve, reject) => {
      f.image.onload = () => { resolve(); draw(); };
      f.image.onerror = () => reject(new Error(`the cost-to-go of step ${f.step} does not load`));
    });
    f.image.src = `data:image/png;base64,${f.png}`;
  }
  if (!(f.image.complete && f.image.naturalWidth > 0)) return null;
  if (tinted.field === f && tinted.dark === dark) return tinted.canvas;
  tinted = { field: f, dark, canvas: make("canvas", { width: f.width, height: f.height }) };
  const context = tinted.canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(f.image, 0, 0);
  const image = context.getImageData(0, 0, f.width, f.height);
  // Near is light on dark and dark on light: what stands out is where the robot is drawn to.
  const lookUp = Array.from({ length: 256 }, (_, v) => scaleColor((v - 1) / 254));
  for (let i = 0; i < image.data.length; i += 4) {
    const value = image.data[i];
    if (value > 0) image.data.set(lookUp[value], i);
    image.data[i + 3] = value > 0 ? 190 : 0;
  }
  context.putImageData(image, 0, 0);
  return tinted.canvas;
}

const view = { x: 0, y: 0, scale: 40, follow: false, touched: false };
let boxWidth = 0, boxHeight = 0;
const toScreen = (x, y) => [boxWidth / 2 + (x - view.x) * view.scale, boxHeight / 2 - (y - view.y) * view.scale];
const limit = (scale) => Math.min(2000, Math.max(0.5, scale));

function fit() {
  let left = Infinity, right = -Infinity, low = Infinity, high = -Infinity;
  const include = (x, y, margin) => {
    if (!(isNumber(x) && isNumber(y))) return;
    left = Math.min(left, x - margin); right = Math.max(right, x + margin);
    low = Math.min(low, y - margin); high = Math.max(high, y + margin);
  };
  for (let k = 0; k < n; ++k) {
    include(column.estimated_x[k], column.estimated_y[k], 0.5);
    include(column.true_x[k], column.true_y[k], 0.5);
  }
  if (width > 0) { include(i0 * r, j0 * r, 0); include((i0 + width) * r, (j0 + height) * r, 0); }
  if (left > right) { left = low = -2; right = high = 2; }
  view.x = (left + right) / 2; view.y = (low + high) / 2;
  view.scale = limit(Math.min((boxWidth - 48) / (right - left), (boxHeight - 48) / (high - low)));
  view.follow = view.touched = false;
  $("follow").setAttribute("aria-pressed", "false");
}
function zoom(factor, sx = boxWidth / 2, sy = boxHeight / 2) {
  const scale = limit(view.scale * factor);
  const wx = (sx - boxWidth / 2) / view.scale, wy = (boxHeight / 2 - sy) / view.scale;
  const keep = 1 - view.scale / scale;
  view.x += wx * keep; view.y += wy * keep;
  view.scale = scale; view.touched = true;
  draw();
}

// How far the sensor sees along each ray, given the cells known to be occupied.
function viewPolygon(x, y, yaw) {
  const rays = Math.max(90, Math.ceil(run.sensor_fov / 0.014)), points = [];
  for (let i = 0; i <= rays; ++i) {
    const angle = yaw + run.sensor_fov * (i / rays - 0.5);
    const dx = Math.cos(angle), dy = Math.sin(angle);
    let distance = 0;
    for (; distance < run.sensor_range; distance += r / 2) {
      const column = Math.floor((x + distance * dx) / r) - i0, row = Math.floor((y + distance * dy) / r) - j0;
      if (column >= 0 && column < width && row >= 0 && row < height && ground[row * width + column] === 2) break;
    }
    distance = Math.min(distance, run.sensor_range);
    points.push([x + distance * dx, y + distance * dy]);
  }
  return points;
}
function trace(points) {
  pen.beginPath();
  points.forEach(([x, y], i) => { const [sx, sy] = toScreen(x, y); if (i) pen.lineTo(sx, sy); else pen.moveTo(sx, sy); });
}
function path(xs, ys, last, color, lineWidth) {
  pen.beginPath();
  let down = false;
  for (let k = 0; k <= last; ++k) {
    if (!(isNumber(xs[k]) && isNumber(ys[k]))) { down = false; continue; }
    const [sx, sy] = toScreen(xs[k], ys[k]);
    if (down) pen.lineTo(sx, sy); else pen.moveTo(sx, sy);
    down = true;
  }
  pen.strokeStyle = color; pen.lineWidth = lineWidth; pen.stroke();
}
// The path so far in the colours of what is chosen; each piece has the colour of the step where it ends.
function coloredPath(xs, ys, last, by) {
  path(xs, ys, last, colors.halo, 5);
  pen.lineWidth = 3;
  for (let k = 1; k <= last; ++k) {
    if (![xs[k - 1], ys[k - 1], xs[k], ys[k]].every(isNumber)) continue;
    pen.beginPath();
    pen.moveTo(...toScreen(xs[k - 1], ys[k - 1]));
    pen.lineTo(...toScreen(xs[k], ys[k]));
    pen.strokeStyle = by.values ? `rgb(${scaleColor(by.values[k] / by.end).join(",")})` : modeColor(word.mode[k]);
    pen.stroke();
  }
}
// What the colours on the map mean, where they are quantities or modes.
let legendShown = "";
function legend(by, field) {
  const shown = [pathColor.value, layers.estimated, dark, field ? field.step : ""].join();
  if (shown === legendShown) return;
  legendShown = shown;
  const rows = [];
  const scale = (label, low, high) => rows.push(make("div", {}, make("b", {}, label), make("span", { class: "scale" }, low, make("i", { style: `background:${scaleGradient()}` }), high)));
  if (layers.estimated && by?.values) scale(by.label, by.text(0), (by.open ? "≥ " : "") + by.text(by.end));
  if (layers.estimated && by && !by.values) {
    rows.push(make("div", {}, ...[...new Set(word.mode)].filter(Boolean).map((mode) => make("span", { class: "key" }, make("i", { style: `background:${modeColor(mode)}` }), mode))));
  }
  if (field) scale(`time to the target, as of ${fixed(column.time[field.step], 1)} s`, "0 s", `${fixed(field.most, 0)} s`);
  $("map-legend").replaceChildren(...rows);
  $("map-legend").hidden = rows.length === 0;
}
function label(text, sx, sy, color) {
  pen.font = getComputedStyle(document.body).font.replace(/\d+px/, "12px");
  pen.textAlign = sx > boxWidth - 90 ? "right" : "left"; pen.textBaseline = "middle";
  const x = sx + (pen.textAlign === "left" ? 12 : -12);
  pen.strokeStyle = colors.halo; pen.lineWidth = 3.5; pen.strokeText(text, x, sy);
  pen.fillStyle = color; pen.fillText(text, x, sy);
}
// What it was told of the ground: keep-outs hatched, slow zones tinted with their limit, the bound
// and the area to explore as lines.
function outline(corners) {
  trace(corners.map((p) => fromMap(p, step)));
  pen.closePath();
}
function drawZones() {
  const keepOut = `rgb(${colors["keep-out"]})`, slow = `rgb(${colors.slow})`;
  const note = (text, corners, color) => {
    const [x, y] = corners.reduce((sum, p) => [sum[0] + p[0] / corners.length, sum[1] + p[1] / corners.length], [0, 0]);
    const [sx, sy] = toScreen(...fromMap([x, y], step));
    pen.font = getComputedStyle(document.body).font.replace(/\d+px/, "12px");
    pen.textAlign = "center"; pen.textBaseline = "middle";
    pen.strokeStyle = colors.halo; pen.lineWidth = 3.5; pen.strokeText(text, sx, sy);
    pen.fillStyle = color; pen.fillText(text, sx, sy);
  };
  for (const { area, max_speed: limit } of zones.slow) {
    outline(area);
    pen.fillStyle = `rgba(${colors.slow}, 0.16)`; pen.fill();
    pen.strokeStyle = slow; pen.lineWidth = 1.25; pen.stroke();
    note(`${fixed(limit, 2)} m/s`, area, slow);
  }
  for (const area of zones.keep_out) {
    const points = area.map((p) => toScreen(...fromMap(p, step)));
    pen.save();
    outline(area);
    pen.clip();
    pen.fillStyle = `rgba(${colors["keep-out"]}, 0.14)`; pen.fill();
    const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]);
    const left = Math.max(-boxHeight, Math.min(...xs) - (Math.max(...ys) - Math.min(...ys))), right = Math.min(boxWidth, Math.max(...xs));
    const top = Math.min(...ys), bottom = Math.max(...ys);
    pen.beginPath();
    for (let x = Math.floor(left / 9) * 9; x < right; x += 9) { pen.moveTo(x, bottom); pen.lineTo(x + bottom - top, top); }
    pen.strokeStyle = `rgba(${colors["keep-out"]}, 0.55)`; pen.lineWidth = 1; pen.stroke();
    pen.restore();
    outline(area);
    pen.strokeStyle = keepOut; pen.lineWidth = 1.75; pen.stroke();
  }
  for (const [corners, color, dash] of [[zones.area, colors.frontier, [7, 5]], [zones.bound, keepOut, []]]) {
    if (!corners) continue;
    pen.setLineDash(dash);
    outline(corners);
    pen.strokeStyle = color; pen.lineWidth = 1.75; pen.stroke();
    pen.setLineDash([]);
  }
}
// A flag at the goal, and the heading that was asked for.
function drawGoal() {
  const x = column.goal_x[step], y = column.goal_y[step], yaw = column.goal_yaw[step];
  if (!(isNumber(x) && isNumber(y))) return false;
  const [sx, sy] = toScreen(x, y);
  for (const [color, extra] of [[colors.halo, 2.5], [colors.target, 0]]) {
    pen.strokeStyle = color; pen.lineWidth = 2 + extra;
    if (isNumber(yaw)) { pen.beginPath(); pen.moveTo(sx, sy); pen.lineTo(sx + 26 * Math.cos(yaw), sy - 26 * Math.sin(yaw)); pen.stroke(); }
    pen.beginPath(); pen.moveTo(sx, sy); pen.lineTo(sx, sy - 22); pen.stroke();
    pen.beginPath(); pen.arc(sx, sy, 3 + extra / 2, 0, 2 * Math.PI); pen.fillStyle = color; pen.fill();
    pen.beginPath(); pen.moveTo(sx, sy - 22); pen.lineTo(sx + 14, sy - 17); pen.lineTo(sx, sy - 12); pen.closePath();
    pen.fill(); if (extra) pen.stroke();
  }
  label(word.task[step] === "return" ? "start" : "goal", sx, sy, colors.target);
  return true;
}
// Where the map had the robot when it was there, as the map is now: it parts from the path at each correction.
function drawCorrections() {
  const told = Array.from({ length: step + 1 }, (_, k) => fromMap(toMap([column.estimated_x[k], column.estimated_y[k]], k), step));
  pen.setLineDash([4, 4]);
  path(told.map((p) => p[0]), told.map((p) => p[1]), step, colors.warn, 1.5);
  pen.setLineDash([]);
  for (let k = 0; k <= step; ++k) {
    if (!isNumber(column.corrected_by[k])) continue;
    const [sx, sy] = toScreen(column.estimated_x[k], column.estimated_y[k]);
    // A correction is told where it can be seen at this zoom: a robot straightens its map by a centimetre all the time.
    const seen = view.scale * column.corrected_by[k] >= 8 || Math.abs(column.corrected_turn[k]) >= 2 * Math.PI / 180;
    pen.beginPath(); pen.arc(sx, sy, seen ? 4 : 2, 0, 2 * Math.PI); pen.fillStyle = colors.warn; pen.fill();
    if (seen) label(correctionText(k), sx, sy, colors.warn);
  }
}
const correctionText = (k) => `${fixed(column.corrected_by[k], 2)} m, ${fixed(column.corrected_turn[k] * 180 / Math.PI, 1)}°`;
// Where the robot goes: a line to the viewpoint, and from there to what it will see.
function drawTarget() {
  const x = column.target_x[step], y = column.target_y[step];
  if (!(isNumber(x) && isNumber(y))) return false;
  const from = toScreen(column.estimated_x[step], column.estimated_y[step]), at = toScreen(x, y);
  const line = (points, dash, width) => {
    for (const [color, extra] of [[colors.halo, 2.5], [colors.target, 0]]) {
      pen.setLineDash(dash);
      pen.beginPath(); pen.moveTo(...points[0]); pen.lineTo(...points[1]);
      pen.strokeStyle = color; pen.lineWidth = width + extra; pen.stroke();
    }
    pen.setLineDash([]);
  };
  line([from, at], [2, 6], 1.75);
  if (isNumber(column.looks_x[step]) && isNumber(column.looks_y[step])) {
    const seen = toScreen(column.looks_x[step], column.looks_y[step]);
    const dx = seen[0] - at[0], dy = seen[1] - at[1], length = Math.hypot(dx, dy);
    if (length > 14) {  // an arrow, as a look has a direction
      line([at, seen], [], 1.5);
      pen.beginPath();
      for (const [forward, side] of [[0, 0], [-9, 4], [-9, -4]]) {
        pen.lineTo(seen[0] + (forward * dx - side * dy) / length, seen[1] + (forward * dy + side * dx) / length);
      }
      pen.closePath(); pen.fillStyle = colors.target; pen.fill();
    }
  }
  for (const [color, width] of [[colors.halo, 6], [colors.target, 3]]) {
    pen.beginPath(); pen.arc(...at, 7, 0, 2 * Math.PI);
    pen.strokeStyle = color; pen.lineWidth = width; pen.stroke();
  }
  pen.beginPath(); pen.arc(...at, 2, 0, 2 * Math.PI); pen.fillStyle = colors.target; pen.fill();
  const atGoal = layers.zones && Math.hypot(x - column.goal_x[step], y - column.goal_y[step]) < 0.3;
  if (!atGoal) label("target", ...at, colors.target);
  return true;
}
// Frontiers by number in the order of the sequence, joined by it; the others as small rings.
function drawOrder() {
  const { list } = standingsAt(step), ordered = list.filter(({ why }) => why === "in order");
  const ring = (f, radius, width) => {
    const [sx, sy] = toScreen(f.x, f.y);
    for (const [color, extra] of [[colors.halo, 2.5], [colors.frontier, 0]]) {
      pen.beginPath(); pen.arc(sx, sy, radius, 0, 2 * Math.PI);
      pen.strokeStyle = color; pen.lineWidth = width + extra; pen.stroke();
    }
  };
  for (const f of list) if (f.why !== "in order") ring(f, 3, 1.25);
  pen.setLineDash([1, 5]);
  trace(ordered.map(({ x, y }) => [x, y]));
  pen.strokeStyle = colors.frontier; pen.lineWidth = 2; pen.stroke();
  pen.setLineDash([]);
  ordered.forEach((f, i) => {
    const [sx, sy] = toScreen(f.x, f.y);
    pen.beginPath(); pen.arc(sx, sy, 9, 0, 2 * Math.PI);
    pen.fillStyle = colors.halo; pen.fill();
    pen.strokeStyle = colors.frontier; pen.lineWidth = 2; pen.stroke();
    pen.font = getComputedStyle(document.body).font.replace(/\d+px/, "11px");
    pen.textAlign = "center"; pen.textBaseline = "middle";
    pen.fillStyle = colors.ink; pen.fillText(String(i + 1), sx, sy + 0.5);
  });
  const f = list[pointedFrontier];
  if (f) {
    ring(f, 11, 3);
    label(`${f.why}, ${rounded(f.area)} m²`, ...toScreen(f.x, f.y), colors.ink);
  }
  return list.length;
}
// What moves by itself: a disc as large as it is, an arrow to where it is in a second.
function drawMovers() {
  for (const [x, y, vx, vy, size] of movers[step]) {
    const [sx, sy] = toScreen(x, y), [ax, ay] = toScreen(x + vx, y + vy), length = Math.hypot(ax - sx, ay - sy);
    for (const [color, extra] of [[colors.halo, 2.5], [colors.mover, 0]]) {
      pen.strokeStyle = pen.fillStyle = color; pen.lineWidth = 2 + extra;
      pen.beginPath(); pen.arc(sx, sy, Math.max(4, size * view.scale), 0, 2 * Math.PI); pen.stroke();
      if (length < 8) continue;  // it stands
      pen.beginPath(); pen.moveTo(sx, sy); pen.lineTo(ax, ay); pen.stroke();
      pen.beginPath();
      for (const [forward, side] of [[2, 0], [-7, 4], [-7, -4]]) {
        pen.lineTo(ax + (forward * (ax - sx) - side * (ay - sy)) / length, ay + (forward * (ay - sy) + side * (ax - sx)) / length);
      }
      pen.closePath(); pen.fill();
    }
  }
  return movers[step].length;
}
function drawCandidate(c, color, width) {
  trace(c.path);
  pen.strokeStyle = colors.halo; pen.lineWidth = width + 2.5; pen.stroke();
  pen.strokeStyle = color; pen.lineWidth = width; pen.stroke();
}
function scaleBar() {
  const wanted = 110 / view.scale;
  const unit = 10 ** Math.floor(Math.log10(wanted));
  const metres = [5, 2, 1].map((m) => m * unit).find((m) => m <= wanted);
  const length = metres * view.scale, x = 18, y = boxHeight - 18;
  pen.beginPath(); pen.moveTo(x, y - 5); pen.lineTo(x, y); pen.lineTo(x + length, y); pen.lineTo(x + length, y - 5);
  pen.strokeStyle = colors.halo; pen.lineWidth = 4; pen.stroke();
  pen.strokeStyle = colors["ink-2"]; pen.lineWidth = 1.5; pen.stroke();
  const label = metres >= 1 ? `${metres} m` : `${Math.round(metres * 100)} cm`;
  pen.font = getComputedStyle(document.body).font.replace(/\d+px/, "12px");
  pen.textAlign = "left"; pen.textBaseline = "alphabetic";
  pen.strokeStyle = colors.halo; pen.lineWidth = 3; pen.strokeText(label, x + 6, y - 6);
  pen.fillStyle = colors["ink-2"]; pen.fillText(label, x + 6, y - 6);
}

let pose = null;                 // where the robot is by now, which a mission that goes on says between two steps
function draw() {
  if (step < 0 || !boxWidth) return;
  const at = pose && step === n - 1 ? pose : { x: column.estimated_x[step], y: column.estimated_y[step], yaw: column.estimated_yaw[step] };
  const { x, y, yaw } = at;
  if (view.follow) { view.x = x; view.y = y; }
  const density = devicePixelRatio || 1;
  pen.setTransform(density, 0, 0, density, 0, 0);
  pen.fillStyle = colors["map-unknown"];
  pen.fillRect(0, 0, boxWidth, boxHeight);
  pen.lineJoin = pen.lineCap = "round";

  if (width > 0) {
    const [left, top] = toScreen(i0 * r, (j0 + height) * r);
    pen.imageSmoothingEnabled = view.scale * r < 1;
    pen.drawImage(picture, left, top, width * r * view.scale, height * r * view.scale);
  }
  const field = layers["cost-to-go"] ? fieldAt(step) : null, tint = field && tintedField(field);
  if (tint) {
    const [left, top] = toScreen(field.x, field.y + field.height * field.size);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(tint, left, top, field.width * field.size * view.scale, field.height * field.size * view.scale);
  }
  if (layers.zones) drawZones();
  if (layers.view) {
    const allRound = run.sensor_fov > 2 * Math.PI - 0.06;  // no edges to draw from where it stands
    trace([...(allRound ? [] : [[x, y]]), ...viewPolygon(x, y, yaw)]);
    pen.closePath();
    pen.fillStyle = `rgba(${colors.view}, 0.13)`; pen.fill();
    pen.strokeStyle = `rgba(${colors.view}, 0.35)`; pen.lineWidth = 1; pen.stroke();
  }
  if (layers.frontiers) {
    pen.fillStyle = colors.frontier;
    const size = Math.max(2.5, r * view.scale), inset = (r * view.scale - size) / 2;
    for (const cell of frontier) {
      const [sx, sy] = toScreen(columnOf(cell) * r, (rowOf(cell) + 1) * r);
      pen.fillRect(sx + inset, sy + inset, size, size);
    }
  }
  if (layers.landmarks) {
    const { index, visibility } = landmarks[step];
    const radius = Math.min(4, Math.max(1.7, 0.05 * view.scale));
    const order = Array.from(index.keys()).sort((a, b) => visibility[a] - visibility[b]);
    for (const i of order) {
      const [sx, sy] = toScreen(landmarkPositions[2 * index[i]], landmarkPositions[2 * index[i] + 1]);
      pen.beginPath(); pen.arc(sx, sy, radius, 0, 2 * Math.PI);
      pen.fillStyle = colors.visibility[visibility[i]]; pen.fill();
    }
  }
  if (layers.true) path(column.true_x, column.true_y, step, colors.true, 1.25);
  if (layers.corrected && column.corrections[step] > 0) drawCorrections();
  const by = pathColors[pathColor.value];
  if (layers.estimated && by) coloredPath(column.estimated_x, column.estimated_y, step, by);
  else if (layers.estimated) path(column.estimated_x, column.estimated_y, step, colors.estimated, 2);
  legend(by, tint ? field : null);
  const moving = layers.movers ? drawMovers() : 0;
  const standing = layers.order ? drawOrder() : 0;
  const target = layers.target && drawTarget();
  const goal = layers.zones && drawGoal();
  if (layers.candidates) for (const c of candidates[step]) if (c.verdict !== "executed") drawCandidate(c, colors["ink-3"], 1.25);
  if (layers.horizon) {
    const points = horizons[step].filter(([px, py]) => isNumber(px) && isNumber(py));
    trace(points);
    pen.strokeStyle = colors.halo; pen.lineWidth = 5; pen.stroke();
    pen.strokeStyle = colors.horizon; pen.lineWidth = 2.5; pen.stroke();
    pen.fillStyle = colors.horizon;
    for (const [px, py] of points) {
      const [sx, sy] = toScreen(px, py);
      pen.beginPath(); pen.arc(sx, sy, 2.4, 0, 2 * Math.PI); pen.fill();
    }
    if (points.length > 1) {  // an arrowhead for the last heading
      const [px, py, angle] = points[points.length - 1], [sx, sy] = toScreen(px, py);
      pen.beginPath();
      for (const [forward, side] of [[9, 0], [-3, 5], [-3, -5]]) {
        pen.lineTo(sx + forward * Math.cos(angle) - side * Math.sin(angle), sy - forward * Math.sin(angle) - side * Math.cos(angle));
      }
      pen.closePath(); pen.fill();
    }
  }
  if (pointed !== null && candidates[step][pointed]) {
    const c = candidates[step][pointed];
    drawCandidate(c, colors.ink, 2.5);
    if (c.path.length) label(readable(c.name), ...toScreen(...c.path[c.path.length - 1]), colors.ink);
  }
  // The robot: a ring where it is, a disc with its heading where it believes to be.
  const radius = Math.max(6, run.robot_radius * view.scale);
  if (layers.true && at !== pose) {  // what is true is known at steps alone
    const [sx, sy] = toScreen(column.true_x[step], column.true_y[step]);
    pen.beginPath(); pen.arc(sx, sy, radius, 0, 2 * Math.PI);
    pen.strokeStyle = colors.true; pen.lineWidth = 1.5; pen.stroke();
  }
  const [sx, sy] = toScreen(x, y);
  pen.beginPath(); pen.arc(sx, sy, radius, 0, 2 * Math.PI);
  pen.fillStyle = colors.estimated; pen.fill();
  pen.beginPath();
  for (const [forward, side] of [[0.75, 0], [-0.45, 0.5], [-0.2, 0], [-0.45, -0.5]]) {
    pen.lineTo(sx + radius * (forward * Math.cos(yaw) - side * Math.sin(yaw)), sy - radius * (forward * Math.sin(yaw) + side * Math.cos(yaw)));
  }
  pen.closePath(); pen.fillStyle = colors.halo; pen.fill();
  scaleBar();
  Object.assign(drawn, { target, goal, field: tint ? field.step : null, x, y, yaw, sx, sy, radius, frontiers: frontier.size, movers: moving, standing, landmarks: landmarks[step].index.length, horizon: horizons[step].length });
}

function resize() {
  const box = $("map-box").getBoundingClientRect();
  const density = devicePixelRatio || 1;
  boxWidth = box.width; boxHeight = box.height;
  canvas.width = Math.round(boxWidth * density); canvas.height = Math.round(boxHeight * density);
  if (!view.touched) { const follow = view.follow; if (!follow) fit(); }
  draw();
}

const pointers = new Map();
canvas.addEventListener("pointerdown", (e) => {
  canvas.setPointerCapture(e.pointerId);
  pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
  canvas.classList.add("dragging");
});
canvas.addEventListener("pointermove", (e) => {
  const from = pointers.get(e.pointerId);
  if (!from) return;
  const others = [...pointers].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
  if (others.length) {
    const [ox, oy] = others[0];
    const before = Math.hypot(from[0] - ox, from[1] - oy), after = Math.hypot(e.offsetX - ox, e.offsetY - oy);
    if (before > 0 && after > 0) zoom(after / before, ox, oy);
  } else {
    view.x -= (e.offsetX - from[0]) / view.scale; view.y += (e.offsetY - from[1]) / view.scale;
    view.touched = true; setFollow(false);
    draw();
  }
  pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
});
for (const type of ["pointerup", "pointercancel"]) {
  canvas.addEventListener(type, (e) => { pointers.delete(e.pointerId); if (!pointers.size) canvas.classList.remove("dragging"); });
}
canvas.addEventListener("wheel", (e) => {
  e.preventDefault();
  zoom(Math.exp(-Math.max(-60, Math.min(60, e.deltaY * (e.deltaMode ? 20 : 1))) * 0.004), e.offsetX, e.offsetY);
}, { passive: false });
canvas.addEventListener("dblclick", () => { fit(); draw(); });
function setFollow(on) {
  view.follow = on;
  $("follow").setAttribute("aria-pressed", String(on));
}
$("zoom-in").addEventListener("click", () => zoom(1.4));
$("zoom-out").addEventListener("click", () => zoom(1 / 1.4));
$("fit").addEventListener("click", () => { fit(); draw(); });
$("follow").addEventListener("click", () => { setFollow(!view.follow); view.touched = true; draw(); });

// ---- Plots ------------------------------------------------------------------------------------
const plots = [];
let sharedWindow = null, aligning = false;

function addPlot(title, unit, series, { format = rounded, low = null, high = null, range = null, shade = null, fill = false, small = false, last = true } = {}) {
  const labels = make("div", { class: "series" }), note = make("em", {}, unit);
  const area = make("div"), cursor = make("div", { class: "cursor" });
  const box = make("div", { class: small ? `plot small${last ? " last" : ""}` : "plot" },
    make("h3", {}, make("span", {}, title, note), labels), make("div", { class: "area" }, area, cursor));
  $("plots").append(box);
  const values = series.map(({ name, color }) => {
    const value = make("b");
    const label = make("span", {}, ...(series.length > 1 ? [make("i", { style: `background:${color}` }), name] : []), value);
    labels.append(label);
    return { value, label };
  });
  const resolved = () => series.map(({ color }) => (color.startsWith("var(") ? getComputedStyle(document.documentElement).getPropertyValue(color.slice(4, -1)).trim() : color));
  const data = [];
  const fillData = () => { for (let k = data.length; k < n; ++k) data.push([column.time[k], ...series.map(({ values }) => (isNumber(values[k]) ? values[k] : null))]); };
  // What depends on all values: the range that is shown, one point alone, which spans nothing, and what is said of peaks.
  const bounds = () => {
    const limits = range ? range() : { low, high, peak: unit };
    note.textContent = limits.peak;
    return { valueRange: [limits.low, limits.high], dateWindow: sharedWindow || (n === 1 ? [column.time[0] - 1, column.time[0] + 1] : null) };
  };
  fillData();
  let graph = null;  // drawCallback already runs inside the constructor
  graph = new Dygraph(area, data, {
    labels: ["time", ...series.map(({ name }) => name)],
    colors: resolved(), strokeWidth: 1.5, fillGraph: fill, fillAlpha: 0.1,
    legend: "never", labelsDiv: make("div"), highlightCircleSize: 3, gridLineColor: colors.grid, axisLineColor: colors.line, axisLineWidth: 1,
    rightGap: 10, xRangePad: 2, yRangePad: small ? 3 : 6, xAxisHeight: last ? 20 : 2, digitsAfterDecimal: 4,
    ...bounds(),
    axes: {
      x: { drawGrid: false, drawAxis: last, pixelsPerLabel: 64, axisLabelFormatter: (v) => `${+v.toFixed(3)} s`, axisLabelWidth: 60 },
      y: { pixelsPerLabel: small ? 16 : 22, axisLabelWidth: 44, axisLabelFormatter: (v) => (Math.abs(v) >= 1e5 ? v.toExponential(0) : String(+v.toPrecision(6))).replace("-", "−") },
    },
    underlayCallback: shade && ((context, chart, g) => {
      for (let k = 0; k < n; ++k) {
        const color = shade(k);
        if (!color) continue;
        const start = g.toDomXCoord(column.time[k]);
        const end = k + 1 < n ? g.toDomXCoord(column.time[k + 1]) : start + 2;
        context.fillStyle = colors[color];
        context.fillRect(start, chart.y, Math.max(1, end - start), chart.h);
      }
    }),
    clickCallback: (e, time) => seek(nearest(time)),
    highlightCallback: (e, time, points, row) => show(row),
    unhighlightCallback: () => show(step),
    drawCallback: (g, first) => {
      if (graph === plots[0]?.graph) drawStrip();
      if (first || aligning) { place(); return; }
      aligning = true;
      const [from, to] = g.xAxisRange();
      // All of it stays all of it as the mission goes on.
      sharedWindow = from <= column.time[0] && to >= column.time[n - 1] ? null : [from, to];
      for (const other of plots) if (other.graph !== g) other.graph.updateOptions({ dateWindow: [from, to] });
      aligning = false;
      place();
    },
  });
  function place() {
    if (!graph || step < 0) return;
    const at = graph.toDomXCoord(column.time[step]);
    const plotArea = graph.getArea();
    cursor.style.display = at >= plotArea.x - 1 && at <= plotArea.x + plotArea.w + 1 ? "" : "none";
    cursor.style.transform = `translateX(${at.toFixed(1)}px)`;
    cursor.style.top = `${plotArea.y}px`; cursor.style.height = `${plotArea.h}px`; cursor.style.bottom = "auto";
  }
  function show(k) { series.forEach(({ values: column }, i) => { values[i].value.textContent = format(column[k]); }); }
  function extend() {
    fillData();
    aligning = true;
    graph.updateOptions({ file: data, ...bounds() });
    aligning = false;
  }
  plots.push({ graph, place, show, cursor, extend, recolor: () => graph.updateOptions({ colors: resolved(), gridLineColor: colors.grid, axisLineColor: colors.line }) });
}
// The range of a term without its peaks, and what to say of them.
function withoutPeaks(values) {
  const sorted = ascending(values);
  if (!sorted.length) return { low: null, high: null, peak: "" };
  const rank = (share) => sorted[Math.max(0, Math.ceil(share * sorted.length) - 1)];
  const low = rank(0.02), high = rank(0.98), room = (high - low) || Math.abs(high) || 1;
  const bottom = sorted[0], top = sorted[sorted.length - 1];
  const cutTop = top > high + 2 * room, cutBottom = bottom < low - 2 * room;
  const when = (value) => `${compact(value)} at ${fixed(column.time[values.indexOf(value)], 1)} s`;
  const peaks = [...(cutTop ? [`peak ${when(top)}`] : []), ...(cutBottom ? [`dip ${when(bottom)}`] : [])];
  if (top === bottom) return { low: top - 0.5 * room, high: top + 0.5 * room, peak: "" };
  return { low: cutBottom ? low - 0.5 * room : bottom, high: cutTop ? high + 0.5 * room : top, peak: peaks.join(", ") };
}

// ---- Modes over time --------------------------------------------------------------------------
// Stretches of steps in one mode with one cause.
const stretches = [];
function addStretches() {
  if (!hasModes) return;
  for (let k = stretches.length ? stretches[stretches.length - 1].end + 1 : 0; k < n; ++k) {
    const current = stretches[stretches.length - 1];
    if (current && current.mode === word.mode[k] && current.cause === word.cause[k] && current.caution === word.caution[k]) current.end = k;
    else stretches.push({ mode: word.mode[k], cause: word.cause[k], caution: word.caution[k], start: k, end: k });
  }
}
const careful = (caution) => caution !== "" && caution !== "normal";
const stretchEnd = (stretch) => column.time[Math.min(n - 1, stretch.end + 1)];
let strip = null;
function makeStrip() {
  if (!hasModes || strip) return;
  const keys = make("div", { class: "series" });
  const share = () => {
    const counts = new Map();
    for (let k = 0; k < n; ++k) counts.set(word.mode[k], (counts.get(word.mode[k]) || 0) + 1);
    keys.replaceChildren(...[...counts].sort((a, b) => b[1] - a[1]).map(([mode, count]) =>
      make("span", {}, make("i", { style: `background:${modeColor(mode)}` }), `${mode || "none"} ${Math.max(1, Math.round(100 * count / n))} %`)));
  };
  const sheet = make("canvas", { role: "img", "aria-label": "Modes over time" });
  const cursor = make("div", { class: "cursor" }), note = make("div", { class: "tip" });
  note.hidden = true;
  const box = make("div", { class: "area" }, sheet, cursor, note);
  $("plots").append(make("div", { class: "plot modes" }, make("h3", {}, make("span", {}, "What the robot does", make("em", {}, "mode, share of the time")), keys), box));
  // The stretch at the pointer, and its time there.
  const at = (e) => {
    const time = plots[0].graph.toDataXCoord(e.clientX - box.getBoundingClientRect().left);
    const k = nearest(time);
    return { k, stretch: stretches.find((t) => t.start <= k && k <= t.end) };
  };
  box.addEventListener("click", (e) => seek(at(e).k));
  box.addEventListener("pointermove", (e) => {
    const { stretch } = at(e);
    note.replaceChildren(make("b", {}, stretch.mode || "no mode"), ...(stretch.cause ? [`: ${stretch.cause}`] : []), ...(careful(stretch.caution) ? [`, ${stretch.caution}`] : []),
      make("br"), `${fixed(column.time[stretch.start], 1)} to ${fixed(stretchEnd(stretch), 1)} s`);
    note.hidden = false;
    const room = box.clientWidth - note.offsetWidth;
    note.style.left = `${Math.max(0, Math.min(room, e.clientX - box.getBoundingClientRect().left - note.offsetWidth / 2))}px`;
  });
  box.addEventListener("pointerleave", () => { note.hidden = true; });
  strip = { box, sheet, cursor, share };
  share();
}
function drawStrip() {
  if (!strip || !plots.length) return;
  const { graph } = plots[0], density = devicePixelRatio || 1;
  const w = strip.box.clientWidth, h = strip.box.clientHeight, area = graph.getArea();
  strip.sheet.width = Math.round(w * density); strip.sheet.height = Math.round(h * density);
  const context = strip.sheet.getContext("2d");
  context.scale(density, density);
  context.beginPath(); context.rect(area.x, 0, area.w, h); context.clip();
  context.font = getComputedStyle(document.body).font.replace(/\d+px/, "11px");
  context.textBaseline = "middle";
  const top = 0, band = h - 6;
  for (const stretch of stretches) {
    const left = graph.toDomXCoord(column.time[stretch.start]), right = Math.max(left + 1, graph.toDomXCoord(stretchEnd(stretch)));
    context.fillStyle = modeColor(stretch.mode);
    context.fillRect(left, top, right - left, band);
    if (careful(stretch.caution)) {
      context.fillStyle = stretch.caution === "lost" ? colors.bad : colors.warn;
      context.fillRect(left, band + 2, right - left, 4);
    }
  }
  // Names where they fit; stretches of one mode that follow each other are one to the eye.
  for (let i = 0; i < stretches.length;) {
    let j = i;
    while (j + 1 < stretches.length && stretches[j + 1].mode === stretches[i].mode) ++j;
    const left = Math.max(area.x, graph.toDomXCoord(column.time[stretches[i].start])), right = Math.min(area.x + area.w, graph.toDomXCoord(stretchEnd(stretches[j])));
    const { mode } = stretches[i];
    if (right - left > context.measureText(mode).width + 10) { context.fillStyle = "#ffffff"; context.fillText(mode, left + 5, top + band / 2 + 0.5); }
    i = j + 1;
  }
  placeStrip();
}
function placeStrip() {
  if (!strip || !plots.length || step < 0) return;
  const { graph } = plots[0], area = graph.getArea(), x = graph.toDomXCoord(column.time[step]);
  strip.cursor.style.display = x >= area.x - 1 && x <= area.x + area.w + 1 ? "" : "none";
  strip.cursor.style.transform = `translateX(${x.toFixed(1)}px)`;
}

function nearest(time) {
  let best = 0;
  for (let k = 1; k < n; ++k) if (Math.abs(column.time[k] - time) < Math.abs(column.time[best] - time)) best = k;
  return best;
}

// ---- The step that is shown -------------------------------------------------------------------
const nowFields = (() => {
  const fields = [];
  // A field is there where there is something to say.
  const add = (label, text, { there = () => true, full, wide, tone } = {}) => {
    const dd = make("dd"), box = make("div", full ? { class: "full" } : wide ? { class: "wide" } : {}, make("dt", {}, label), dd);
    $("now").append(box);
    fields.push((k) => {
      box.hidden = !there();
      if (box.hidden) return;
      dd.textContent = dd.title = text(k); dd.className = tone ? tone(k) : "";
    });
  };
  const modes = () => hasModes;
  add("Mode", (k) => {
    const since = column.mode_since[k], cause = word.cause[k];
    return `${word.mode[k] || "–"}${isNumber(since) ? ` since ${fixed(since, 1)} s` : ""}${cause ? `: ${cause}` : ""}`;
  }, { there: modes, wide: true, tone: (k) => (word.mode[k] === "retreat" ? "warn" : "") });
  add("Task", (k) => word.task[k] + (isNumber(column.goal_x[k]) ? ` (${fixed(column.goal_x[k], 2)}, ${fixed(column.goal_y[k], 2)})` : ""),
    { there: () => hasModes && word.task.some((task) => task && task !== "explore") });
  add("Target", (k) => {
    if (!isNumber(column.target_x[k])) return "none";
    if (isNumber(column.goal_x[k])) return isNumber(column.way_left[k]) ? `${fixed(column.way_left[k], 1)} m of way` : "no way known";
    const way = isNumber(column.way_left[k]) ? `${fixed(column.way_left[k], 1)} m away` : "no way known";
    const change = word.target_change[k] ? `; new: ${word.target_change[k]}` : "";
    return `${way}, frontier of ${fixed(column.target_length[k], 1)} m, promises ${fixed(column.target_area[k], 1)} m²${change}`;
  }, { there: modes, wide: true });
  add("Map corrected", (k) => (isNumber(column.corrected_by[k]) ? `by ${correctionText(k)}: ${word.corrected_why[k]}`
    : isNumber(column.corrections[k]) ? plural(column.corrections[k], "time") : "not yet") + (column.corrections_refused[k] > 0 ? `, ${column.corrections_refused[k]} refused` : ""),
    { there: () => column.map_x.some(isNumber), wide: true, tone: (k) => (isNumber(column.corrected_by[k]) ? "warn" : "") });
  add("Safety level", (k) => word.caution[k] || "–", { there: modes, tone: (k) => (careful(word.caution[k]) ? "warn" : "") });
  add("Coverage", (k) => `${percent(column.coverage[k])} %, ${fixed(column.area[k], 1)} m²`);
  add("Path", (k) => `${fixed(column.path_length[k], 1)} m`);
  add("Command", (k) => `${fixed(speeds[k], 2)} m/s, ${fixed(column.command_omega[k], 2)} rad/s`);
  add("Clearance ahead", (k) => `${fixed(column.clearance[k], 2)} m`);
  add("Localization", (k) => `${word.localization[k]}, error ${fixed(column.localization_error[k], 3)} m`,
    { tone: (k) => ({ degraded: "warn", lost: "bad" })[word.localization[k]] || "" });
  add("Features, predicted", (k) => `${fixed(column.tracked_features[k], 0)}, ${fixed(column.predicted_features[k], 0)}`);
  add("Collisions", (k) => fixed(column.collisions[k], 0), { tone: (k) => (column.collisions[k] > 0 ? "bad" : "") });
  add("Plan", (k) => word.plan_kind[k] + (word.seed[k] ? `, from ${readable(word.seed[k])}` : ""),
    { wide: true, tone: (k) => (word.plan_kind[k] === "stopping tail" ? "warn" : "") });
  // A budget that is used up is how most solves end, and no failure.
  const stops = { "iteration limit": "budget used", deadline: "time budget used" };
  add("Solver", (k) => [stops[word.stop_reason[k]] || word.stop_reason[k], word.quality[k], `${fixed(column.cost_evaluations[k], 0)} evaluations`].filter(Boolean).join(", "),
    { wide: true, tone: (k) => (["numerical trouble", "error"].includes(word.stop_reason[k]) || word.quality[k] === "infeasible" ? "warn" : "") });
  add("Guard", (k) => (column.guard_stops[k] > 0 ? `${plural(column.guard_stops[k], "stop")}${word.guard_reason[k] ? `: ${word.guard_reason[k]}` : ""}` : "no stop"),
    { there: () => column.guard_stops.some((count) => count > 0), tone: (k) => (column.guard_stops[k] > 0 ? "warn" : "") });
  add("Active frontiers", (k) => fixed(column.active_frontiers[k], 0));
  add("Certificate", (k) => [column.certified[k] === 1 ? "held" : "not held", word.certificate[k]].filter(Boolean).join(": "),
    { full: true, tone: (k) => (column.certified[k] === 1 ? "" : "warn") });
  return fields;
})();

// What the robot does and why, in one sentence.
function showWhy() {
  $("why-box").hidden = !hasModes;
  if (!hasModes) return;
  const mode = word.mode[step];
  $("mode").textContent = mode || "no plan";
  $("mode").style.background = modeColor(mode);
  $("why").textContent = word.why[step] || word.cause[step] || "–";
}
// The best candidates of the step, with what makes up their cost.
let mostCandidates = 0;
function measureCandidates() {
  mostCandidates = candidates.reduce((most, list) => Math.max(most, list.length), 0);
  $("candidates-box").hidden = mostCandidates === 0;
  $("candidates-head").replaceChildren(make("th", { scope: "col" }, "seed"), make("th", { scope: "col", class: "verdict" }, "verdict"), make("th", { scope: "col", class: "sum" }, "cost"),
    ...candidateTerms.map((name) => make("th", { scope: "col" }, readable(name), make("small", {}))));
}
// The weight of a cost in effect at the step, and the one asked for where that is another.
function weightText(name) {
  const term = terms.find((known) => known.name === name), weight = term?.weight[step], asked = term?.weight_asked[step];
  if (!isNumber(weight)) return "";
  return `weight ${rounded(weight)}${weight === asked ? "" : `, asked ${rounded(asked)}`}`;
}
measureCandidates();
function point(i) { if (pointed !== i) { pointed = i; draw(); } }
function showCandidates() {
  if ($("candidates-box").hidden) return;
  const list = candidates[step], scored = column.seeds_scored[step];
  candidateTerms.forEach((name, i) => { $("candidates-head").children[3 + i].lastChild.textContent = weightText(name); });
  $("candidates-title").textContent = list.length ? `the best ${list.length}${scored > 0 ? ` of ${plural(scored, "seed")}` : ""} at ${fixed(column.time[step], 1)} s` : `none at ${fixed(column.time[step], 1)} s`;
  // One scale for all bars: a long one is much of the cost.
  const most = Math.max(...list.flatMap((c) => c.terms.map((value) => Math.abs(value) || 0)));
  const rows = list.map((c) => {
    const verdict = make("td", { class: c.verdict === "executed" ? "verdict chosen" : "verdict", title: c.verdict }, c.verdict || "–");
    const row = make("tr", { tabindex: "0" }, make("th", { scope: "row", title: readable(c.name) }, readable(c.name), ...(c.polished ? [make("small", {}, "optimised")] : [])), verdict,
      make("td", { class: "sum" }, rounded(c.cost)),
      ...candidateTerms.map((_, i) => c.terms[i]).map((value) => make("td", { class: value < 0 ? "reward" : "" }, make("span", {}, rounded(value)),
        make("i", { style: `width:${most > 0 && isNumber(value) ? (100 * Math.abs(value) / most).toFixed(0) : 0}%` }))));
    return row;
  });
  // The table keeps its height, so that the page does not jump while the mission plays.
  while (rows.length < mostCandidates) rows.push(make("tr", { class: "blank" }, make("th", {}, "\u00a0"), ...Array.from({ length: candidateTerms.length + 2 }, () => make("td"))));
  $("candidates").replaceChildren(...rows);
}
// How the frontiers stood when it was last asked which is next: all of the sequence, then those that promise most.
const mostStandings = 8;
function measureStandings() { $("standings-box").hidden = !standings.some((list) => list.length > 0); }
measureStandings();
function showStandings() {
  if ($("standings-box").hidden) return;
  const { asked, list } = standingsAt(step), left = list.length - mostStandings;
  $("standings-title").textContent = list.length ? `as of ${fixed(column.time[asked], 1)} s${left > 0 ? `, the first ${mostStandings} of ${list.length}` : ""}` : "none";
  const most = Math.max(...list.map(({ area }) => area));
  const rows = list.slice(0, mostStandings).map((f, i) => make("tr", { tabindex: "0" },
    make("th", { scope: "row" }, f.why === "in order" ? `${i + 1}` : "–"),
    make("td", { class: f.why === "in order" ? "verdict chosen" : "verdict" }, i === 0 && f.why === "in order" ? "target" : f.why),
    make("td", { class: "sum" }, make("span", {}, rounded(f.area)), make("i", { style: `width:${most > 0 ? (100 * f.area / most).toFixed(0) : 0}%` })),
    make("td", {}, rounded(f.unknown)), make("td", {}, fixed(f.time, 1)), make("td", {}, rounded(f.area / f.time))));
  while (rows.length < mostStandings) rows.push(make("tr", { class: "blank" }, make("th", {}, "\u00a0"), ...Array.from({ length: 5 }, () => make("td"))));
  $("standings").replaceChildren(...rows);
}
function pointFrontier(i) { if (pointedFrontier !== i) { pointedFrontier = i; draw(); } }
for (const [type, leaves] of [["pointerover", false], ["focusin", false], ["pointerleave", true], ["focusout", true]]) {
  $("standings").addEventListener(type, (e) => {
    const row = e.target.closest("tr");
    pointFrontier(leaves || !row ? null : [...$("standings").children].indexOf(row));
  });
}
for (const [type, leaves] of [["pointerover", false], ["focusin", false], ["pointerleave", true], ["focusout", true]]) {
  $("candidates").addEventListener(type, (e) => {
    const row = e.target.closest("tr");
    point(leaves || !row ? null : [...$("candidates").children].indexOf(row));
  });
}

function apply(change, states) {
  for (let i = 0; i < change.cells.length; ++i) {
    const index = indexOf(change.cells[i]);
    ground[index] = states[i];
    pixels32[pixelOf(index)] = palette[states[i]];
  }
}
function toggle(cells) {
  for (const cell of cells) if (!frontier.delete(cell)) frontier.add(cell);
}
let sight = null;  // what is drawn, for the self-test
function drawSight() {
  $("sight").hidden = pictures.length === 0;
  if (pictures.length === 0) return;
  const p = pictureAt(pictures, step);
  sight = drawLandmarks($("picture"), p, () => { if (pictureAt(pictures, step) === p) drawSight(); });
  $("shown").textContent = p.frame === step ? "" : `image of ${fixed(column.time[p.frame], 1)} s`;
}
function seek(target) {
  if (n === 0) return;
  target = Math.min(n - 1, Math.max(0, Math.round(target)));
  if (target !== step) {
    while (step < target) { ++step; apply(changes[step], changes[step].now); toggle(frontierToggles[step]); }
    while (step > target) { apply(changes[step], changes[step].before); toggle(frontierToggles[step]); --step; }
    picturePen.putImageData(pixels, 0, 0);
  }
  $("slider").value = step;
  const end = column.time[n - 1];
  $("clock").replaceChildren(fixed(column.time[step], 1), make("span", {}, ` / ${fixed(end, 1)} s`));
  $("slider").setAttribute("aria-valuetext", `${fixed(column.time[step], 1)} seconds`);
  for (const field of nowFields) field(step);
  for (const plot of plots) { plot.place(); plot.show(step); }
  placeStrip();
  showWhy();
  showCandidates();
  showStandings();
  draw();
  drawSight();
}

player({
  time: column.time, seek, step: () => step, speed: () => Number($("speed").value), spare: "select, pre", spaced: "button, label",
  keys: {
    "+": () => zoom(1.4), "=": () => zoom(1.4), "-": () => zoom(1 / 1.4), "0": () => { fit(); draw(); }, f: () => $("follow").click(),
  },
});

// ---- Start ------------------------------------------------------------------------------------
function start() {
  readColors();
  const ill = (k) => ({ degraded: "shade-warn", lost: "shade-bad" })[word.localization[k]];
  makeStrip();
  const share = [];  // of the reachable area [%]
  const shares = () => { for (let k = share.length; k < n; ++k) share.push(100 * column.coverage[k]); return share; };
  addPlot("Coverage", "% of the reachable area", [{ name: "coverage", color: "var(--accent)", get values() { return shares(); } }],
    { format: (v) => `${fixed(v, 1)} %`, low: 0, high: 104, fill: true });
  addPlot("Localization error", "m", [{ name: "error", color: "var(--bad)", values: column.localization_error }], { format: (v) => `${fixed(v, 3)} m`, low: 0, shade: ill });
  addPlot("Visible features", "", [{ name: "tracked", color: "var(--seen-high)", values: column.tracked_features }, { name: "predicted", color: "var(--horizon)", values: column.predicted_features }],
    { format: (v) => fixed(v, 0), low: 0, shade: ill });
  addPlot("Planning time", "ms", [{ name: "time", color: "var(--frontier)", values: column.plan_ms }],
    { format: (v) => `${fixed(v, 1)} ms`, low: 0, shade: (k) => (word.plan_kind[k] === "stopping tail" ? "shade-warn" : null) });
  addTermPlots();
  drawStrip();
  new ResizeObserver(resize).observe($("map-box"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColors(); for (const plot of plots) plot.recolor(); drawStrip(); draw(); drawSight();
  });
  resize();
}
let plottedTerms = 0;
function addTermPlots() {
  if (terms.length === plottedTerms) return;
  if (plottedTerms === 0) $("plots").append(make("h3", { class: "group" }, "Cost terms", make("em", {}, "weighted, each on a scale of its own")));
  for (; plottedTerms < terms.length; ++plottedTerms) {
    const { name, weighted } = terms[plottedTerms];
    addPlot(readable(name), "", [{ name: readable(name), color: "var(--accent)", values: weighted }],
      { range: () => withoutPeaks(weighted), small: true, last: plottedTerms === terms.length - 1 });
  }
}
function showStage() {
  $("stage").hidden = n === 0; $("stage").style.display = n === 0 ? "none" : "";
  $("empty").hidden = n > 0;
}
// What is shown of all steps so far, when more have come.
function extendPlots() {
  addStretches();
  makeStrip();
  strip?.share();
  measureColors();
  addTermPlots();
  for (const plot of plots) plot.extend();
  drawStrip();
}
// Further steps, from which the page goes on; who looks at the newest step goes on looking at the newest.
// `plots`: also in the plots, which takes a while.
function append(part, { withPlots = true } = {}) {
  const first = n === 0, follows = step === n - 1;
  decode(part);
  if (n === 0) return;
  pose = null;
  addLayers();
  measureCandidates();
  measureStandings();
  $("slider").max = n - 1;
  showStage();
  if (first) {
    addStretches();
    measureColors();
    start();
  } else {
    paintGround();
    if (withPlots) extendPlots();
  }
  if (!view.touched && !view.kept) fit();
  if (first || follows) seek(n - 1); else seek(step);
}
showStage();
if (n > 0) {
  addStretches();
  $("slider").max = n - 1;
  start();
  // #step=N opens at that planning step; otherwise the whole mission shows.
  const wanted = location.hash.match(/step=(\d+)/);
  seek(wanted ? Number(wanted[1]) : n - 1);
}

// ---- Self-test: report.html#selftest ----------------------------------------------------------
// Moves the slider as a hand would and looks at what was drawn. Writes one line a fact into the page.
if (location.hash === "#selftest") Promise.allSettled(pictures.map((p) => p.ready)).then(async (loaded) => {
  const lines = [];
  const failures = [];
  const expect = (what, ok) => { if (!ok) failures.push(what); };
  const move = (k) => { $("slider").value = k; $("slider").dispatchEvent(new Event("input", { bubbles: true })); };
  const known = () => ground.reduce((count, state) => count + (state !== 0), 0);
  // Share of the robot's disc that has its colour. The paths, of the same colour, are switched off first.
  const painted = (at) => {
    const density = devicePixelRatio || 1, half = Math.floor(0.8 * at.radius * density), [red, green, blue] = rgb(colors.estimated);
    const { data } = pen.getImageData(Math.round(at.sx * density) - half, Math.round(at.sy * density) - half, 2 * half + 1, 2 * half + 1);
    let inside = 0, hits = 0;
    for (let v = -half, i = 0; v <= half; ++v) {
      for (let u = -half; u <= half; ++u, i += 4) {
        if (u * u + v * v > half * half) continue;
        ++inside;
        hits += Math.abs(data[i] - red) + Math.abs(data[i + 1] - green) + Math.abs(data[i + 2] - blue) < 12;
      }
    }
    return hits / inside;
  };
  try {
    loaded.forEach((l, i) => expect(`image ${i} loads`, l.status === "fulfilled"));
    const click = (name) => $(`layer-${name}`)?.click();
    ["estimated", "true", "horizon"].forEach(click);
    const seen = [];
    for (const k of n ? [0, Math.floor(n / 3), Math.floor(2 * n / 3), n - 1, Math.floor(n / 2), 0] : []) {
      move(k);
      const at = { ...drawn };
      seen.push(at);
      lines.push(`step ${k} robot ${at.x.toFixed(3)} ${at.y.toFixed(3)} known ${known()} frontiers ${at.frontiers} landmarks ${at.landmarks} horizon ${at.horizon} clock ${$("clock").textContent.split(" ")[0]}${sight ? ` image ${sight.frame} tracked ${sight.counts[0]}` : ""}`);
      if (sight) expect(`the image of step ${k} is drawn`, sight.picture && greyLevels($("picture")) > 20);
      if (hasModes) lines.push(`why ${k} ${$("mode").textContent}: ${$("why").textContent}`);
      const rows = $("candidates").querySelectorAll("tr:not(.blank)");
      lines.push(`seen at ${k}: target ${isNumber(column.way_left[k]) ? fixed(column.way_left[k], 2) : "none"} candidates ${rows.length} executed ${[...rows].filter((row) => row.querySelector(".chosen")).length}`);
      expect(`the target of step ${k} is drawn where there is one`, at.target === isNumber(column.target_x[k]));
      expect(`step ${k} shows numbers only`, !/\bNaN\b|undefined|null|Infinity/.test(document.body.innerText));
      expect(`the robot is painted where it belongs at step ${k}`, painted(at) > 0.35);
      for (const before of seen.slice(0, -1)) {
        const away = Math.hypot(at.sx - before.sx, at.sy - before.sy) > 3 * at.radius;
        if (away) expect(`no robot is left behind at step ${k}`, painted(before) < 0.05);
      }
      plots.forEach((plot, i) => {
        const x = plot.cursor.getBoundingClientRect().left - plot.cursor.parentElement.getBoundingClientRect().left;
        expect(`the cursor of plot ${i} is at step ${k}`, Math.abs(x - plot.graph.toDomXCoord(column.time[k])) < 1);
      });
    }
    lines.push(`plots ${plots.length}`);
    if (n > 1) {
      // What a layer or a colour adds to the picture: how many of its pixels change.
      const image = () => pen.getImageData(0, 0, canvas.width, canvas.height).data;
      const changed = (action) => {
        const before = image();
        action();
        const after = image();
        let count = 0;
        for (let i = 0; i < after.length; i += 4) count += before[i] !== after[i] || before[i + 1] !== after[i + 1] || before[i + 2] !== after[i + 2];
        return count;
      };
      const middle = Math.floor(n / 2);
      move(middle);
      ["estimated", "horizon"].forEach(click);
      const choose = (name) => { pathColor.value = name; pathColor.dispatchEvent(new Event("change")); };
      for (const { value } of [...pathColor.options].slice(1)) {
        expect(`the path is coloured by ${value}`, changed(() => choose(value)) > 50);
        expect(`the colours of ${value} are explained`, !$("map-legend").hidden && $("map-legend").innerText.trim() !== "");
      }
      choose("plain");
      expect("a plain path needs no explanation", $("map-legend").hidden);
      if (layers.target) expect("the target is a layer", changed(() => click("target")) > (drawn.target ? 50 : -1));
      if ($("layer-cost-to-go")) {
        click("cost-to-go");
        const f = fieldAt(step);
        await f?.ready;
        draw();
        expect("the cost-to-go is drawn", drawn.field === f.step && changed(() => click("cost-to-go")) > 500);
      }
      if (layers.order) {
        expect("the order of the frontiers is drawn", drawn.standing === standingsAt(step).list.length && changed(() => click("order")) > 50);
        click("order");
        const { asked, list } = standingsAt(step), shown = [...$("standings").children].filter((row) => row.className !== "blank");
        expect("the frontiers are in the table", shown.length === Math.min(list.length, mostStandings));
        expect("with the time when it was asked", $("standings-title").textContent.includes(fixed(column.time[asked], 1)));
        expect("a frontier that is pointed at is drawn", changed(() => shown[shown.length - 1].dispatchEvent(new PointerEvent("pointerover", { bubbles: true }))) > 20);
        $("standings").dispatchEvent(new PointerEvent("pointerleave"));
        expect("and no longer when it is left", pointedFrontier === null);
      }
      const rows = $("candidates").children;
      if (candidates[step].length > 1) {
        const other = candidates[step].length - 1;
        expect("a candidate that is pointed at is drawn", changed(() => rows[other].dispatchEvent(new PointerEvent("pointerover", { bubbles: true }))) > 20);
        $("candidates").dispatchEvent(new PointerEvent("pointerleave"));
        expect("and no longer when it is left", pointed === null);
      }
      if (strip) {
        // Each mode has its colour where its time is, and a click leads there.
        const box = strip.box.getBoundingClientRect(), context = strip.sheet.getContext("2d");
        // In the middle of the longest stretches, as short ones share a pixel.
        const longest = stretches.slice().sort((a, b) => (b.end - b.start) - (a.end - a.start)).slice(0, 3);
        for (const k of longest.map(({ start, end }) => Math.floor((start + end) / 2))) {
          const x = plots[0].graph.toDomXCoord(column.time[k]) + 0.5;
          const [red, green, blue] = context.getImageData(Math.round(x * (devicePixelRatio || 1)), 1, 1, 1).data;
          const wanted = rgb(modeColor(word.mode[k]));
          expect(`the strip has the mode's colour at step ${k}`, Math.abs(red - wanted[0]) + Math.abs(green - wanted[1]) + Math.abs(blue - wanted[2]) < 12);
          strip.box.dispatchEvent(new MouseEvent("click", { clientX: box.left + x, bubbles: true }));
          expect(`a click on the strip leads to step ${k}`, Math.abs(step - k) <= Math.ceil(n / 200));
        }
        strip.box.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + plots[0].graph.toDomXCoord(column.time[0]) + 1, bubbles: true }));
        lines.push(`strip ${strip.box.querySelector(".tip").innerText.split("\n")[0]}`);
      }
    }
    dispatchEvent(new KeyboardEvent("keydown", { key: "End", bubbles: true }));
    expect("the End key leads to the last step", step === n - 1);
  } catch (e) { errors.push(String(e.stack || e)); }
  showSelftest(lines, failures);
});

return {
  append, extendPlots, seek, draw, drawSight, pictures, canvas, drawn,
  column, word, speeds, steps: () => n, step: () => step,
  view: () => ({ x: view.x, y: view.y, scale: view.scale }),
  setView(to) { Object.assign(view, to, { touched: true }); draw(); },
  // Whether the map stays where it is as it grows.
  keepView(on) { view.kept = on; },
  // Where the robot is by now.
  setPose(now) { pose = now; if (step === n - 1) draw(); },
  toMap: (p) => toMap(p, n - 1),
  toWorld: (sx, sy) => [view.x + (sx - boxWidth / 2) / view.scale, view.y + (boxHeight / 2 - sy) / view.scale],
};
})();
