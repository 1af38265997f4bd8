// SPDX-License-Identifier: Apache-2.0
"use strict";
// What the pages share; each page's own script follows.

// Whatever goes wrong is kept, for the page's self-test.
const errors = [];
addEventListener("error", (e) => errors.push(e.message || String(e)));
addEventListener("unhandledrejection", (e) => errors.push(String(e.reason)));

const $ = (id) => document.getElementById(id);
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "class") element.className = value; else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

// ---- Data ---------------------------------------------------------------------------------------
function bytes(base64) {
  const text = atob(base64);
  const array = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) array[i] = text.charCodeAt(i);
  return array;
}
const floats = (base64) => new Float32Array(bytes(base64).buffer);

// ---- Numbers as text ----------------------------------------------------------------------------
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const fixed = (x, digits) => (isNumber(x) ? x.toFixed(digits).replace("-", "−") : "–");
// Three significant digits, without exponents where they can be done without.
function compact(x) {
  if (!isNumber(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-4 || size >= 1e6) return x.toExponential(1).replace(/-/g, "−");
  return (size >= 100 ? x.toFixed(0) : String(+x.toPrecision(3))).replace("-", "−");
}
const plural = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;

// ---- Colours of the page's style ------------------------------------------------------------------
const dark = matchMedia("(prefers-color-scheme: dark)");
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// ---- Plots of a recording over time ---------------------------------------------------------------
// Below each other in #plots, with one window of time; a click seeks. column.time [s] and column.state are of its
// frames, of which those of state 1 and 2 are shaded. step() says which is shown, seek(k) shows one. `bands`: series
// have a sigma, of which two make a band. `all`: options of Dygraphs for every plot. Returns the plots so far, and
// add(title, unit, series, format, options), which draws one: a series is {name, color: "--name", values, sigma},
// format(value, sigma) is what it says.
function recordingPlots({ column, step, seek, bands = false, all = {} }) {
  const n = column.time.length, plots = [];
  let aligning = false;
  function nearest(time) {
    let best = 0;
    for (let k = 1; k < n; ++k) if (Math.abs(column.time[k] - time) < Math.abs(column.time[best] - time)) best = k;
    return best;
  }
  const entry = ({ values, sigma }, k) => {
    if (!bands) return isNumber(values[k]) ? values[k] : null;
    return isNumber(values[k]) ? [values[k], sigma && isNumber(sigma[k]) ? sigma[k] : 0] : [null, null];
  };
  function add(title, unit, series, format, options = {}) {
    const labels = make("div", { class: "series" }), area = make("div"), cursor = make("div", { class: "cursor" });
    $("plots").append(make("div", { class: "plot" },
      make("h3", {}, make("span", {}, title, make("em", {}, unit)), labels), make("div", { class: "area" }, area, cursor)));
    const values = series.map(({ name, color }) => {
      const value = make("b");
      labels.append(make("span", {}, make("i", { style: `background:var(${color})` }), name, value));
      return value;
    });
    const data = Array.from({ length: n }, (_, k) => [column.time[k], ...series.map((one) => entry(one, k))]);
    let graph = null;  // drawCallback already runs inside the constructor
    function place() {
      if (!graph || step() < 0) return;
      const at = graph.toDomXCoord(column.time[step()]), box = graph.getArea();
      cursor.style.display = at >= box.x - 1 && at <= box.x + box.w + 1 ? "" : "none";
      cursor.style.transform = `translateX(${at.toFixed(1)}px)`;
      cursor.style.top = `${box.y}px`; cursor.style.height = `${box.h}px`; cursor.style.bottom = "auto";
    }
    const show = (k) => series.forEach((one, i) => { values[i].textContent = format(one.values[k], one.sigma ? one.sigma[k] : NaN); });
    const colors = () => series.map(({ color }) => css(color));
    graph = new Dygraph(area, data, {
      labels: ["time", ...series.map(({ name }) => name)], colors: colors(), strokeWidth: 1.5, legend: "never", labelsDiv: make("div"),
      highlightCircleSize: 3, gridLineColor: css("--grid"), axisLineColor: css("--line"), axisLineWidth: 1, rightGap: 10, xRangePad: 2, yRangePad: 6,
      xAxisHeight: 20, digitsAfterDecimal: 4, errorBars: bands, sigma: 2,
      dateWindow: n === 1 ? [column.time[0] - 1, column.time[0] + 1] : null,  // one point alone spans nothing
      axes: {
        x: { drawGrid: false, pixelsPerLabel: 64, axisLabelFormatter: (v) => `${+v.toFixed(3)} s`, axisLabelWidth: 60 },
        y: { pixelsPerLabel: 26, axisLabelWidth: 48, axisLabelFormatter: (v) => compact(v) },
      },
      underlayCallback: (context, chart, g) => {
        for (let k = 0; k < n; ++k) {
          if (!column.state[k]) continue;
          const start = g.toDomXCoord(column.time[k]), end = k + 1 < n ? g.toDomXCoord(column.time[k + 1]) : start + 2;
          context.fillStyle = css(column.state[k] === 1 ? "--shade-warn" : "--shade-bad");
          context.fillRect(start, chart.y, Math.max(1, end - start), chart.h);
        }
      },
      clickCallback: (e, time) => seek(nearest(time)),
      highlightCallback: (e, time, points, row) => show(row),
      unhighlightCallback: () => show(step()),
      drawCallback: (g, first) => {
        if (first || aligning) { place(); return; }
        aligning = true;
        for (const other of plots) if (other.graph !== g) other.graph.updateOptions({ dateWindow: g.xAxisRange() });
        aligning = false;
        place();
      },
      ...all, ...options,
    });
    plots.push({ graph, place, show, cursor, recolor: () => graph.updateOptions({ colors: colors(), gridLineColor: css("--grid"), axisLineColor: css("--line") }) });
  }
  return { plots, add };
}

// ---- Playing ------------------------------------------------------------------------------------
// What moves through the steps of a run, whose times are `time` [s], and which may become more: the button #play, the slider #slider and
// the keyboard. seek(k) shows a step, step() says which one is shown, speed() is that of the clock. `keys`:
// further ones, by name. `spare` and `spaced`: elements that keep all of their keys, or the space bar.
// Returns play(on).
function player({ time, seek, step, speed = () => 1, keys = {}, spare = "select", spaced = "button" }) {
  let playing = false, playedTo = 0, lastFrame = 0;
  function frame(now) {
    if (!playing) return;
    playedTo += Math.min(0.2, (now - lastFrame) / 1000) * speed();
    lastFrame = now;
    let target = step();
    while (target + 1 < time.length && time[target + 1] <= playedTo) ++target;
    if (target !== step()) seek(target);
    if (step() >= time.length - 1) play(false); else requestAnimationFrame(frame);
  }
  function play(on) {
    if (on && step() >= time.length - 1) seek(0);
    playing = on && time.length > 1;
    $("play").classList.toggle("playing", playing);
    $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    if (playing) { playedTo = time[step()]; lastFrame = performance.now(); requestAnimationFrame(frame); }
  }
  const go = (k) => { play(false); seek(k); };
  $("play").addEventListener("click", () => play(!playing));
  $("slider").addEventListener("input", () => go(Number($("slider").value)));
  addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || time.length === 0 || e.target.closest?.(spare)) return;
    const jump = e.shiftKey ? 10 : 1;
    const actions = {
      " ": () => play(!playing), ArrowLeft: () => go(step() - jump), ArrowRight: () => go(step() + jump),
      Home: () => go(0), End: () => go(time.length - 1), ...keys,
    };
    if (!actions[e.key] || (e.key === " " && e.target.closest?.(spaced))) return;
    e.preventDefault();
    actions[e.key]();
  });
  return play;
}

