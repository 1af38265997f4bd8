// SPDX-License-Identifier: Apache-2.0
// Drives a mission and its live page in a browser, by the browser's own protocol over a pipe. Ends with 1 and a line
// for each thing that is not as expected.
//   node drive_live_page.js PROSPECT BROWSER FOLDER [SCREENSHOTS]
"use strict";
const { spawn } = require("child_process");
const fs = require("fs");
const [, , prospect, browser, folder, screenshots] = process.argv;
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
let failures = 0;
function check(sound, what) {
  if (sound) return;
  console.error(`FAILED: ${what}`);
  ++failures;
}

// ---- The mission ---------------------------------------------------------------------------------
function mission(...more) {
  const child = spawn(prospect, ["drive", "office", "--time-limit", "170", "--quiet", "--live", "0", "--out", `${folder}/run`, ...more], { cwd: folder });
  let text = "", ended = false;
  child.stderr.on("data", (data) => { text += data; });
  child.on("exit", () => { ended = true; });
  return { child, said: () => text, ended: () => ended };
}

// ---- The browser ---------------------------------------------------------------------------------
// Commands and answers are JSON texts that end with a zero byte, on the pipes 3 and 4.
function open() {
  const child = spawn(browser, ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-extensions",
    `--user-data-dir=${folder}/profile`, "--remote-debugging-pipe", "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  const waiting = new Map();
  let number = 0, rest = "";
  child.stdio[4].on("data", (data) => {
    rest += data;
    for (let end; (end = rest.indexOf("\0")) >= 0; rest = rest.slice(end + 1)) {
      const message = JSON.parse(rest.slice(0, end));
      const answer = waiting.get(message.id);
      waiting.delete(message.id);
      if (answer) answer(message);
    }
  });
  const call = (method, params = {}, sessionId = undefined) => new Promise((resolve, reject) => {
    waiting.set(++number, ({ result, error }) => (error ? reject(new Error(`${method}: ${error.message}`)) : resolve(result)));
    child.stdio[3].write(`${JSON.stringify({ id: number, method, params, sessionId })}\0`);
  });
  return { child, call };
}
async function tab({ call }, url) {
  const { targetId } = await call("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await call("Target.attachToTarget", { targetId, flatten: true });
  const send = (method, params) => call(method, params, sessionId);
  await send("Page.enable");
  await send("Emulation.setDeviceMetricsOverride", { width: 1280, height: 900, deviceScaleFactor: 1, mobile: false });
  await send("Page.navigate", { url });
  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description || exceptionDetails.text}`);
    return result.value;
  };
  // Whether it becomes so.
  const becomes = async (what, expression, seconds = 40) => {
    let error = "";
    for (const end = Date.now() + 1000 * seconds; Date.now() < end; await sleep(100)) {
      try { if (await evaluate(expression)) return true; error = ""; } catch (e) { error = `: ${e.message}`; }
    }
    let state = "";
    try { state = await evaluate(`$("drive").textContent + " | " + $("drive-why").textContent + " | " + $("said").textContent`); } catch { /* no page yet */ }
    check(false, `${what}: it does not come to that${error} (${state})`);
    return false;
  };
  const picture = async (name) => {
    if (!screenshots) return;
    const { data } = await send("Page.captureScreenshot", { captureBeyondViewport: true });
    fs.writeFileSync(`${screenshots}/${name}.png`, Buffer.from(data, "base64"));
  };
  return { send, evaluate, becomes, picture };
}
const mode = (name) => `$("drive").textContent === "${name}"`;
// On a machine that is busy the turn before the first motion may not have been possible: then it drives slower.
const drives = `["active", "degraded"].includes($("drive").textContent)`;
const click = (id) => `$("${id}").click()`;

async function main() {
  const run = mission();
  const chromium = open();
  try {
    for (let i = 0; i < 600 && !/live view: http/.test(run.said()) && !run.ended(); ++i) await sleep(100);
    const [, url] = run.said().match(/live view: (http\S+)/) || [];
    check(url, `no address of the live view: ${run.said()}`);
    if (!url) return;
    const page = await tab(chromium, url);
    await page.becomes("the robot drives", drives, 60);
    await page.becomes("steps come", "page.steps() >= 5 && page.step() === page.steps() - 1");
    check(!(await page.evaluate("location.href")).includes("token"), "the token stays in the address");
    check(await page.evaluate(`!$("commands").hidden`), "who has the token sees no commands");
    check(await page.evaluate(`!$("stage").hidden && $("empty").hidden`), "the page still waits");
    const before = await page.evaluate("page.drawn.x + page.drawn.y");
    await page.becomes("the robot moves on the map", `Math.abs(page.drawn.x + page.drawn.y - ${before}) > 0.05`);
    await page.becomes("the map grows", "page.column.area[page.steps() - 1] > page.column.area[0] + 1");
    check(await page.evaluate(`document.querySelectorAll("#plots .plot").length`) > 6, "there are few plots");
    check(await page.evaluate(`$("summary").innerText.includes("Threads")`), "no health is shown");
    // Nothing on the page is wider than the page.
    for (const [width, height, color] of [[1280, 900, "light"], [400, 860, "light"], [1280, 900, "dark"], [400, 860, "dark"]]) {
      await page.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: color }] });
      await page.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: width < 500 });
      await sleep(700);
      const wide = await page.evaluate("document.documentElement.scrollWidth");
      check(wide <= width, `at ${width} px the page is ${wide} px wide`);
      await page.picture(`live_${width}_${color}`);
    }
    await page.send("Emulation.setEmulatedMedia", { features: [] });
    await page.send("Emulation.setDeviceMetricsOverride", { width: 1280, height: 900, deviceScaleFactor: 1, mobile: false });

    // Back in time, and back to now.
    await page.evaluate(`$("slider").value = 2, $("slider").dispatchEvent(new Event("input", { bubbles: true }))`);
    const steps = await page.evaluate("page.steps()");
    await page.becomes("steps come while an older one is looked at", `page.steps() > ${steps} && page.step() === 2`);
    await page.evaluate(click("newest"));
    check(await page.evaluate("page.step() === page.steps() - 1"), "the button leads not to the newest step");

    // Hold, resume.
    await page.evaluate(click("command-hold"));
    await page.becomes("a held robot stands", mode("ready"));
    const held = await page.evaluate("page.drawn.x + page.drawn.y");
    await sleep(1500);
    check(Math.abs(await page.evaluate("page.drawn.x + page.drawn.y") - held) < 0.05, "a held robot moves");
    await page.evaluate(click("command-resume"));
    await page.becomes("it drives on", drives);

    // Stop: latched, and an acknowledgement alone starts nothing.
    await page.evaluate(click("command-stop"));
    await page.becomes("a stopped robot is stopped", mode("stopped"));
    await page.picture("live_stopped");
    await sleep(1500);
    check(await page.evaluate(mode("stopped")), "a stop does not stay");
    check(await page.evaluate(`$("command-resume").disabled && $("command-go").disabled`), "a stopped robot can be resumed");
    await page.evaluate(click("command-acknowledge"));
    await page.becomes("an acknowledged stop ends", mode("ready"));
    await sleep(1500);
    check(await page.evaluate(mode("ready")), "an acknowledgement alone starts the robot");

    // Go to a place near by, by a click on the map.
    const place = await page.evaluate(`(() => {
      $("command-go").click();
      const box = page.canvas.getBoundingClientRect(), { sx, sy } = page.drawn;
      return { x: box.left + sx, y: box.top + sy, at: page.toWorld(sx, sy) };
    })()`);
    for (const type of ["mousePressed", "mouseReleased"]) await page.send("Input.dispatchMouseEvent", { type, x: place.x, y: place.y, button: "left", clickCount: 1 });
    await page.becomes("the robot is sent there", `page.word.task.includes("go to")`);
    const goal = await page.evaluate(`(() => { const k = page.word.task.indexOf("go to"); return [page.column.goal_x[k], page.column.goal_y[k]]; })()`);
    check(Math.hypot(goal[0] - place.at[0], goal[1] - place.at[1]) < 0.1, `it is sent to ${goal}, not to ${place.at}`);
    await page.becomes("it is there, and holds", `$("command-hold").disabled && page.word.task[page.steps() - 1] === "explore"`, 60);
    await page.evaluate(click("command-resume"));
    await page.becomes("it goes on with its task", drives);

    // Another page, without the token.
    const watcher = await tab(chromium, url.replace(/\?.*/, ""));
    await watcher.becomes("who has no token sees the mission from its beginning", "page.steps() > 10 && page.column.time[0] < 2");
    check(await watcher.evaluate(`$("commands").hidden`), "who has no token sees commands");

    run.child.kill("SIGINT");
    await page.becomes("the end is told", `/over: cancelled/.test($("drive-why").textContent)`);
    for (const [name, one] of [["page", page], ["second page", watcher]]) {
      const errors = await one.evaluate("errors.join(' | ')");
      check(errors === "", `the ${name} has errors: ${errors}`);
      check(!/\bNaN\b|undefined/.test(await one.evaluate("document.body.innerText")), `the ${name} shows no numbers`);
    }
    for (let i = 0; i < 100 && !run.ended(); ++i) await sleep(100);
    const kept = fs.readFileSync(`${folder}/run/run.json`, "utf8");
    check(!kept.includes(url.replace(/.*token=/, "")), "the token is in the run folder");
  } finally {
    run.child.kill("SIGKILL");
    await Promise.race([chromium.call("Browser.close").catch(() => {}), sleep(3000)]);
    await sleep(500);
    chromium.child.kill("SIGKILL");
  }
}

main().then(() => {
  if (failures === 0) console.log("passed: the live page shows the mission and commands the robot");
  process.exit(failures > 0 ? 1 : 0);
}, (error) => {
  console.error(`FAILED: ${error.stack}`);
  process.exit(1);
});
