(() => {
// ---- Data -------------------------------------------------------------------------------------
const run = JSON.parse($("run").textContent);
const n = run.steps;

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

const column = {};
for (const [name, text] of Object.entries(run.columns)) column[name] = floats(text);
const word = {};
for (const [name, { words, steps }] of Object.entries(run.words)) {
  const next = varints(steps);
  word[name] = Array.from({ length: n }, () => words[next()]);
}
const terms = run.terms.map(({ name, values }) => ({ name, values: floats(values) }));

const { i0, j0, width, height } = run.extent;
const r = run.resolution;
// Changes of the map at each step, with the state before, so that time can run backwards.
const changes = (() => {
  const next = varints(run.map);
  const state = new Uint8Array(width * height);
  return Array.from({ length: n }, () => {
    const cells = [], now = [], before = [];
    for (let runs = next(), at = 0; runs > 0; --runs) {
      at += next();
      const code = next(), value = code % 4;
      for (const end = at + (code - value) / 4; at < end; ++at) {
        cells.push(at); now.push(value); before.push(state[at]);
        state[at] = value;
      }
    }
    return { cells, now, before };
  });
})();
const frontierToggles = (() => {
  const next = varints(run.frontiers);
  return Array.from({ length: n }, () => {
    const cells = [];
    for (let count = next(), at = 0; count > 0; --count) cells.push(at += next());
    return cells;
  });
})();
const landmarkPositions = floats(run.landmarks.positions);
const landmarks = (() => {
  const next = varints(run.landmarks.steps);
  return Array.from({ length: n }, () => {
    const count = next();
    const index = new Uint32Array(count), visibility = new Uint8Array(count);
    for (let i = 0, at = 0; i < count; ++i) { index[i] = at += next(); visibility[i] = next(); }
    return { index, visibility };
  });
})();
const horizonPoses = floats(run.horizon.poses);
const horizonStart = (() => {
  const next = varints(run.horizon.counts);
  const start = [0];
  for (let k = 0; k < n; ++k) start.push(start[k] + next());
  return start;
})();

// ---- Numbers as text --------------------------------------------------------------------------
const percent = (x, digits = 1) => fixed(isNumber(x) ? 100 * x : x, digits);
// About three significant digits, for quantities of any size.
function rounded(x) {
  if (!isNumber(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return x.toExponential(1).replace(/-/g, "−");
  return fixed(x, size < 1 ? 3 : size < 100 ? 2 : size < 1000 ? 1 : 0);
}
const readable = (name) => name.replace(/_/g, " ");

// ---- Head and summary -------------------------------------------------------------------------
const s = run.summary;
{
  const end = { explored: "good", "localization lost": "bad" }[s.reason] || "warn";
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
    ["Area seen", fixed(s.area_m2, 1), "m²"],
    ["Reachable area", fixed(s.reachable_area_m2, 1), "m²"],
    ["Duration", fixed(s.duration_s, 1), "s"],
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
  if (n > 0) {
    const body = make("tbody");
    const rank = (sorted, p) => sorted[Math.max(0, Math.ceil(p * sorted.length / 100) - 1)];
    for (const [label, name] of [["Guidance", "guide_ms"], ["Clearance field", "clearance_ms"],
      ["Visible landmarks", "views_ms"], ["Seeds", "seeds_ms"], ["Optimisation", "polish_ms"], ["Certificate", "certify_ms"]]) {
      const sorted = column[name].slice().sort();
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
const ground = new Uint8Array(width * height);
const frontier = new Set();
let colors = {};
const drawn = {};                // what the last drawing really used, for the self-test

// ---- Map --------------------------------------------------------------------------------------
const canvas = $("map"), pen = canvas.getContext("2d");
const picture = make("canvas");  // one pixel a cell, y down
picture.width = Math.max(1, width); picture.height = Math.max(1, height);
const picturePen = picture.getContext("2d");
const pixels = picturePen.createImageData(picture.width, picture.height);
const pixels32 = new Uint32Array(pixels.data.buffer);
let palette = new Uint32Array(3);
const pixelOf = (cell) => (height - 1 - Math.floor(cell / width)) * width + cell % width;

function rgb(text) {
  const value = parseInt(text.slice(1), 16);
  return [value >> 16, value >> 8 & 255, value & 255];
}
function readColors() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "ink-2", "ink-3", "line", "accent", "map-unknown", "map-free", "map-occupied", "estimated", "true",
    "horizon", "frontier", "seen-low", "seen-high", "view", "halo", "grid", "shade-warn", "shade-bad"]) {
    colors[name] = style.getPropertyValue(`--${name}`).trim();
  }
  palette = new Uint32Array(["map-unknown", "map-free", "map-occupied"].map((name) => {
    const [red, green, blue] = rgb(colors[name]);
    return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
  }));
  const low = rgb(colors["seen-low"]), high = rgb(colors["seen-high"]);
  colors.visibility = Array.from({ length: 128 }, (_, i) =>
    `rgb(${low.map((c, m) => Math.round(c + (high[m] - c) * i / 127)).join(",")})`);
  for (let cell = 0; cell < ground.length; ++cell) pixels32[pixelOf(cell)] = palette[ground[cell]];
  picturePen.putImageData(pixels, 0, 0);
}

const layers = { view: true, frontiers: true, landmarks: true, true: true, estimated: true, horizon: true };
for (const [name, label, mark, style] of [
  ["estimated", "estimated path", "", "background:var(--estimated)"],
  ["true", "true path", "", "background:var(--true)"],
  ["horizon", "horizon", "", "background:var(--horizon)"],
  ["view", "field of view", "cell", "background:rgba(var(--view),.3)"],
  ["frontiers", "frontiers", "cell", "background:var(--frontier)"],
  ["landmarks", "landmarks, by visibility", "ramp", ""]]) {
  const box = make("input", { type: "checkbox", id: `layer-${name}` });
  box.checked = true;
  box.addEventListener("change", () => { layers[name] = box.checked; draw(); });
  $("layers").append(make("label", {}, box, make("i", { class: mark, style }), label));
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
    include(column.x[k], column.y[k], 0.5);
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
  const rays = 90, points = [];
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

function draw() {
  if (step < 0 || !boxWidth) return;
  const x = column.x[step], y = column.y[step], yaw = column.yaw[step];
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
  if (layers.view) {
    trace([[x, y], ...viewPolygon(x, y, yaw)]);
    pen.closePath();
    pen.fillStyle = `rgba(${colors.view}, 0.13)`; pen.fill();
    pen.strokeStyle = `rgba(${colors.view}, 0.35)`; pen.lineWidth = 1; pen.stroke();
  }
  if (layers.frontiers) {
    pen.fillStyle = colors.frontier;
    const size = Math.max(2.5, r * view.scale), inset = (r * view.scale - size) / 2;
    for (const cell of frontier) {
      const [sx, sy] = toScreen((i0 + cell % width) * r, (j0 + Math.floor(cell / width) + 1) * r);
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
  if (layers.estimated) path(column.x, column.y, step, colors.estimated, 2);
  if (layers.horizon) {
    const points = [];
    for (let i = horizonStart[step]; i < horizonStart[step + 1]; ++i) {
      if (isNumber(horizonPoses[3 * i]) && isNumber(horizonPoses[3 * i + 1])) points.push([horizonPoses[3 * i], horizonPoses[3 * i + 1], horizonPoses[3 * i + 2]]);
    }
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
  // The robot: a ring where it is, a disc with its heading where it believes to be.
  const radius = Math.max(6, run.robot_radius * view.scale);
  if (layers.true) {
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
  Object.assign(drawn, { x, y, yaw, sx, sy, radius, frontiers: frontier.size, landmarks: landmarks[step].index.length, horizon: horizonStart[step + 1] - horizonStart[step] });
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

function addPlot(title, unit, series, { format = rounded, low = null, high = null, shade = null, fill = false } = {}) {
  const many = series.length > 2;
  const labels = make("div", { class: "series" });
  const area = make("div"), cursor = make("div", { class: "cursor" });
  const box = make("div", { class: many ? "plot many" : "plot" },
    make("h3", {}, make("span", {}, title, make("em", {}, unit)), labels), make("div", { class: "area" }, area, cursor));
  $("plots").append(box);
  const values = series.map(({ name, color }) => {
    const value = make("b");
    const label = make("span", {}, ...(series.length > 1 ? [make("i", { style: `background:${color}` }), name] : []), value);
    labels.append(label);
    return { value, label };
  });
  const resolved = () => series.map(({ color }) => (color.startsWith("var(") ? getComputedStyle(document.documentElement).getPropertyValue(color.slice(4, -1)).trim() : color));
  const data = Array.from({ length: n }, (_, k) => [column.time[k], ...series.map(({ values }) => (isNumber(values[k]) ? values[k] : null))]);
  let graph = null;  // drawCallback already runs inside the constructor
  graph = new Dygraph(area, data, {
    labels: ["time", ...series.map(({ name }) => name)],
    colors: resolved(), strokeWidth: 1.5, fillGraph: fill, fillAlpha: 0.1,
    legend: "never", labelsDiv: make("div"), highlightCircleSize: 3, gridLineColor: colors.grid, axisLineColor: colors.line, axisLineWidth: 1,
    rightGap: 10, xRangePad: 2, yRangePad: 6, xAxisHeight: 20, digitsAfterDecimal: 4,
    valueRange: [low, high],
    dateWindow: n === 1 ? [column.time[0] - 1, column.time[0] + 1] : null,  // one point alone spans nothing
    axes: {
      x: { drawGrid: false, pixelsPerLabel: 64, axisLabelFormatter: (v) => `${+v.toFixed(3)} s`, axisLabelWidth: 60 },
      y: { pixelsPerLabel: many ? 28 : 22, axisLabelWidth: 44, axisLabelFormatter: (v) => (Math.abs(v) >= 1e5 ? v.toExponential(0) : String(+v.toPrecision(6))).replace("-", "−") },
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
      if (first || aligning) { place(); return; }
      aligning = true;
      sharedWindow = g.xAxisRange();
      for (const other of plots) if (other.graph !== g) other.graph.updateOptions({ dateWindow: sharedWindow });
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
  if (many) {
    values.forEach(({ label }, i) => label.addEventListener("click", () => {
      const on = label.classList.toggle("off");
      graph.setVisibility(i, !on);
    }));
  }
  plots.push({ graph, place, show, cursor, recolor: () => graph.updateOptions({ colors: resolved(), gridLineColor: colors.grid, axisLineColor: colors.line }) });
}
function nearest(time) {
  let best = 0;
  for (let k = 1; k < n; ++k) if (Math.abs(column.time[k] - time) < Math.abs(column.time[best] - time)) best = k;
  return best;
}

// ---- The step that is shown -------------------------------------------------------------------
const nowFields = (() => {
  const fields = [];
  const add = (label, text, options = {}) => {
    const dd = make("dd");
    $("now").append(make("div", options.full ? { class: "full" } : options.wide ? { class: "wide" } : {}, make("dt", {}, label), dd));
    fields.push((k) => { dd.textContent = dd.title = text(k); dd.className = options.tone ? options.tone(k) : ""; });
  };
  add("Coverage", (k) => `${percent(column.coverage[k])} %, ${fixed(column.area[k], 1)} m²`);
  add("Path", (k) => `${fixed(column.path[k], 1)} m`);
  add("Command", (k) => `${fixed(column.speed[k], 2)} m/s, ${fixed(column.yaw_rate[k], 2)} rad/s`);
  add("Clearance ahead", (k) => `${fixed(column.clearance[k], 2)} m`);
  add("Localization", (k) => `${word.localization[k]}, error ${fixed(column.error[k], 3)} m`,
    { tone: (k) => ({ degraded: "warn", lost: "bad" })[word.localization[k]] || "" });
  add("Features, predicted", (k) => `${fixed(column.tracked[k], 0)}, ${fixed(column.predicted[k], 0)}`);
  add("Frontiers", (k) => `${fixed(column.frontiers[k], 0)} active`);
  add("Collisions", (k) => fixed(column.collisions[k], 0), { tone: (k) => (column.collisions[k] > 0 ? "bad" : "") });
  add("Plan", (k) => word.plan[k] + (word.seed[k] ? `, from ${readable(word.seed[k])}` : ""),
    { wide: true, tone: (k) => (word.plan[k] === "stopping tail" ? "warn" : "") });
  add("Solver", (k) => [word.stop[k], word.quality[k], `${fixed(column.evaluations[k], 0)} evaluations`].filter(Boolean).join(", "), { wide: true });
  add("Certificate", (k) => [word.certified[k] === "yes" ? "held" : "not held", word.certificate[k]].filter(Boolean).join(": "),
    { full: true, tone: (k) => (word.certified[k] === "yes" ? "" : "warn") });
  return fields;
})();

function apply(change, states) {
  for (let i = 0; i < change.cells.length; ++i) {
    const cell = change.cells[i];
    ground[cell] = states[i];
    pixels32[pixelOf(cell)] = palette[states[i]];
  }
}
function toggle(cells) {
  for (const cell of cells) if (!frontier.delete(cell)) frontier.add(cell);
}
// What the robot's left camera showed, where it has one.
const pictures = loadPictures(run.pictures);
$("sight").hidden = pictures.length === 0;
let sight = null;  // what is drawn, for the self-test
function drawSight() {
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
  draw();
  drawSight();
}

// ---- Playing ----------------------------------------------------------------------------------
let playing = false, playedTo = 0, lastFrame = 0;
function frame(now) {
  if (!playing) return;
  playedTo += Math.min(0.2, (now - lastFrame) / 1000) * Number($("speed").value);
  lastFrame = now;
  let target = step;
  while (target + 1 < n && column.time[target + 1] <= playedTo) ++target;
  if (target !== step) seek(target);
  if (step >= n - 1) play(false); else requestAnimationFrame(frame);
}
function play(on) {
  if (on && step >= n - 1) seek(0);
  playing = on && n > 1;
  $("play").classList.toggle("playing", playing);
  $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  if (playing) { playedTo = column.time[step]; lastFrame = performance.now(); requestAnimationFrame(frame); }
}
$("play").addEventListener("click", () => play(!playing));
$("slider").addEventListener("input", () => { play(false); seek(Number($("slider").value)); });
addEventListener("keydown", (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || n === 0) return;
  if (e.target.closest?.("select, pre")) return;
  const jump = e.shiftKey ? 10 : 1;
  const actions = {
    " ": () => play(!playing),
    ArrowLeft: () => { play(false); seek(step - jump); }, ArrowRight: () => { play(false); seek(step + jump); },
    Home: () => { play(false); seek(0); }, End: () => { play(false); seek(n - 1); },
    "+": () => zoom(1.4), "=": () => zoom(1.4), "-": () => zoom(1 / 1.4), "0": () => { fit(); draw(); },
    f: () => $("follow").click(),
  };
  if (!actions[e.key] || (e.key === " " && e.target.closest?.("button, label"))) return;
  e.preventDefault();
  actions[e.key]();
});

// ---- Start ------------------------------------------------------------------------------------
if (n === 0) {
  $("stage").hidden = true; $("stage").style.display = "none";
  $("empty").hidden = false;
} else {
  readColors();
  $("slider").max = n - 1;
  const ill = (k) => ({ degraded: "shade-warn", lost: "shade-bad" })[word.localization[k]];
  addPlot("Coverage", "% of the reachable area", [{ name: "coverage", color: "var(--accent)", values: column.coverage.map((v) => 100 * v) }],
    { format: (v) => `${fixed(v, 1)} %`, low: 0, high: 104, fill: true });
  addPlot("Localization error", "m", [{ name: "error", color: "var(--bad)", values: column.error }], { format: (v) => `${fixed(v, 3)} m`, low: 0, shade: ill });
  addPlot("Visible features", "", [{ name: "tracked", color: "var(--seen-high)", values: column.tracked }, { name: "predicted", color: "var(--horizon)", values: column.predicted }],
    { format: (v) => fixed(v, 0), low: 0, shade: ill });
  addPlot("Planning time", "ms", [{ name: "time", color: "var(--frontier)", values: column.plan_ms }],
    { format: (v) => `${fixed(v, 1)} ms`, low: 0, shade: (k) => (word.plan[k] === "stopping tail" ? "shade-warn" : null) });
  const wheel = ["#3b82f6", "#f59e0b", "#10b981", "#ef4444", "#8b5cf6", "#ec4899", "#06b6d4", "#84cc16", "#a16207", "#64748b", "#1d4ed8", "#f97316"];
  if (terms.length) {
    addPlot("Cost terms", "weighted", terms.map(({ name, values }, i) => ({ name: readable(name), color: wheel[i % wheel.length], values })));
  }
  new ResizeObserver(resize).observe($("map-box"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColors(); for (const plot of plots) plot.recolor(); draw(); drawSight();
  });
  resize();
  // #step=N opens at that planning step; otherwise the whole mission shows.
  const wanted = location.hash.match(/step=(\d+)/);
  seek(wanted ? Number(wanted[1]) : n - 1);
}

// ---- Self-test: report.html#selftest ----------------------------------------------------------
// Moves the slider as a hand would and looks at what was drawn. Writes one line a fact into the page.
if (location.hash === "#selftest") Promise.allSettled(pictures.map((p) => p.ready)).then((loaded) => {
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
    for (const name of ["estimated", "true", "horizon"]) $(`layer-${name}`).click();
    const seen = [];
    for (const k of n ? [0, Math.floor(n / 3), Math.floor(2 * n / 3), n - 1, Math.floor(n / 2), 0] : []) {
      move(k);
      const at = { ...drawn };
      seen.push(at);
      lines.push(`step ${k} robot ${at.x.toFixed(3)} ${at.y.toFixed(3)} known ${known()} frontiers ${at.frontiers} landmarks ${at.landmarks} horizon ${at.horizon} clock ${$("clock").textContent.split(" ")[0]}${sight ? ` image ${sight.frame} tracked ${sight.counts[0]}` : ""}`);
      if (sight) expect(`the image of step ${k} is drawn`, sight.picture && greyLevels($("picture")) > 20);
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
    dispatchEvent(new KeyboardEvent("keydown", { key: "End", bubbles: true }));
    expect("the End key leads to the last step", step === n - 1);
  } catch (e) { errors.push(String(e.stack || e)); }
  showSelftest(lines, failures);
});
})();
