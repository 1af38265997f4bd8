// SPDX-License-Identifier: Apache-2.0

// ---- Live view --------------------------------------------------------------------------------
// What happens now: steps for `page`, and what the robot says of itself, by a WebSocket of where the page came from.
(() => {
const wanted = new URLSearchParams(location.search).get("token");
// Not left in the address, which is shown, copied and remembered.
if (wanted) {
  sessionStorage.setItem("token", wanted);
  history.replaceState(null, "", location.pathname + location.hash);
}
const token = wanted || sessionStorage.getItem("token") || "";
const start = JSON.parse($("run").textContent);
let socket = null, opened = false, ended = false, mayCommand = false, realTime = true;
let status = null, going = false, plotsAt = 0, plotsDue = 0;

$("empty").textContent = "Waits for the first planning step.";
document.querySelector(".below h2").textContent = "Health";

function say(text, bad = false) {
  $("said").textContent = text;
  $("said").className = bad ? "said bad" : "said";
}

// ---- Connection -------------------------------------------------------------------------------
function connect() {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live${token ? `?token=${encodeURIComponent(token)}` : ""}`, ["prospect.live.v1"]);
  socket.addEventListener("open", () => { opened = true; });
  socket.addEventListener("message", (e) => take(JSON.parse(e.data)));
  socket.addEventListener("close", lost);
}
function lost() {
  mayCommand = false;
  showCommands();
  if (ended) return;
  $("drive").textContent = "no connection"; $("drive").className = "chip lost";
  $("drive-why").textContent = opened ? "What is shown is old. The robot goes on without this page." :
    token ? "Refused: another token, or as many viewers as there may be." : "Refused, or there is no robot.";
  setTimeout(again, 1000);
}
// Whoever answers there may be on another mission: the page begins anew.
async function again() {
  try {
    await fetch("/", { method: "HEAD" });
    if (opened) location.reload(); else connect();
  } catch { setTimeout(again, 1000); }
}
function command(name, more = {}) {
  if (!mayCommand) return;
  say(`${name} …`);
  socket.send(JSON.stringify({ op: "command", name, ...more }));
}

// ---- What comes ---------------------------------------------------------------------------------
const takes = {
  welcome(m) { mayCommand = m.may_command; realTime = m.real_time; showCommands(); showState(); },
  steps({ part }) {
    // Plots take longest to draw: once a second is enough.
    const now = performance.now(), withPlots = now - plotsAt > 1000;
    page.append(part, { withPlots });
    if (withPlots) plotsAt = now;
    else if (!plotsDue) plotsDue = setTimeout(() => { plotsDue = 0; plotsAt = performance.now(); page.extendPlots(); page.seek(page.step()); }, 1000);
    showFigures();
    showNewest();
  },
  pose(m) { page.setPose(m); showFigures(m); },
  picture({ picture }) {
    if (page.steps() === 0) return;
    page.pictures.push({ ...loadPictures([picture])[0], frame: page.steps() - 1 });
    if (page.pictures.length > 60) page.pictures.shift();
    if (page.step() === page.steps() - 1) page.drawSight();
  },
  status(m) {
    if (m.told && m.told !== status?.told) say(m.told);
    status = m;
    showState();
    showHealth();
  },
  end(m) {
    ended = true;
    mayCommand = false;
    showCommands();
    const done = m.outcome === "done";
    $("drive").textContent = m.outcome; $("drive").className = done ? "chip active" : "chip";
    $("drive-why").textContent = `The mission is over: ${m.reason}. ${m.detail}`;
  },
  answer({ name, refused }) { say(refused ? `${name}: ${refused}` : "", Boolean(refused)); },
};
function take(message) { takes[message.op]?.(message); }

// ---- What is shown ------------------------------------------------------------------------------
function showState() {
  if (ended) return;
  const drive = status?.drive;
  if (drive) {
    $("drive").textContent = drive.mode; $("drive").className = `chip ${drive.mode}`;
    const held = status.told_to_drive === false && ["idle", "ready"].includes(drive.mode) ? "Held. " : "";
    $("drive-why").textContent = held + drive.why + (drive.detail && drive.detail !== drive.why ? ` ${drive.detail}` : "");
  } else if (!realTime) {
    const state = status?.stopped ? "stopped" : status && !status.told_to_drive ? "held" : "active";
    $("drive").textContent = state === "active" ? "simulation" : state; $("drive").className = `chip ${state}`;
    $("drive-why").textContent = { active: "A simulation in lockstep.", held: "The simulation is held.", stopped: "The simulation is stopped until that is acknowledged." }[state];
  } else {
    $("drive").textContent = "checks"; $("drive").className = "chip";
    $("drive-why").textContent = "Checks before the first motion.";
  }
  showCommands();
}
function showCommands() {
  $("commands").hidden = !mayCommand;
  if (!mayCommand && going) setGoing(false);
  $("command-acknowledge").disabled = !status?.stopped;
  $("command-hold").disabled = status?.told_to_drive === false;
  $("command-resume").disabled = status?.stopped || status?.told_to_drive !== false;
  $("command-go").disabled = Boolean(status?.stopped);
}
function showNewest() { $("newest").setAttribute("aria-pressed", String(page.step() === page.steps() - 1)); }
function showFigures(pose) {
  const k = page.steps() - 1;
  if (k < 0) return;
  const { column, word, speeds } = page;
  const figure = (label, value, unit) => make("div", {}, make("dd", {}, value, make("small", {}, unit)), make("dt", {}, label));
  $("figures").replaceChildren(
    figure("time", fixed(column.time[k], 0), "s"),
    ...(isNumber(column.coverage[k]) ? [figure("coverage", fixed(100 * column.coverage[k], 1), "%")] : []),
    figure("path", fixed(column.path_length[k], 1), "m"),
    figure("speed", fixed(pose ? pose.speed : speeds[k], 2), "m/s"),
    figure("features", fixed(column.tracked_features[k], 0), ""),
    figure("localization", pose ? pose.localization : word.localization[k], ""));
  $("facts").replaceChildren(make("span", { class: "end" }, word.mode[k] || "no plan"), ` · ${start.summary.solver} · seed ${start.summary.seed} · ${plural(status?.viewers || 0, "viewer")}`,
    ...(status?.dropped ? [` · ${plural(status.dropped, "message")} dropped for slow viewers`] : []), ...(status?.missed ? [` · ${status.missed} steps or events missed`] : []));
}
function showHealth() {
  const drive = status.drive, sections = [];
  const table = (title, rows) => {
    const body = make("tbody");
    for (const [label, value, unit = "", bad = false] of rows) body.append(make("tr", {}, make("th", { scope: "row" }, label), make("td", bad ? { class: "bad" } : {}, value, make("small", {}, unit))));
    sections.push(make("div", {}, make("h3", {}, title), make("table", {}, body)));
  };
  if (drive) {
    table("Sources, age of the newest", drive.sources.map(({ name, age, limit, dropped }) =>
      [name, fixed(age, 2), `of ${fixed(limit, 1)} s${dropped ? `, ${dropped} dropped` : ""}`, !(age <= limit)]));
    table("Threads", drive.threads.map(({ name, state }) => [name, state, "", !["on time", "starting"].includes(state)]));
    table("Latencies, median and longest", drive.latencies.map(({ name, p50, max }) => [name, `${fixed(1e3 * p50, 1)}, ${fixed(1e3 * max, 1)}`, "ms"]));
    table("Commands", [["Late plans", String(drive.late_plans)], ["Guard stops", String(drive.guard_stops)], ["Newest", drive.reason]]);
    if (drive.checks.length) table("Before the first motion", drive.checks.map(({ check, verdict }) => [check, verdict, "", verdict === "failed"]));
  }
  const body = make("tbody");
  for (const { time, severity, source, cause, text, count } of [...status.events].reverse().slice(0, 12)) {
    body.append(make("tr", {}, make("th", { scope: "row" }, `${fixed(time - (status.began ?? time), 1)} s`), make("td", { class: severity }, `${source}: ${cause}${text ? `: ${text}` : ""}${count > 1 ? ` (${count} times)` : ""}`)));
  }
  if (status.events.length) sections.push(make("div", { class: "events" }, make("h3", {}, "Events, newest first"), make("table", {}, body)));
  if (!sections.length) sections.push(make("p", {}, "A simulation in lockstep has no threads and no sources that could fail."));
  $("summary").replaceChildren(...sections);
}

// ---- Commands -----------------------------------------------------------------------------------
function setGoing(on) {
  going = on;
  $("command-go").setAttribute("aria-pressed", String(on));
  page.canvas.classList.toggle("going", on);
  page.keepView(on);  // the map must not move under the pointer
  if (on) say("Click on the map where the robot is to go.");
}
for (const name of ["stop", "acknowledge", "hold", "resume"]) $(`command-${name}`).addEventListener("click", () => command(name));
$("command-go").addEventListener("click", () => { setGoing(!going); if (!going) say(""); });
let down = null;
page.canvas.addEventListener("pointerdown", (e) => { down = [e.offsetX, e.offsetY]; });
page.canvas.addEventListener("click", (e) => {
  // A drag moves the map and is no click.
  if (!going || !down || Math.hypot(e.offsetX - down[0], e.offsetY - down[1]) > 4) return;
  const [x, y] = page.toMap(page.toWorld(e.offsetX, e.offsetY));
  setGoing(false);
  command("go", { x, y });
});
$("newest").addEventListener("click", () => { page.seek(page.steps() - 1); showNewest(); });
$("slider").addEventListener("input", showNewest);

showCommands();
connect();
})();
