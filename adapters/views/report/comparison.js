// SPDX-License-Identifier: Apache-2.0
const comparison = JSON.parse($("comparison").textContent);
const missions = [1, 2].map((which) => {
  const text = $(`run-${which}`).textContent, run = JSON.parse(text);
  const column = new Proxy({}, { get: (all, name) => (all[name] ||= run.columns[name] ? floats(run.columns[name]) : new Float32Array(run.steps || 0)) });
  return { run, text, column, frame: $(`frame-${which}`), name: comparison.names[which - 1] };
});
const [first, second] = missions;

// ---- One clock for both -----------------------------------------------------------------------
const times = [...new Set(missions.flatMap(({ column }) => [...column.time]).map((t) => Math.round(1e4 * t) / 1e4))].sort((a, b) => a - b);
// The newest step of each mission at each of the times; -1: it has ended.
for (const mission of missions) {
  const { time } = mission.column, last = time.length - 1;
  let k = 0;
  mission.stepAt = times.map((t) => { while (k < last && time[k + 1] <= t + 1e-4) ++k; return k; });
  mission.ended = times.map((t) => last < 0 || t > time[last] + 1e-4);
}
let shown = -1;
function seek(k) {
  if (times.length === 0) return;
  shown = Math.min(times.length - 1, Math.max(0, Math.round(k)));
  $("slider").value = shown;
  $("clock").replaceChildren(fixed(times[shown], 1), make("span", {}, ` / ${fixed(times[times.length - 1], 1)} s`));
  missions.forEach((mission, i) => {
    mission.frame.contentWindow?.mission?.seek(mission.stepAt[shown]);
    const { summary } = mission.run, over = mission.ended[shown];
    $(`name-${i + 1}`).textContent = `${mission.name} · seed ${summary.seed} · ${summary.solver}${over ? ` · ended after ${fixed(summary.duration_s, 1)} s: ${summary.reason}` : ""}`;
  });
  for (const plot of drawing.plots) { plot.place(); plot.show(shown); }
}
const parting = comparison.time === null ? -1 : times.findLastIndex((t) => t <= comparison.time + 1e-4);
$("said").textContent = `They ${comparison.said === "the same as long as both last" ? "are " : ""}${comparison.said}.`;
$("slider").max = Math.max(0, times.length - 1);
if (parting >= 0) {
  $("mark").hidden = $("parting").hidden = false;
  const share = times.length > 1 ? parting / (times.length - 1) : 0;
  $("mark").style.left = `calc(8px + (100% - 16px) * ${share} - 1px)`;
  $("parting").addEventListener("click", () => seek(parting));
}

// ---- Over time --------------------------------------------------------------------------------
const drawing = recordingPlots({ column: { time: times, state: new Uint8Array(times.length) }, step: () => shown, seek });
const held = (mission, values) => times.map((_, k) => (mission.ended[k] ? NaN : values[mission.stepAt[k]]));
if (times.length > 0) {
  const plot = (title, unit, name, scale, digits) => {
    if (missions.every(({ column }) => !column[name].some(Number.isFinite))) return;
    drawing.add(title, unit, missions.map((mission, i) => ({ name: mission.name, color: i === 0 ? "--estimated" : "--horizon",
      values: held(mission, mission.column[name].map((v) => scale * v)) })), (v) => fixed(v, digits));
  };
  plot("Coverage", "% of the reachable area", "coverage", 100, 1);
  plot("Path", "m", "path_length", 1, 1);
  plot("Localization error", "m", "localization_error", 1, 3);
  plot("Features tracked", "", "tracked_features", 1, 0);
  plot("Planning time", "ms", "plan_ms", 1, 1);
  plot("Cost", "", "cost", 1, 2);
}