// ---- Self-test ----------------------------------------------------------------------------------
// Writes into the page what a self-test saw, one line a fact, and whether it passed.
function showSelftest(lines, failures) {
  for (const failure of failures) lines.push(`FAILED ${failure}`);
  for (const error of errors) lines.push(`ERROR ${error}`);
  lines.push(failures.length || errors.length ? "selftest failed" : "selftest passed");
  document.body.append(make("pre", { id: "selftest" }, lines.join("\n")));
}

// ---- Pictures with landmarks --------------------------------------------------------------------
// Each with its image on the way: `ready` settles when that is known to load or not.
const loadPictures = (list) => list.map((p) => {
  const image = new Image();
  const ready = new Promise((resolve, reject) => {
    image.onload = () => resolve();
    image.onerror = () => reject(new Error(`the image of frame ${p.frame} does not load`));
  });
  image.src = `data:image/jpeg;base64,${p.jpeg}`;
  return { ...p, image, ready, features: floats(p.features) };
});
// The newest one at frame k.
function pictureAt(pictures, k) {
  let best = pictures[0];
  for (const p of pictures) if (p.frame <= k) best = p;
  return best;
}
// Draws picture p as wide as the canvas is; `again` is called when its image has come. Returns what was drawn.
function drawLandmarks(canvas, p, again) {
  const pen = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
  const colors = ["--tracked", "--made", "--missed"].map((name) => style.getPropertyValue(name).trim());
  const density = devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * density));
  canvas.width = width;
  canvas.height = Math.max(1, Math.round(width * p.height / p.width));
  const scale = width / p.width;
  const drawn = { frame: p.frame, counts: [0, 0, 0], picture: false };
  if (p.image.complete && p.image.naturalWidth > 0) {
    pen.drawImage(p.image, 0, 0, canvas.width, canvas.height);
    drawn.picture = true;
  } else {
    p.ready.then(again, () => {});
  }
  const radius = Math.max(2.2 * density, 1.3 * scale);
  pen.lineWidth = 1.4 * density;
  for (let i = 0; i < p.features.length; i += 3) {
    const u = p.features[i] * scale, v = p.features[i + 1] * scale, kind = p.features[i + 2];
    ++drawn.counts[kind];
    pen.beginPath();
    if (kind === 2) pen.rect(u - radius, v - radius, 2 * radius, 2 * radius);
    else pen.arc(u, v, radius, 0, 2 * Math.PI);
    if (kind === 0) { pen.fillStyle = colors[kind]; pen.fill(); } else { pen.strokeStyle = colors[kind]; pen.stroke(); }
  }
  return drawn;
}
// Grey levels in a canvas: a picture has many, a blank one has one.
function greyLevels(canvas) {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const levels = new Set();
  for (let i = 0; i < data.length; i += 4) levels.add(data[i]);
  return levels.size;
}
