// SPDX-License-Identifier: Apache-2.0
(() => {
// ---- Data ---------------------------------------------------------------------------------------
const run = JSON.parse($("run").textContent);
const n = run.frames, s = run.summary;
const column = {};
for (const [name, text] of Object.entries(run.columns)) column[name] = floats(text);
const pictures = loadPictures(run.pictures);
const states = ["ok", "degraded", "lost"];

// ---- Head ---------------------------------------------------------------------------------------
const known = isNumber(s.end_error_m);
$("facts").textContent = [s.layout, plural(s.frames, "frame"), `${s.ok} ok, ${s.degraded} degraded, ${s.lost} lost`,
  plural(s.keyframes, "keyframe"), s.ground_truth ? null : "no ground truth"].filter(Boolean).join(" · ");
const figure = (label, value, unit, bad) => $("figures").append(make("div", bad ? { class: "bad" } : {},
  make("dd", {}, value, make("small", {}, unit)), make("dt", {}, label)));
figure("of the frames located", fixed(s.covered_percent, 0), "%", s.covered_percent < 50);
if (isNumber(s.estimated_length_m)) figure("path", fixed(s.estimated_length_m, 1), "m");
if (known) {
  if (isNumber(s.end_error_percent)) figure("error at the end", fixed(s.end_error_percent, 2), "%");
  else figure("error at the end", fixed(s.end_error_m, 3), "m");
  figure("rotation at the end", fixed(s.end_rotation_deg, 2), "°");
  if (s.calibration_refused) figure("of the true length: calibration wrong", fixed(100 * s.scale, 1), "%", true);
  if (isNumber(s.rpe_10m_percent)) figure("per 10 m", fixed(s.rpe_10m_percent, 2), "%");
  else if (isNumber(s.rpe_1m_percent)) figure("per 1 m", fixed(s.rpe_1m_percent, 2), "%");
}
if (s.loops) figure("loops", fixed(s.loops.used, 0), "");
if (s.loops && isNumber(s.loops.end_error_m)) figure("error at the end with loops", fixed(s.loops.end_error_m, 3), "m");
figure("losses", fixed(s.losses, 0), "", s.losses > 0);

// ---- Picture with landmarks ---------------------------------------------------------------------
const canvas = $("picture");
let drawn = null;  // what the picture shows, for the self-test
function drawPicture(k) {
  const p = pictureAt(pictures, k);
  drawn = drawLandmarks(canvas, p, () => { if (pictureAt(pictures, step) === p) drawPicture(step); });
  $("shown").textContent = p.frame === k ? "" : `image of frame ${p.frame}`;
}

// ---- Path ---------------------------------------------------------------------------------------
const map = $("path"), ink = map.getContext("2d");
$("axes").textContent = `${run.axes[0]} to the right, ${run.axes[1]} upwards [m]`;
const loops = run.loops || [], looped = Boolean(column.looped_x);
let marker = null, loopsDrawn = 0;
function drawPath(k) {
  const density = devicePixelRatio || 1;
  const width = map.clientWidth, height = map.clientHeight;
  map.width = Math.max(1, Math.round(width * density));
  map.height = Math.max(1, Math.round(height * density));
  ink.setTransform(density, 0, 0, density, 0, 0);
  let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  const paths = [[column.x, column.y], [column.true_x, column.true_y]];
  if (looped) paths.push([column.looped_x, column.looped_y]);
  for (const [xs, ys] of paths) {
    for (let i = 0; i < n; ++i) {
      if (!isNumber(xs[i])) continue;
      low = [Math.min(low[0], xs[i]), Math.min(low[1], ys[i])];
      high = [Math.max(high[0], xs[i]), Math.max(high[1], ys[i])];
    }
  }
  const border = 26;
  const span = Math.max(1e-3, (high[0] - low[0]) / Math.max(1, width - 2 * border), (high[1] - low[1]) / Math.max(1, height - 2 * border));
  const at = (x, y) => [width / 2 + (x - (low[0] + high[0]) / 2) / span, height / 2 - (y - (low[1] + high[1]) / 2) / span];
  // A grid of 1, 2 or 5 times a power of ten metres.
  const power = 10 ** Math.floor(Math.log10(span * 60));
  const cell = [1, 2, 5, 10].map((m) => m * power).find((c) => c / span >= 60);
  ink.strokeStyle = css("--grid"); ink.fillStyle = css("--ink-3"); ink.lineWidth = 1; ink.font = "11px system-ui, sans-serif";
  const label = (v) => String(+v.toPrecision(6)).replace("-", "−");
  const [left, bottom] = [low[0] + high[0], low[1] + high[1]].map((sum, i) => sum / 2 - span * (i ? height : width) / 2);
  for (let i = Math.ceil(left / cell); i * cell < left + span * width; ++i) {
    const v = i * cell, [px] = at(v, 0);
    ink.beginPath(); ink.moveTo(px, 0); ink.lineTo(px, height); ink.stroke(); ink.fillText(label(v), px + 3, height - 4);
  }
  for (let i = Math.ceil(bottom / cell); i * cell < bottom + span * height; ++i) {
    const v = i * cell, [, py] = at(0, v);
    ink.beginPath(); ink.moveTo(0, py); ink.lineTo(width, py); ink.stroke(); ink.fillText(label(v), 3, py - 3);
  }
  const line = (xs, ys, color, widthPx, alpha) => {
    ink.beginPath();
    let down = false;
    for (let i = 0; i < n; ++i) {
      if (!isNumber(xs[i])) { down = false; continue; }
      const [px, py] = at(xs[i], ys[i]);
      if (down) ink.lineTo(px, py); else ink.moveTo(px, py);
      down = true;
    }
    ink.strokeStyle = color; ink.lineWidth = widthPx; ink.globalAlpha = alpha; ink.lineJoin = "round"; ink.stroke(); ink.globalAlpha = 1;
  };
  line(column.true_x, column.true_y, css("--true"), 4, 0.45);
  line(column.x, column.y, css("--estimated"), 2, looped ? 0.6 : 1);
  if (looped) line(column.looped_x, column.looped_y, css("--good"), 2, 1);
  // Those of the frame that is shown stand out.
  const ring = (point, radius) => { const [px, py] = at(...point); ink.beginPath(); ink.arc(px, py, radius, 0, 2 * Math.PI); ink.stroke(); };
  loopsDrawn = 0;
  for (const loop of loops) {
    const here = loop.older === k || loop.newer === k;
    ink.strokeStyle = css("--frontier"); ink.lineWidth = here ? 2.5 : 1; ink.globalAlpha = here ? 1 : 0.55;
    ink.beginPath(); ink.moveTo(...at(...loop.from)); ink.lineTo(...at(...loop.to)); ink.stroke();
    ring(loop.from, here ? 5 : 3); ring(loop.to, here ? 5 : 3);
    ++loopsDrawn;
  }
  ink.globalAlpha = 1;
  const [px, py] = at(column.x[k], column.y[k]);
  ink.beginPath(); ink.arc(px, py, 6, 0, 2 * Math.PI);
  ink.fillStyle = css("--estimated"); ink.fill(); ink.strokeStyle = css("--halo"); ink.lineWidth = 2; ink.stroke();
  marker = { x: px * density, y: py * density, shown: [px, py] };
}
$("looped-legend").hidden = !looped;
$("loops-legend").hidden = loops.length === 0;
$("true-legend").hidden = !column.true_x.some(isNumber);

// ---- Plots --------------------------------------------------------------------------------------
let step = -1;
const { plots, add: addPlot } = recordingPlots({ column, step: () => step, seek, all: { valueRange: [0, null], drawPoints: n === 1 } });
const metres = (v) => (isNumber(v) ? `${compact(v)} m` : "–"), degrees = (v) => (isNumber(v) ? `${compact(v)}°` : "–"), whole = (v) => fixed(v, 0);
const one = (name, color, values) => ({ name, color, values });
const errorOf = (name, values, color = "--bad") => (values.some(isNumber) ? [one(name, color, values)] : []);
addPlot("Position", "m", [...errorOf("error", column.error), ...(looped ? errorOf("error with loops", column.looped_error, "--good") : []), one("claimed standard deviation", "--accent", column.sigma)], metres);
addPlot("Orientation", "degrees", [...errorOf("error", column.turned), one("claimed standard deviation", "--accent", column.sigma_turn)], degrees);
addPlot("Landmarks", "in view", [one("expected", "--ink-3", column.expected), one("tracked", "--good", column.tracked), one("in both images", "--frontier", column.confirmed)], whole);
addPlot("New landmarks", "at keyframes", [one("new", "--made", column.made)], whole);

// ---- Predictions --------------------------------------------------------------------------------
const kHorizonColors = ["--accent", "--horizon", "--frontier", "--good"];
const diagram = { circles: 0 };
function drawCalibration() {
  const c = s.calibration;
  const horizons = c ? c.horizons.filter((h) => h.learned.frames > 0) : [];
  $("calibration").hidden = horizons.length === 0;
  if (!horizons.length) return;
  const svg = (tag, attributes, text) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  const X = (p) => 40 + 290 * p, Y = (p) => 300 - 285 * p;
  const parts = [svg("path", { class: "axis", d: `M${X(0)} ${Y(1)}V${Y(0)}H${X(1)}` }), svg("path", { class: "diagonal", d: `M${X(0)} ${Y(0)}L${X(1)} ${Y(1)}` })];
  for (const p of [0, 0.25, 0.5, 0.75, 1]) {
    parts.push(svg("text", { x: X(p), y: Y(0) + 16, "text-anchor": "middle" }, String(p)), svg("text", { x: X(0) - 6, y: Y(p) + 4, "text-anchor": "end" }, String(p)));
  }
  parts.push(svg("text", { x: X(0.5), y: 334, "text-anchor": "middle" }, "predicted"), svg("text", { x: 12, y: Y(0.5), "text-anchor": "middle", transform: `rotate(-90 12 ${Y(0.5)})` }, "observed"));
  diagram.circles = 0;
  horizons.forEach((h, i) => {
    const color = css(kHorizonColors[i % kHorizonColors.length]);
    for (const [kind, fill] of [["constant", "none"], ["learned", color]]) {
      // Of a handful of landmarks the share says nothing.
      for (const bin of h[kind].bins.filter((b) => b.count >= 15)) {
        const radius = Math.max(2.5, Math.min(14, 40 * Math.sqrt(bin.count / h[kind].landmarks)));
        const circle = svg("circle", { cx: X(bin.predicted), cy: Y(bin.observed), r: radius, fill, stroke: color, "stroke-width": 1.3, "fill-opacity": 0.55, "stroke-opacity": fill === "none" ? 0.55 : 1 });
        circle.append(svg("title", {}, `${kind}, ${h.horizon_frames} frames ahead: ${fixed(bin.predicted, 2)} predicted, ${fixed(bin.observed, 2)} of ${bin.count} tracked`));
        parts.push(circle);
        ++diagram.circles;
      }
    }
    parts.push(svg("circle", { cx: X(0) + 12, cy: Y(1) + 8 + 17 * i, r: 5, fill: color, "fill-opacity": 0.55, stroke: color }), svg("text", { x: X(0) + 23, y: Y(1) + 12 + 17 * i }, `${h.horizon_frames} frames ahead`));
  });
  $("diagram").replaceChildren(...parts);
  const head = ["frames ahead", "survival", "predicted", "tracked", "bias", "mean abs. error", "correlation", "Brier score", "calibration error"];
  const body = make("tbody");
  for (const h of horizons) {
    for (const kind of ["constant", "learned"]) {
      const a = h[kind];
      body.append(make("tr", {}, make("th", { scope: "row" }, String(h.horizon_frames)), ...[kind, fixed(a.predicted_mean, 1), fixed(a.tracked_mean, 1), fixed(a.bias, 1),
        fixed(a.mean_absolute_error, 1), fixed(a.correlation, 2), fixed(a.brier, 3), fixed(a.calibration_error, 3)].map((text) => make("td", {}, text))));
    }
  }
  $("scores").replaceChildren(make("thead", {}, make("tr", {}, ...head.map((text) => make("th", {}, text)))), body);
  const claims = [["pose since the first, odometry's covariance", c.consistency.pose], ...c.consistency.motions.map((m) => [`motion over ${m.frames} frames, odometry's covariance`, m]), ...horizons.map((h) => [`motion over ${h.horizon_frames} frames, planner's covariance`, h.planner_consistency])].filter(([, k]) => k.errors > 0);
  const rows = make("tbody");
  for (const [what, k] of claims) {
    rows.append(make("tr", {}, make("th", { scope: "row" }, what), ...[String(k.errors), compact(k.mean), compact(k.median), `${fixed(100 * k.within_95, 0)} %`].map((text) => make("td", {}, text))));
  }
  $("consistency").replaceChildren(...(claims.length ? [make("thead", {}, make("tr", {}, ...["error² over claimed variance (1: true)", "errors", "mean", "median", "within the 95 % bound"].map((text) => make("th", {}, text)))), rows] : []));
}

// ---- The frame that is shown --------------------------------------------------------------------
const fields = [
  ["state", (k) => states[column.state[k]], (k) => ["", "warn", "bad"][column.state[k]]],
  ["tracked of expected", (k) => `${fixed(column.tracked[k], 0)} of ${fixed(column.expected[k], 0)}`],
  ["position error", (k) => metres(column.error[k])],
  ["orientation error", (k) => degrees(column.turned[k])],
].map(([label, text, kind]) => {
  const value = make("dd");
  $("now").append(make("div", {}, make("dt", {}, label), value));
  return (k) => { value.textContent = text(k); if (kind) value.className = kind(k); };
});
const reason = make("dd");
const reasonBox = make("div", { class: "full" }, make("dt", {}, "why"), reason);
$("now").append(reasonBox);

function seek(k) {
  step = Math.max(0, Math.min(n - 1, k));
  $("slider").value = step;
  $("clock").replaceChildren(String(step), make("span", {}, ` / ${n - 1} · ${fixed(column.time[step], 1)} s`));
  for (const field of fields) field(step);
  reasonBox.hidden = !run.reasons[step];
  reason.textContent = run.reasons[step] || "";
  for (const plot of plots) { plot.place(); plot.show(step); }
  drawPicture(step); drawPath(step);
}

player({ time: column.time, seek, step: () => step });

$("slider").max = n - 1;
drawCalibration();
dark.addEventListener("change", () => { for (const plot of plots) plot.recolor(); drawCalibration(); seek(step); });
// #frame=N opens at that frame; otherwise at the last.
const wanted = location.hash.match(/frame=(\d+)/);
seek(wanted ? Number(wanted[1]) : n - 1);
let width = 0;
new ResizeObserver(() => { if (canvas.clientWidth !== width) { width = canvas.clientWidth; seek(step); } }).observe(canvas);

// ---- Self-test: odometry.html#selftest ----------------------------------------------------------
// Moves the slider as a hand would and looks at what was drawn. Writes one line a fact into the page.
if (location.hash === "#selftest") Promise.allSettled(pictures.map((p) => p.ready)).then((loaded) => {
  const lines = [], failures = [];
  const expect = (what, ok) => { if (!ok) failures.push(what); };
  const rgb = (name) => { ink.fillStyle = css(name); return [1, 3, 5].map((i) => parseInt(ink.fillStyle.slice(i, i + 2), 16)); };
  try {
    loaded.forEach((l, i) => expect(`image ${i} loads`, l.status === "fulfilled"));
    for (const k of [...new Set([0, Math.floor(n / 2), n - 1, 0])]) {
      $("slider").value = k; $("slider").dispatchEvent(new Event("input", { bubbles: true }));
      lines.push(`frame ${k} image ${drawn.frame} tracked ${drawn.counts[0] + drawn.counts[1]} new ${drawn.counts[1]} missed ${drawn.counts[2]} at ${column.x[k].toFixed(3)} ${column.y[k].toFixed(3)}`);
      expect(`the image of frame ${k} is drawn`, drawn.picture);
      expect(`the clock is at ${k}`, $("clock").textContent.startsWith(`${k} /`));
      expect(`the image of frame ${k} is not blank`, greyLevels(canvas) > 20);
      const [red, green, blue] = rgb("--estimated"), dot = ink.getImageData(Math.round(marker.x), Math.round(marker.y), 1, 1).data;
      expect(`the path's marker is painted at frame ${k}`, Math.abs(dot[0] - red) + Math.abs(dot[1] - green) + Math.abs(dot[2] - blue) < 12);
      plots.forEach((plot, i) => {
        const x = plot.cursor.getBoundingClientRect().left - plot.cursor.parentElement.getBoundingClientRect().left;
        expect(`the cursor of plot ${i} is at frame ${k}`, Math.abs(x - plot.graph.toDomXCoord(column.time[k])) < 1);
      });
    }
    if (looped) lines.push(`loops ${loopsDrawn} of ${s.loops.used} drawn, poses with loops ${column.looped_x.filter(isNumber).length}`);
    lines.push(`plots ${plots.length} images ${pictures.length} circles ${diagram.circles}`);
    dispatchEvent(new KeyboardEvent("keydown", { key: "End", bubbles: true }));
    expect("the End key leads to the last frame", step === n - 1);
  } catch (e) { errors.push(String(e.stack || e)); }
  showSelftest(lines, failures);
});
})();
