// SPDX-License-Identifier: Apache-2.0
(() => {
const bench = JSON.parse($("bench").textContent);
const deadlineText = (seconds) => (seconds > 0 ? `${compact(1000 * seconds)} ms` : "none");
const percent = (share) => `${compact(100 * share)} %`;

// ---- Head ---------------------------------------------------------------------------------------
const problems = bench.sets.reduce((sum, set) => sum + set.problems.length, 0);
const found = bench.sets.reduce((sum, set) => sum + set.problems.filter((p) => p.best_known_by && p.best_known_by !== "stored").length, 0);
const environment = bench.environments[0] || {};
const build = environment.build || {};
const commit = build.commit ? `commit ${build.commit.slice(0, 10)}${build.commit_changed ? ", with changes" : ""}` : "";
$("facts").textContent = [bench.program, commit, build.compiler, build.build_type, environment.processor,
  bench.cancelled ? "cancelled before all problems were done" : "", plural(problems, "problem"), plural(bench.solvers.length, "back end"),
  plural(bench.repeats, "repeat"), `at most ${bench.max_evaluations} evaluations`, `${bench.seeds.length > 1 ? "seeds" : "seed"} ${bench.seeds.join(", ")}`,
  bench.clock === "cpu" ? "times of the processor" : ""].filter(Boolean).join(" · ");
$("busy").textContent = bench.busy;
$("busy").hidden = !bench.busy;
$("rule").textContent = `Solved: feasible to ${compact(bench.feasibility_tolerance)} and a cost of at most best + max(${bench.relative_tolerance} |best|, a), ` +
  bench.sets.map((set) => set.absolute_tolerance > 0 ? `a = ${set.absolute_tolerance} in ${set.name}` : `of the difference between start and best in ${set.name}`).join(", ") +
  `. Best: the best cost known, or found in this run where none is known or that is lower (${found} of ${plural(problems, "problem")}). Optimum: claimed by the back end, and proven by the judge of all. “To target”: until the first such point, over all problems; – where more than the stated share was not solved. Geometric means and ranks: with 95 % intervals over the problems (hover).`;

// ---- Colours: one a back end, the same in all plots -----------------------------------------------
const hues = ["#2563eb", "#ea580c", "#0d9488", "#c026d3", "#ca8a04", "#dc2626", "#65a30d", "#0891b2", "#7c3aed", "#57534e",
  "#db2777", "#1e3a8a", "#9a3412", "#115e59", "#86198f", "#713f12", "#7f1d1d", "#3f6212"];
const lightHues = ["#6ea0ff", "#fb923c", "#2dd4bf", "#e879f9", "#facc15", "#f87171", "#a3e635", "#22d3ee", "#a78bfa", "#a8a29e",
  "#f472b6", "#93c5fd", "#fdba74", "#99f6e4", "#f0abfc", "#fde68a", "#fca5a5", "#d9f99d"];
const color = (k) => (dark.matches ? lightHues : hues)[k % hues.length];
const hidden = new Set();

// ---- Choice of set and deadline -------------------------------------------------------------------
const names = [...new Set(bench.summary.map((group) => group.set))];
for (const name of names) $("set").append(make("option", { value: name }, name === "all" ? "all sets" : name));
for (const seconds of bench.deadlines_s) $("deadline").append(make("option", { value: seconds }, deadlineText(seconds)));
$("deadline").value = bench.deadlines_s[bench.deadlines_s.length - 1];
const group = () => bench.summary.find((g) => g.set === $("set").value && g.deadline_s === +$("deadline").value);

// ---- Table ----------------------------------------------------------------------------------------
function fillSummary() {
  const g = group();
  const withDeadline = g.deadline_s > 0;
  // [head, unit, value of a row, interval]
  const columns = [
    ["optima", "verified", (s) => s.optima], ["geometric mean", "ms", (s) => s.geometric_ms.mean, (s) => s.geometric_ms],
    ["", "evaluations", (s) => s.geometric_evaluations.mean, (s) => s.geometric_evaluations],
    ["rank", "by time", (s) => s.rank_by_time.mean, (s) => s.rank_by_time], ["", "by evaluations", (s) => s.rank_by_evaluations.mean, (s) => s.rank_by_evaluations],
    ["to target", "ms, median", (s) => s.ms_to_target.median], ["", "p90", (s) => s.ms_to_target.p90], ["", "p99", (s) => s.ms_to_target.p99],
    ["", "evaluations", (s) => s.evaluations_to_target_median],
    ["whole solve", "ms, median", (s) => s.ms.median], ["", "p90", (s) => s.ms.p90], ["", "p99", (s) => s.ms.p99],
    ["", "evaluations", (s) => s.evaluations_median], ["", "with gradient", (s) => s.gradients_median], ["gap", "median", (s) => s.gap_median],
    ...(withDeadline ? [["past deadline", "ms, median", (s) => s.overrun_ms.p50], ["", "p99", (s) => s.overrun_ms.p99], ["", "worst", (s) => s.overrun_ms.max]] : []),
  ];
  const head = make("tr", {}, make("th", {}, "back end"), make("th", {}, "solved"));
  for (const [what, unit] of columns) head.append(make("th", {}, what, make("br"), unit));
  const body = make("tbody");
  const best = columns.map(([, , value]) => Math.min(...g.solvers.map(value).filter(isNumber)));
  const most = Math.max(...g.solvers.map((s) => s.solved));
  g.solvers.forEach((s, k) => {
    const mark = make("i");
    mark.style.background = color(k);
    const name = make("th", { scope: "row", tabindex: "0", role: "button", "aria-pressed": String(!hidden.has(k)) }, mark, s.solver);
    const toggle = () => { if (!hidden.delete(k)) hidden.add(k); fillSummary(); drawAll(); };
    name.addEventListener("click", toggle);
    name.addEventListener("keydown", (e) => { if (e.key === "Enter" || e.key === " ") { e.preventDefault(); toggle(); } });
    const bar = make("b");
    bar.style.width = `${100 * s.solved / s.problems}%`;
    const notes = [s.refused && `${s.refused} refused`, s.errors && `${s.errors} errors`].filter(Boolean).join(", ");
    const row = make("tr", hidden.has(k) ? { class: "off" } : {}, name,
      make("td", { class: s.solved === most ? "share best" : "share", title: notes }, make("span", { class: "bar" }, bar), `${s.solved} of ${s.problems}${notes ? "*" : ""}`));
    columns.forEach(([, , value, interval], c) => {
      const x = value(s);
      const shown = isNumber(x) && c > 0 && c < 9 && x === best[c] ? { class: "best" } : {};
      if (interval) shown.title = `${compact(interval(s).low)} to ${compact(interval(s).high)}`;
      row.append(make("td", shown, compact(x)));
    });
    body.append(row);
  });
  $("summary").replaceChildren(make("thead", {}, head), body);
}

// ---- Plots ----------------------------------------------------------------------------------------
const power = (v) => {
  const x = 10 ** v;
  return x >= 1e-3 && x < 1e5 ? String(+x.toPrecision(2)) : `1e${Math.round(v)}`.replace("-", "−");
};
// Ticks at whole powers of ten, and at 2 and 5 between them where there is room.
function ticker(low, high, pixels) {
  const fine = pixels / (high - low) > 140 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil((high - low) / (pixels / 50)));
  const ticks = [];
  for (let e = Math.floor(low); e <= Math.ceil(high); ++e) {
    if (e % every) continue;
    for (const m of fine) {
      const v = e + Math.log10(m);
      if (v >= low - 1e-9 && v <= high + 1e-9) ticks.push({ v, label: power(v) });
    }
  }
  return ticks;
}
const logAxis = (label) => ({ ticker: (a, b, pixels) => ticker(a, b, pixels), axisLabelFormatter: power, valueFormatter: power, ...label });

const plots = [];
function addPlot(title, unit, build) {
  const area = make("div", { class: "area" });
  const heading = make("h2", {}, title, make("em", {}, unit));
  $("plots").append(make("div", { class: "card" }, heading, area));
  plots.push({ area, build, graph: null, rows: 0 });
}

// Steps of all back ends on one axis of log10 of the ratio.
function profileData(g, key) {
  const ratios = [...new Set([1, ...g.solvers.flatMap((s) => s[key].ratio)])].sort((a, b) => a - b);
  const end = Math.max(1.5, ratios[ratios.length - 1]);
  ratios.push(1.15 * end);
  const at = g.solvers.map(() => 0), share = g.solvers.map(() => 0);
  const rows = ratios.map((ratio) => [Math.log10(ratio), ...g.solvers.map((s, k) => {
    const steps = s[key];
    while (at[k] < steps.ratio.length && steps.ratio[at[k]] <= ratio) share[k] = steps.share[at[k]++];
    return share[k];
  })]);
  return { rows, options: {
    stepPlot: true, strokeWidth: 1.8, valueRange: [0, 1.03], dateWindow: [0, Math.log10(1.15 * end)],
    axes: { x: logAxis({ axisLabelWidth: 46 }), y: { axisLabelFormatter: (v) => `${Math.round(100 * v)} %`, axisLabelWidth: 44, pixelsPerLabel: 40 } },
  } };
}

const kFloor = 1e-6;
function curveData(g, key, axis, unit) {
  const at = (g.solvers.find((s) => s[key][axis].length) || { [key]: { [axis]: [] } })[key][axis];
  const finite = g.solvers.flatMap((s) => [...s[key].median, ...s[key].upper]).filter(isNumber);
  const top = Math.min(1e4, Math.max(0.1, ...finite)) * 1.5;
  const log = (gap) => Math.log10(Math.min(top, Math.max(kFloor, gap)));
  const rows = at.map((x, i) => [Math.log10(unit * x), ...g.solvers.map((s) => {
    const c = s[key];
    if (!isNumber(c.median[i])) return [null, null, null];
    return [log(c.lower[i]), log(c.median[i]), isNumber(c.upper[i]) ? log(c.upper[i]) : Math.log10(top)];
  })]);
  return { rows, options: {
    customBars: true, fillAlpha: g.solvers.length - hidden.size > 4 ? 0.05 : 0.12, strokeWidth: 1.8,
    valueRange: [Math.log10(kFloor) - 0.15, Math.log10(top)],
    axes: { x: logAxis({ axisLabelWidth: 46 }), y: { ...logAxis({ axisLabelWidth: 44 }) } },
    underlayCallback: (context, chart, graph) => {
      const y = graph.toDomYCoord(Math.log10(bench.relative_tolerance));
      context.strokeStyle = css("--good");
      context.setLineDash([5, 4]);
      context.beginPath(); context.moveTo(chart.x, y); context.lineTo(chart.x + chart.w, y); context.stroke();
      context.setLineDash([]);
    },
  } };
}

// Share of pairs with its interval.
function targetData(g, key, axis, unit) {
  const at = (g.solvers.find((s) => s[key][axis].length) || { [key]: { [axis]: [] } })[key][axis];
  const rows = at.map((x, i) => [Math.log10(unit * x), ...g.solvers.map((s) => {
    const c = s[key];
    return isNumber(c.share[i]) ? [c.low[i], c.share[i], c.high[i]] : [null, null, null];
  })]);
  return { rows, options: {
    customBars: true, fillAlpha: g.solvers.length - hidden.size > 4 ? 0.05 : 0.12, strokeWidth: 1.8, valueRange: [0, 1.03],
    axes: { x: logAxis({ axisLabelWidth: 46 }), y: { axisLabelFormatter: (v) => `${Math.round(100 * v)} %`, axisLabelWidth: 44, pixelsPerLabel: 40 } },
  } };
}

addPlot("Targets reached, by time", "ms; share of (problem, target) pairs, gaps from 1 to 1e-6; 95 %", (g) => targetData(g, "targets_over_time", "seconds", 1000));
addPlot("Targets reached, by evaluations", "share of (problem, target) pairs; 95 %", (g) => targetData(g, "targets_over_evaluations", "evaluations", 1));
addPlot("Performance profile, by time", "share solved within a factor of the fastest", (g) => profileData(g, "profile_by_time"));
addPlot("Performance profile, by evaluations", "share solved within a factor of the fewest evaluations", (g) => profileData(g, "profile_by_evaluations"));
addPlot("Gap against time", "ms; median and quartiles over the problems; dashed: solved", (g) => curveData(g, "gap_over_time", "seconds", 1000));
addPlot("Gap against evaluations", "median and quartiles over the problems; dashed: solved", (g) => curveData(g, "gap_over_evaluations", "evaluations", 1));

function drawAll() {
  const g = group();
  for (const plot of plots) {
    if (plot.graph) plot.graph.destroy();
    const { rows, options } = plot.build(g);
    plot.rows = rows.length;
    plot.graph = rows.length < 2 ? null : new Dygraph(plot.area, rows, {
      labels: ["x", ...g.solvers.map((s) => s.solver)], colors: g.solvers.map((s, k) => color(k)), visibility: g.solvers.map((s, k) => !hidden.has(k)),
      legend: "never", labelsDiv: make("div"), gridLineColor: css("--grid"), axisLineColor: css("--line"), axisLineWidth: 1, rightGap: 14, xAxisHeight: 20,
      highlightCircleSize: 0, highlightSeriesOpts: { strokeWidth: 3 }, highlightSeriesBackgroundAlpha: 1, ...options,
    });
    if (!plot.graph) plot.area.replaceChildren(make("p", { class: "note" }, "Nothing to draw: no back end found a feasible point."));
  }
}

// ---- Every problem --------------------------------------------------------------------------------
function fillCells() {
  const g = group();
  const of = new Map();
  for (const row of bench.rows) {
    if (row.deadline_s !== g.deadline_s) continue;
    const key = `${row.set}\n${row.problem}\n${row.solver}`;
    if (!of.has(key)) of.set(key, []);
    of.get(key).push(row);
  }
  const body = make("tbody");
  for (const set of bench.sets) {
    if (g.set !== "all" && g.set !== set.name) continue;
    for (const problem of set.problems) {
      const line = make("tr", {}, make("th", { scope: "row", title: `best known: ${compact(problem.best_known)} (${problem.best_known_by || "none"}); ${plural(problem.variables, "variable")}, ${plural(problem.constraints, "constraint")}` },
        g.set === "all" ? `${set.name}: ${problem.name}` : problem.name), make("td", {}, isNumber(problem.best_known) ? String(+problem.best_known.toPrecision(6)).replace("-", "−") : "–"));
      for (const solver of bench.solvers) {
        const runs = of.get(`${set.name}\n${problem.name}\n${solver}`);
        if (!runs) { line.append(make("td", { class: "none" }, "–")); continue; }
        // Of several seeds the one of median gap.
        const byGap = [...runs].sort((a, b) => (isNumber(a.gap) ? a.gap : Infinity) - (isNumber(b.gap) ? b.gap : Infinity));
        const row = byGap[Math.floor(byGap.length / 2)];
        const refused = row.stop_reason === "not supported";
        const kind = row.solved ? "solved" : refused ? "none" : isNumber(row.gap) ? "" : "infeasible";
        const title = refused ? row.detail : `${solver}: cost ${row.cost}, violation ${compact(row.violation)}, ${compact(row.wall_ms)} ms, ${row.cost_evaluations} evaluations, ${row.quality}, first-order residual ${compact(row.optimality)}, ${row.stop_reason}: ${row.detail}${runs.length > 1 ? ` (seed ${row.seed}, of median gap of ${runs.length})` : ""}`;
        line.append(make("td", { class: kind, title }, refused ? "–" : isNumber(row.gap) ? compact(row.gap) : "✕"));
      }
      body.append(line);
    }
  }
  $("cells").replaceChildren(make("thead", {}, make("tr", {}, make("th", {}, "problem"), make("th", {}, "best"), ...bench.solvers.map((s) => make("th", {}, s.replace("nlopt:", ""))))), body);
}

// ---- What measured --------------------------------------------------------------------------------
function fillEnvironments() {
  const body = make("tbody");
  const line = (name, value) => body.append(make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, value)));
  const word = (x) => (x === null || x === undefined || x === "" ? "–" : String(x));
  bench.environments.forEach((e, i) => {
    const b = e.build || {};
    if (bench.environments.length > 1) line("environment", `${i + 1}, ${plural(bench.rows.filter((r) => r.environment === i).length, "row")}`);
    line("processor", `${word(e.processor)}, ${plural(e.cores || 0, "core")}, ${word(e.memory_mb)} MB`);
    line("system", `${word(e.system)}, ${word(e.kernel)}`);
    const loads = bench.rows.filter((r) => r.environment === i && isNumber(r.load)).map((r) => r.load);
    line("clock", bench.clock === "cpu" ? "processor time of all threads" : "the wall's");
    line("load", loads.length ? `${compact(Math.min(...loads))} to ${compact(Math.max(...loads))} while it ran` : "–");
    line("commit", `${word(b.commit)}${b.commit_changed ? ", with changes" : ""}`);
    line("compiler", `${word(b.compiler)}, ${word(b.build_type)}, ${word(b.flags)}`);
    line("libraries", (b.libraries || []).map((l) => `${l.name} ${l.built_with}${l.runs_with ? ` (${l.runs_with})` : ""}`).join(", ") || "–");
    line("threads", Object.entries(e.threads || {}).map(([k, v]) => `${k}=${v === null ? "not set" : v}`).join(", ") || "–");
    line("started", word(e.started));
  });
  $("environments").replaceChildren(body);
}

