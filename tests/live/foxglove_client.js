// SPDX-License-Identifier: Apache-2.0
// Watches and commands a mission with the public client of Foxglove's protocol, under both of its names. Ends with 1
// and a line for each thing that is not as expected.
//   node foxglove_client.js PROSPECT FOLDER
"use strict";
const { spawn } = require("child_process");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { WebSocket } = require("ws");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const [, , prospect, folder] = process.argv;
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
let failures = 0;
function check(sound, what) {
  if (sound) return;
  console.error(`FAILED: ${what}`);
  ++failures;
}
async function becomes(what, so, seconds = 40) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await sleep(50)) if (so()) return;
  check(false, `${what}: it does not come to that`);
}

// Subscribes to all that is advertised.
function watch(url, protocol) {
  const socket = new WebSocket(url, [protocol]);
  const client = new FoxgloveClient({ ws: socket });
  const seen = { info: null, counts: {}, newest: {}, services: {}, answers: [], times: [], errors: [], statuses: [], channels: {} };
  const readers = new Map();
  client.on("serverInfo", (info) => { seen.info = info; });
  client.on("error", (error) => seen.errors.push(String(error.message || error)));
  client.on("status", (status) => seen.statuses.push(status));
  client.on("advertise", (channels) => {
    for (const channel of channels) {
      check(channel.encoding === "cdr" && channel.schemaEncoding === "ros2msg", `${channel.topic} is encoded otherwise`);
      seen.channels[channel.topic] = channel;
      readers.set(client.subscribe(channel.id), { topic: channel.topic, reader: new MessageReader(parse(channel.schema, { ros2: true })) });
    }
  });
  client.on("advertiseServices", (services) => { for (const service of services) seen.services[service.name] = service; });
  client.on("serviceCallResponse", (response) => seen.answers.push(response));
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const { topic, reader } = readers.get(subscriptionId);
    seen.counts[topic] = (seen.counts[topic] || 0) + 1;
    seen.newest[topic] = reader.readMessage(data);
    seen.times.push(timestamp);
  });
  return { socket, client, seen };
}

async function main() {
  const run = spawn(prospect, ["drive", "office", "--time-limit", "150", "--quiet", "--live", "0", "--out", `${folder}/run`], { cwd: folder });
  let said = "";
  run.stderr.on("data", (data) => { said += data; });
  try {
    await becomes("the live view has an address", () => /live view: http/.test(said), 60);
    const url = said.match(/live view: http(\S+)/)[1];
    const commander = watch(`ws${url}`, "foxglove.sdk.v1");
    const watcher = watch(`ws${url.replace(/\?.*/, "")}`, "foxglove.websocket.v1");
    await becomes("both are told of the server", () => commander.seen.info && watcher.seen.info);
    check(commander.socket.protocol === "foxglove.sdk.v1" && watcher.socket.protocol === "foxglove.websocket.v1", "another protocol than asked for");
    const topics = ["/tf_static", "/tf", "/odometry", "/truth/odometry", "/map", "/plan", "/plan/markers", "/plan/step", "/diagnostics", "/rosout"];
    for (const { seen } of [commander, watcher]) {
      await becomes(`messages of all topics (${JSON.stringify(seen.counts)})`, () => topics.every((topic) => seen.counts[topic] > 0), 60);
      const map = seen.newest["/map"];
      check(map.data.length === map.info.width * map.info.height, "a map of other size");
      check(seen.newest["/tf_static"].transforms.length >= 5, "few transforms");
    }
    check(commander.seen.times.every((time) => Math.abs(Number(time) / 1e6 - Date.now()) < 600000), "times that are not of today");
    await becomes("the robot drives", () => Math.hypot(commander.seen.newest["/odometry"].twist.twist.linear.x, 0) > 0.05, 60);

    // Commands, for who has the token.
    check(watcher.seen.info.capabilities.length === 0 && Object.keys(watcher.seen.services).length === 0, "who has no token is offered commands");
    check(["services", "clientPublish"].every((one) => commander.seen.info.capabilities.includes(one)), "commands are not offered");
    let calls = 0;
    const call = (client, id) => client.sendServiceCallRequest({ serviceId: id, callId: ++calls, encoding: "cdr", data: new DataView(new ArrayBuffer(4)) });
    const mode = () => commander.seen.newest["/diagnostics"].status.find(({ name }) => name === "drive").values.find(({ key }) => key === "mode").value;
    call(commander.client, commander.seen.services["/prospect/hold"].id);
    await becomes("a call is answered", () => commander.seen.answers.length === 1);
    check(new DataView(commander.seen.answers[0].data.buffer, commander.seen.answers[0].data.byteOffset).getUint8(4) === 1, "hold has no success");
    await becomes("the robot is held", () => mode() === "ready");
    call(watcher.client, commander.seen.services["/prospect/resume"].id);
    await sleep(1500);
    check(mode() === "ready", "who has no token resumes the robot");

    // To a place, by publishing a pose.
    const definition = "std_msgs/Header header\ngeometry_msgs/Pose pose\n================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
      "================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n================\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" +
      "================\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n================\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
    const { x, y } = commander.seen.newest["/odometry"].pose.pose.position;
    const channel = commander.client.advertise({ topic: "/goal_pose", encoding: "cdr", schemaName: "geometry_msgs/msg/PoseStamped" });
    commander.client.sendMessage(channel, new MessageWriter(parse(definition, { ros2: true })).writeMessage(
      { header: { stamp: { sec: 0, nanosec: 0 }, frame_id: "map" }, pose: { position: { x, y, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } } }));
    const task = () => commander.seen.newest["/plan/step"].status[0].values.find(({ key }) => key === "task").value;
    await becomes("the robot is sent there", () => task() === "go to");

    // A stop is latched.
    call(commander.client, commander.seen.services["/prospect/stop"].id);
    await becomes("the robot is stopped", () => mode() === "stopped");
    call(commander.client, commander.seen.services["/prospect/acknowledge"].id);
    await becomes("an acknowledged stop ends", () => mode() === "ready");
    for (const { seen } of [commander, watcher]) check(seen.errors.length === 0, `errors: ${seen.errors}`);
    check(commander.seen.statuses.length === 0, `said: ${JSON.stringify(commander.seen.statuses)}`);
    commander.client.close();
    watcher.client.close();
    console.log(`passed: ${JSON.stringify(watcher.seen.counts)}`);
  } finally {
    run.kill("SIGKILL");
  }
}

main().then(() => process.exit(failures > 0 ? 1 : 0), (error) => {
  console.error(`FAILED: ${error.stack}`);
  process.exit(1);
});
