// SPDX-License-Identifier: Apache-2.0
// Both plans of each planning step.
const replay = JSON.parse($("replay").textContent);
const steps = replay.steps;
let shown = 0;

// ---- What differs -----------------------------------------------------------------------------------
// Between the ends of both plans [m]; of a plan without a path, 0 beside another without one.
function apart(s) {
  const a = s.a.path, b = s.b.path;
  if (!a.length || !b.length) return a.length === b.length ? 0 : NaN;
  return Math.hypot(a.at(-2) - b.at(-2), a.at(-1) - b.at(-1));
}
const same = (s) => s.a.kind === s.b.kind && s.a.mode === s.b.mode && s.a.path.length === s.b.path.length && s.a.path.every((v, k) => v === s.b.path[k]);
const differing = steps.flatMap((s, k) => (same(s) ? [] : [k]));
// The farthest apart first.
const most = [...differing].sort((x, y) => (apart(steps[y]) || 0) - (apart(steps[x]) || 0) || x - y);
const middle = (values) => {
  const sorted = values.filter(isNumber).sort((a, b) => a - b), n = sorted.length;
  return n ? (sorted[(n - 1) >> 1] + sorted[n >> 1]) / 2 : NaN;
};
function sum() {
  if (!steps.length) return "No step was planned anew.";
  if (!differing.length) return `The plans of all ${plural(steps.length, "step")} are the same.`;
  const far = steps[most[0]], count = (what) => steps.filter((s) => s.a[what] !== s.b[what]).length;
  const ofKind = [["mode", count("mode")], ["kind of plan", count("kind")]].filter(([, n]) => n > 0).map(([what, n]) => `another ${what} in ${n}`);
  return [`Of ${plural(steps.length, "step")}, ${differing.length} ${differing.length === 1 ? "is" : "are"} planned otherwise, the first at ${fixed(steps[differing[0]].t, 1)} s`,
    isNumber(apart(far)) ? `; the plans end ${fixed(middle(differing.map((k) => apart(steps[k]))), 2)} m apart in the median of those, at most ${fixed(apart(far), 2)} m, in step ${far.step}` : "",
    ...ofKind.map((text) => `; ${text}`),
    `. Planning takes ${fixed(middle(steps.map((s) => s.a.ms)), 1)} ms as recorded, ${fixed(middle(steps.map((s) => s.b.ms)), 1)} ms by the other, in the median.`].join("");
}

// ---- Map ------------------------------------------------------------------------------------------
const canvas = $("map"), pen = canvas.getContext("2d");
const box = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
function grow(x, y) {
  box.x0 = Math.min(box.x0, x); box.x1 = Math.max(box.x1, x);
  box.y0 = Math.min(box.y0, y); box.y1 = Math.max(box.y1, y);
}
for (const s of steps) {
  for (let k = 0; k < s.map.length; k += 3) grow(s.map[k] * replay.resolution, s.map[k + 1] * replay.resolution);
  for (const plan of [s.a, s.b]) for (let k = 0; k < plan.path.length; k += 2) grow(plan.path[k], plan.path[k + 1]);
  grow(s.pose[0], s.pose[1]);
}
const cells = new Map();  // of the map up to step `known`
let known = -1;
function mapUpTo(step) {
  if (step < known) { cells.clear(); known = -1; }
  while (known < step) {
    const changes = steps[++known].map;
    for (let k = 0; k < changes.length; k += 3) cells.set(changes[k] + "," + changes[k + 1], [changes[k], changes[k + 1], changes[k + 2]]);
  }
}
function draw() {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * ratio; canvas.height = height * ratio;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = css("--map-unknown"); pen.fillRect(0, 0, width, height);
  if (steps.length === 0) return;
  const room = 0.6, scale = Math.min(width / (box.x1 - box.x0 + 2 * room), height / (box.y1 - box.y0 + 2 * room));
  const x = (m) => width / 2 + (m - (box.x0 + box.x1) / 2) * scale, y = (m) => height / 2 - (m - (box.y0 + box.y1) / 2) * scale;
  mapUpTo(shown);
  const r = replay.resolution, size = Math.ceil(r * scale * 10) / 10 + 0.3;
  for (const [state, color] of [[1, css("--map-free")], [2, css("--map-occupied")]]) {
    pen.fillStyle = color;
    for (const [i, j, is] of cells.values()) if (is === state) pen.fillRect(x(i * r), y((j + 1) * r), size, size);
  }
  const line = (points, color, thick) => {
    if (points.length < 2) return;
    pen.beginPath(); points.forEach(([a, b], k) => (k ? pen.lineTo(x(a), y(b)) : pen.moveTo(x(a), y(b))));
    pen.strokeStyle = color; pen.lineWidth = thick; pen.lineCap = pen.lineJoin = "round"; pen.stroke();
  };
  const s = steps[shown];
  pen.fillStyle = css("--frontier");
  for (let k = 0; k < s.frontiers.length; k += 2) pen.fillRect(x(s.frontiers[k]) - 1, y(s.frontiers[k + 1]) - 1, 2, 2);
  line(steps.slice(0, shown + 1).map((q) => q.pose), css("--ink-3"), 1.2);
  const pairs = (flat) => Array.from({ length: flat.length / 2 }, (_, k) => [flat[2 * k], flat[2 * k + 1]]);
  line(pairs(s.a.path), css("--estimated"), 4);
  line(pairs(s.b.path), css("--horizon"), 2.2);
  pen.beginPath(); pen.arc(x(s.pose[0]), y(s.pose[1]), Math.max(4, replay.radius * scale), 0, 2 * Math.PI);
  pen.fillStyle = css("--surface"); pen.fill(); pen.strokeStyle = css("--ink"); pen.lineWidth = 1.4; pen.stroke();
  pen.beginPath(); pen.moveTo(x(s.pose[0]), y(s.pose[1]));
  pen.lineTo(x(s.pose[0] + 1.4 * replay.radius * Math.cos(s.pose[2])), y(s.pose[1] + 1.4 * replay.radius * Math.sin(s.pose[2]))); pen.stroke();
}