// ---- Tables -----------------------------------------------------------------------------------
function table(id, rows, nothing) {
  const row = (cells, tag) => make("tr", {}, ...cells.map((text, i) => make(i === 0 || tag === "th" ? "th" : "td", i === 0 ? { scope: "row" } : tag === "th" ? { scope: "col", class: i === 1 ? "a" : "b" } : {}, text)));
  if (rows.length === 0) { $(id).replaceWith(make("p", { class: "facts" }, nothing)); return; }
  $(id).append(make("thead", {}, row(["", first.name, second.name], "th")), make("tbody", {}, ...rows.map((cells) => row(cells, "td"))));
}
const both = (label, text) => [label, ...missions.map(({ run }) => text(run.summary))];
table("results", [
  both("World", (s) => s.world), both("How it ended", (s) => s.reason),
  both("Coverage of the reachable area, %", (s) => fixed(isNumber(s.coverage) ? 100 * s.coverage : NaN, 1)),
  both("Of it seen, m²", (s) => fixed(s.area_m2, 1)),
  ...[90, 95, 99].map((share) => both(`Time to ${share} %, s`, (s) => fixed(s[`time_to_${share}_s`], 1))),
  both("Duration, s", (s) => fixed(s.duration_s, 1)), both("Path, m", (s) => fixed(s.path_length_m, 1)),
  both("Collisions", (s) => fixed(s.collisions, 0)), both("Losses of localization", (s) => fixed(s.losses, 0)),
  both("Localization error, root mean square, m", (s) => fixed(s.localization_rmse_m, 3)),
  both("Localization error at the end, m", (s) => fixed(s.localization_final_m, 3)),
  both("Planning time, median, ms", (s) => fixed(s.plan_ms?.p50, 1)), both("Planning time, 95 %, ms", (s) => fixed(s.plan_ms?.p95, 1)),
  both("Stopping tails", (s) => fixed(s.fallbacks, 0)), both("Guard stops", (s) => fixed(s.guard_stops, 0)),
], "");
// Each key of a configuration with its value, lists and all, without comments.
function settings(text) {
  const all = new Map(), path = [];
  let last = "";
  for (const line of text.split("\n")) {
    const code = line.replace(/(^|\s)#.*$/, "").trimEnd();
    const key = code.match(/^(\s*)([\w.-]+):(?:\s+(.*))?$/);
    if (!key) { if (code.trim() && last) all.set(last, `${all.get(last)} ${code.trim()}`.trim()); continue; }
    path.length = key[1].length / 2;
    path.push(key[2]);
    last = path.join(".");
    all.set(last, key[3] || "");
  }
  return all;
}
const [ours, theirs] = missions.map(({ run }) => settings(run.configuration));
const said = (value) => (value === undefined ? "–" : value === "" ? "" : value);
table("settings", [...new Set([...ours.keys(), ...theirs.keys()])].filter((key) => ours.get(key) !== theirs.get(key))
  .map((key) => [key, said(ours.get(key)), said(theirs.get(key))]), "Nothing.");

// ---- Both maps --------------------------------------------------------------------------------
const pageOf = (mission) => mission.frame.contentWindow.mission;
$("together").checked = first.run.summary.world === second.run.summary.world;
let lead = first;
function follow(mission) {
  lead = mission;
  const other = mission === first ? second : first;
  if ($("together").checked && pageOf(mission) && pageOf(other)) pageOf(other).setView(pageOf(mission).view());
}
$("together").addEventListener("change", () => follow(lead));
const frames = (source) => missions.find(({ frame }) => frame.contentWindow === source);
addEventListener("message", ({ data, source }) => {
  const mission = frames(source);
  if (!mission) return;
  if (data === "moved") follow(mission);
  if (data === "grown") mission.frame.style.height = `${mission.frame.contentDocument.body.scrollHeight + 2}px`;
});
const ready = Promise.all(missions.map((mission) => new Promise((resolve) => {
  mission.frame.addEventListener("load", resolve, { once: true });
  mission.frame.srcdoc = comparison.frame.split(comparison.place).join(mission.text);
})));
const play = player({ time: times, seek, step: () => shown, speed: () => Number($("speed").value), spare: "select", spaced: "button, label" });
dark.addEventListener("change", () => { for (const plot of drawing.plots) plot.recolor(); });
seek(parting > 0 ? parting : times.length - 1);
ready.then(() => {
  seek(shown);
  follow(first);
});

// ---- Self-test: comparison page#selftest ------------------------------------------------------
if (location.hash === "#selftest") ready.then(async () => {
  const lines = [], failures = [];
  const expect = (what, ok) => { if (!ok) failures.push(what); };
  try {
    expect("it opens where the missions part", parting <= 0 || shown === parting);
    for (const share of [0, 0.3, 0.7, 1]) {
      $("slider").value = Math.round(share * (times.length - 1));
      $("slider").dispatchEvent(new Event("input", { bubbles: true }));
      const at = missions.map((mission) => pageOf(mission).step());
      missions.forEach((mission, i) => expect(`mission ${i + 1} shows the step of ${times[shown]} s`, Math.abs(mission.column.time[at[i]] - times[shown]) < 1e-3
        || (at[i] === mission.column.time.length - 1 && times[shown] > mission.column.time[at[i]]) || mission.column.time[at[i] + 1] > times[shown]));
      lines.push(`at ${fixed(times[shown], 1)} s steps ${at.join(" ")}`);
    }
    const wanted = { ...pageOf(first).view(), scale: 31 };
    pageOf(first).setView(wanted);
    follow(first);
    expect("the maps move together", !$("together").checked || pageOf(second).view().scale === 31);
    $("together").checked = false;
    pageOf(first).setView({ ...wanted, scale: 47 });
    follow(first);
    expect("or each on its own", pageOf(second).view().scale !== 47);
    for (const mission of missions) {
      const { canvas } = pageOf(mission), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const colors = new Set();
      for (let i = 0; i < data.length; i += 4) colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
      expect(`the map of ${mission.name} is drawn`, colors.size > 20);
      expect(`the frame of ${mission.name} is as high as its page`, mission.frame.clientHeight > 600);
    }
    const before = shown;
    missions[1].frame.contentWindow.dispatchEvent(new missions[1].frame.contentWindow.KeyboardEvent("keydown", { key: "Home", bubbles: true, cancelable: true }));
    expect("keys in a map move both", before > 0 && shown === 0);
    expect("numbers only", !/\bNaN\b|undefined|null|Infinity/.test(document.body.innerText));
    lines.push(`plots ${drawing.plots.length}`, `said ${$("said").textContent}`, `settings ${$("settings")?.tBodies[0]?.rows.length ?? 0}`);
  } catch (e) { errors.push(String(e.stack || e)); }
  showSelftest(lines, failures);
});