function show() { fillSummary(); drawAll(); fillCells(); }
$("set").addEventListener("change", show);
$("deadline").addEventListener("change", show);
dark.addEventListener("change", show);
fillEnvironments();
show();

// ---- Self-test: bench.html#selftest ---------------------------------------------------------------
// Goes through every choice as a hand would and writes what is shown, one line a fact.
if (location.hash === "#selftest") {
  const lines = [];
  const failures = [];
  const expect = (what, ok) => { if (!ok) failures.push(what); };
  try {
    for (const set of [...$("set").options]) {
      for (const deadline of [...$("deadline").options]) {
        $("set").value = set.value; $("deadline").value = deadline.value;
        $("set").dispatchEvent(new Event("change"));
        const solved = [...$("summary").querySelectorAll("tbody tr")].map((row) => row.children[1].textContent);
        lines.push(`${set.value} ${deadline.value} solved ${solved.join(", ")} problems ${$("cells").tBodies[0].rows.length} green ${$("cells").querySelectorAll(".solved").length}`);
        plots.forEach((plot, i) => expect(`plot ${i} of ${set.value}, ${deadline.value} is drawn`, plot.graph && plot.rows > 1));
      }
    }
    // Hiding a back end takes its line out of every plot.
    $("summary").querySelector("tbody th").click();
    for (const plot of plots) expect("a hidden back end is not drawn", plot.graph && plot.graph.visibility()[0] === false);
  } catch (e) {
    failures.push(String(e));
  }
  showSelftest(lines, failures);
}
})();