// ---- Terms ----------------------------------------------------------------------------------------
const names = [...new Set(steps.flatMap((s) => [...Object.keys(s.a.terms), ...Object.keys(s.b.terms)]))];
function table() {
  const s = steps[shown], rows = [];
  const row = (label, a, b, attributes = {}) => rows.push(make("tr", attributes, make("th", {}, label), make("td", {}, a), make("td", {}, b)));
  for (const name of names) row(name.replace(/_/g, " "), compact(s.a.terms[name]), compact(s.b.terms[name]));
  row("cost", compact(s.a.cost), compact(s.b.cost), { class: "total" });
  row("features predicted", fixed(s.a.features, 0), fixed(s.b.features, 0));
  row("features tracked next", shown + 1 < steps.length ? String(steps[shown + 1].tracked) : "–", "not driven");
  row("planning [ms]", fixed(s.a.ms, 1), fixed(s.b.ms, 1));
  row("evaluations", String(s.a.evaluations), String(s.b.evaluations));
  row("plan", s.a.kind, s.b.kind);
  row("mode", s.a.mode, s.b.mode);
  row("from seed", s.a.seed || "–", s.b.seed || "–");
  $("terms").replaceChildren(
    make("thead", {}, make("tr", {}, make("th", {}), make("th", { class: "a" }, replay.recorded), make("th", { class: "b" }, replay.other + ", open loop"))),
    make("tbody", {}, ...rows));
}

// ---- Over time ------------------------------------------------------------------------------------
const plots = [];
function plot(title, labels, values, colors) {
  const area = make("div", { class: "area" });
  $("plots").append(make("div", { class: "card" }, make("h2", {}, title), area));
  const rows = steps.map((s, k) => [s.t, ...values(s, k).map((v) => (isNumber(v) ? v : null))]);
  plots.push(new Dygraph(area, rows, {
    labels: ["time", ...labels], colors: colors.map(css), strokeWidth: 1.4, axisLabelFontSize: 11, legend: "follow",
    gridLineColor: css("--grid"), axisLineColor: css("--line"), xlabel: "", digitsAfterDecimal: 3,
    underlayCallback: (context, place, g) => {
      if (!steps[shown]) return;
      context.fillStyle = css("--ink-3"); context.fillRect(g.toDomXCoord(steps[shown].t), place.y, 1, place.h);
    },
    clickCallback: (e, time) => show(steps.reduce((best, s, k) => (Math.abs(s.t - time) < Math.abs(steps[best].t - time) ? k : best), 0)),
  }));
}
function showDiffering() {
  for (const button of $("most").children) button.setAttribute("aria-pressed", String(+button.dataset.step === shown));
  $("before").disabled = !differing.some((k) => k < shown);
  $("after").disabled = !differing.some((k) => k > shown);
}
function show(step) {
  shown = Math.min(Math.max(0, step), steps.length - 1);
  $("slider").value = shown;
  $("clock").textContent = steps.length ? `${fixed(steps[shown].t, 1)} s, step ${steps[shown].step}` : "";
  draw();
  if (steps.length) table();
  showDiffering();
  for (const g of plots) g.updateOptions({});
}
const pair = [replay.recorded, replay.other + ", open loop"], pairColors = ["--estimated", "--horizon"];
$("slider").max = Math.max(0, steps.length - 1);
$("slider").addEventListener("input", (e) => show(+e.target.value));
if (steps.length) {
  plot("Cost", pair, (s) => [s.a.cost, s.b.cost], pairColors);
  plot("Features predicted for the end of the committed part, and tracked there by the recorded mission", [...pair, "tracked"],
    (s, k) => [s.a.features, s.b.features, k + 1 < steps.length ? steps[k + 1].tracked : null], [...pairColors, "--true"]);
  plot("Planning [ms]", pair, (s) => [s.a.ms, s.b.ms], pairColors);
  plot("Distance between the ends of both plans [m]", ["apart"], (s) => [apart(s)], ["--accent"]);
}
$("sum").textContent = sum();
for (const k of most.slice(0, 6)) {
  const button = make("button", { "data-step": k }, `step ${steps[k].step}: ${isNumber(apart(steps[k])) ? `${fixed(apart(steps[k]), 2)} m apart` : "one plan alone"}`);
  button.addEventListener("click", () => show(k));
  $("most").append(button);
}
$("before").addEventListener("click", () => show(differing.findLast((k) => k < shown) ?? shown));
$("after").addEventListener("click", () => show(differing.find((k) => k > shown) ?? shown));
addEventListener("resize", draw);
dark.addEventListener("change", () => show(shown));
show(most[0] ?? 0);
