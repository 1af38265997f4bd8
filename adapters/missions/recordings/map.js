// SPDX-License-Identifier: Apache-2.0
(() => {
// ---- Data ---------------------------------------------------------------------------------------
const straight = JSON.parse($("run").textContent);
// With loops the page is of the straight map; at #drawn of what the poses alone draw.
const drawn = straight.drawn !== undefined && /\bdrawn\b/.test(location.hash), run = drawn ? straight.drawn : straight;
const n = run.frames, s = run.summary, scans = s.ground_found === null, mapped = run.voxels !== null;
const column = {};
for (const [name, text] of Object.entries(run.columns)) column[name] = floats(text);
const states = ["ok", "degraded", "rejected"];
function varints(base64) {
  const from = bytes(base64);
  let at = 0;
  return () => {
    let value = 0, scale = 1;
    for (;;) {
      const byte = from[at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  };
}

// ---- Head ---------------------------------------------------------------------------------------
if (straight.drawn) {
  const choice = (hash, label, now) => make("a", now ? { "aria-current": "true" } : { href: hash }, label);
  $("choice").append(choice("#straight", "kept straight by loops", !drawn), choice("#drawn", "as the poses have it", drawn));
  $("choice").hidden = false;
  addEventListener("hashchange", () => location.reload());
}
$("facts").textContent = [s.layout, plural(s.frames, scans ? "scan" : "frame"), `${s.ok} ok, ${s.degraded} degraded, ${s.rejected} rejected`,
  s.without_pose ? `${s.without_pose} without a pose` : null, mapped ? `voxels of ${compact(s.resolution_m)} m` : s.poses ? "no ground, so no map" : "no poses, so no map"].filter(Boolean).join(" · ");
const figure = (label, value, unit, bad) => $("figures").append(make("div", bad ? { class: "bad" } : {},
  make("dd", {}, value, make("small", {}, unit)), make("dt", {}, label)));
const r2 = s.resolution_m * s.resolution_m;
if (mapped) {
  figure("free", compact(s.free_cells * r2), "m²");
  figure("occupied", compact(s.occupied_cells * r2), "m²");
}
if (s.loops) {
  figure("loops used", `${s.loops.used} of ${s.loops.found}`, "");
  figure("a pose moved, at most", fixed(s.loops.moved_m, 2), "m");
}
if (isNumber(s.height_median_m)) figure("camera above the ground", fixed(s.height_median_m, 2), "m");
if (!scans) figure("of the frames show the ground", fixed(100 * s.ground_found / Math.max(1, s.frames), 0), "%", s.ground_found * 2 < s.frames);
figure(scans ? "scans rejected" : "frames rejected", fixed(s.rejected, 0), "", s.rejected * 2 > s.frames);

// ---- Colours ------------------------------------------------------------------------------------
const kRamp = ["#3b528b", "#21918c", "#5ec962", "#fde725"];
const kOccupancy = ["#f2a65a", "#d9694f", "#a33b5c", "#4b2a63"];
let step = -1;
const shown = { triangles: 0, problem: "" };  // of the 3-D view, for the self-test

// ---- 3-D ----------------------------------------------------------------------------------------
// Everything in voxels, so that positions are whole numbers; z up.
const view = (() => {
  const v = run.voxels, canvas = $("view");
  const without = (why) => {
    shown.problem = why;
    canvas.hidden = true; $("buttons").hidden = true; $("cuts").hidden = true; $("scale-legend").hidden = true;
    $("no-view").textContent = why; $("no-view").hidden = false;
    return null;
  };
  if (!v) return without(s.poses ? "No ground was found, so there is no map to show." : "No poses are known, so there is no map to show.");
  if (!v.occupied) return without("No voxel is occupied.");
  // Asked of another canvas, as one that has failed cannot be used again; three.js would also complain.
  const probe = document.createElement("canvas");
  if (!(probe.getContext("webgl2") || probe.getContext("webgl"))) return without("This browser has no WebGL, so the 3-D view is left out. All else is below.");
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
  } catch (e) {
    return without("This browser's WebGL does not start, so the 3-D view is left out. All else is below.");
  }
  const [low, size, r] = [v.low, v.size, v.resolution];
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(45, 1, 1, 1000);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableKeys = false;  // they would be those of the whole page
  controls.screenSpacePanning = true;
  controls.maxPolarAngle = 0.97 * Math.PI;

  // Rectangles of faces, of one side each: what is seen from behind is the inside of a cut voxel.
  const uniforms = { mode: { value: 0 }, cutLow: { value: low[2] }, cutHigh: { value: low[2] + size[2] }, top: { value: 1 },
    ramp: { value: kRamp.map((c) => new THREE.Color(c)) }, occupancy: { value: kOccupancy.map((c) => new THREE.Color(c)) },
    floorColor: { value: new THREE.Color() }, cap: { value: new THREE.Color() } };
  const vertexShader = "attribute float level; varying float height; varying float vLevel; void main() { height = position.z; vLevel = level; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }";
  // A face belongs to the voxel behind it: an upper side counts to the layer below it.
  const fragmentShader = `uniform int mode; uniform float cutLow; uniform float cutHigh; uniform float top; uniform float shade; uniform vec3 ramp[4]; uniform vec3 occupancy[4]; uniform vec3 floorColor; uniform vec3 cap;
    varying float height; varying float vLevel;
    void main() {
      if (height > cutHigh + 0.001 || height < cutLow - 0.001) discard;
      if (!gl_FrontFacing) { gl_FragColor = vec4(cap, 1.0); return; }
      vec3 color;
      if (mode == 1) {
        color = vLevel < 0.5 ? occupancy[0] : vLevel < 1.5 ? occupancy[1] : vLevel < 2.5 ? occupancy[2] : occupancy[3];
      } else if (height < 0.001) {
        color = floorColor;
      } else {
        float t = clamp(height / top, 0.0, 1.0) * 3.0;
        color = t < 1.0 ? mix(ramp[0], ramp[1], t) : t < 2.0 ? mix(ramp[1], ramp[2], t - 1.0) : mix(ramp[2], ramp[3], t - 2.0);
      }
      gl_FragColor = vec4(color * shade, 1.0);
    }`;
  const shades = [0.72, 0.86, 0.78, 0.92, 0.6, 1.0];  // x down, x up, y down, ...
  const next = varints(v.faces);
  let highest = 1, lowest = low[2] + size[2];
  const bounds = new THREE.Box3();
  for (let side = 0; side < 6; ++side) {
    const axis = side >> 1, up = side & 1, b = (axis + 1) % 3, c = (axis + 2) % 3, count = next();
    if (!count) continue;
    const position = new Int16Array(12 * count), level = new Uint8Array(4 * count), index = new Uint32Array(6 * count);
    let layer = low[axis];
    for (let i = 0; i < count; ++i) {
      layer += next();
      const u = low[b] + next(), w = low[c] + next(), packed = next(), height = next() + 1;
      const width = Math.floor(packed / v.levels) + 1;
      for (let corner = 0; corner < 4; ++corner) {
        const at = 12 * i + 3 * corner;
        position[at + axis] = layer;
        position[at + b] = u + (corner === 1 || corner === 2 ? width : 0);
        position[at + c] = w + (corner >= 2 ? height : 0);
        highest = Math.max(highest, position[at + 2]); lowest = Math.min(lowest, position[at + 2]);
      }
      level.fill(packed % v.levels, 4 * i, 4 * i + 4);
      const order = up ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
      for (let k = 0; k < 6; ++k) index[6 * i + k] = 4 * i + order[k];
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    geometry.setAttribute("level", new THREE.BufferAttribute(level, 1));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    geometry.computeBoundingBox();
    bounds.union(geometry.boundingBox);
    const material = new THREE.ShaderMaterial({ uniforms: { ...uniforms, shade: { value: shades[side] } }, vertexShader, fragmentShader, side: THREE.DoubleSide });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    scene.add(mesh);
  }
  uniforms.top.value = highest;

  // The path, and where the camera was in the frame that is shown.
  const points = [];
  for (let k = 0; k < n; ++k) if (isNumber(column.x[k])) points.push(new THREE.Vector3(column.x[k] / r, column.y[k] / r, column.z[k] / r));
  const lineMaterial = new THREE.LineBasicMaterial(), startMaterial = new THREE.MeshBasicMaterial(), hereMaterial = new THREE.MeshBasicMaterial();
  const ball = new THREE.SphereBufferGeometry(Math.max(1, 0.06 / r), 20, 14);
  const here = new THREE.Mesh(ball, hereMaterial);
  if (points.length) {
    scene.add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), lineMaterial));
    const start = new THREE.Mesh(ball, startMaterial);
    start.position.copy(points[0]);
    scene.add(start, here);
    points.forEach((p) => bounds.expandByPoint(p));
  }

  const middle = bounds.getCenter(new THREE.Vector3()), reach = 0.5 * bounds.getSize(new THREE.Vector3()).length();
  camera.near = Math.max(0.5, reach / 500); camera.far = reach * 12;
  controls.minDistance = reach / 50; controls.maxDistance = reach * 6;
  // As near as the corners of all that there is allow.
  function look(direction) {
    const slope = Math.tan(22.5 * Math.PI / 180), wide = slope * canvas.clientWidth / Math.max(1, canvas.clientHeight);
    const back = direction.normalize(), right = new THREE.Vector3().crossVectors(camera.up, back).normalize(), up = new THREE.Vector3().crossVectors(back, right);
    let distance = 1;
    for (let corner = 0; corner < 8; ++corner) {
      const at = new THREE.Vector3(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y, corner & 4 ? bounds.max.z : bounds.min.z).sub(middle);
      distance = Math.max(distance, at.dot(back) + Math.max(Math.abs(at.dot(right)) / wide, Math.abs(at.dot(up)) / slope));
    }
    controls.target.copy(middle);
    camera.position.copy(middle).addScaledVector(back, 1.06 * distance);
    controls.update();
  }
  // The longer side lies across the picture.
  const across = bounds.max.x - bounds.min.x >= bounds.max.y - bounds.min.y;
  const first = () => look(new THREE.Vector3(across ? -0.35 : -0.85, across ? -0.85 : -0.35, 0.75)), above = () => look(new THREE.Vector3(0, -0.001, 1));

  let asked = false, moved = false;  // by whom looks at it
  controls.addEventListener("start", () => { moved = true; });
  function draw() {
    asked = false;
    renderer.render(scene, camera);
    shown.triangles = renderer.info.render.triangles;
  }
  const ask = () => { if (!asked) { asked = true; requestAnimationFrame(draw); } };
  controls.addEventListener("change", ask);
  function recolor() {
    scene.background = new THREE.Color(css("--map-unknown"));
    uniforms.floorColor.value.set(css("--floor")); uniforms.cap.value.set(css("--cap"));
    lineMaterial.color.set(css("--bad")); startMaterial.color.set(css("--good")); hereMaterial.color.set(css("--horizon"));
    ask();
  }
  function resize() {
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (!moved) first();
    ask();
  }
  const turn = (azimuth, polar) => {
    moved = true;
    const offset = new THREE.Vector3().subVectors(camera.position, controls.target);
    const distance = offset.length(), angle = Math.atan2(offset.y, offset.x) + azimuth;
    const tilt = Math.max(0.01, Math.min(controls.maxPolarAngle, Math.acos(offset.z / distance) + polar));
    camera.position.set(Math.sin(tilt) * Math.cos(angle), Math.sin(tilt) * Math.sin(angle), Math.cos(tilt)).multiplyScalar(distance).add(controls.target);
    controls.update();
  };
  const zoom = (factor) => {
    moved = true;
    const offset = new THREE.Vector3().subVectors(camera.position, controls.target).multiplyScalar(factor);
    camera.position.copy(controls.target).add(offset);
    controls.update();
  };

  // Cuts, in layers of voxels.
  const high = $("cut-high"), lowCut = $("cut-low");
  for (const input of [high, lowCut]) { input.min = lowest; input.max = highest; }
  high.value = highest; lowCut.value = lowest;
  function cut() {
    uniforms.cutHigh.value = Number(high.value); uniforms.cutLow.value = Number(lowCut.value);
    $("cut-high-value").textContent = `${fixed(high.value * r, 2)} m`;
    $("cut-low-value").textContent = `${fixed(lowCut.value * r, 2)} m`;
    ask();
  }
  high.addEventListener("input", cut); lowCut.addEventListener("input", cut);
  function legend() {
    const swatch = (color, text) => make("span", { class: "key" }, make("i", { style: `background:${color}` }), text);
    if (uniforms.mode.value === 0) {
      $("scale-legend").replaceChildren(make("div", { class: "scale" }, "0 m", make("i", { style: `background:linear-gradient(90deg, ${kRamp.join(", ")})` }), `${fixed(highest * r, 1)} m`),
        make("div", {}, swatch("var(--floor)", "floor"), swatch("var(--cap)", "cut")));
    } else {
      $("scale-legend").replaceChildren(make("b", {}, "occupied how surely"), make("div", {}, ...kOccupancy.map((c, i) => swatch(c, ["hardly", "rather", "mostly", "surely"][i]))));
    }
  }
  $("color").addEventListener("change", () => { uniforms.mode.value = Number($("color").value); legend(); ask(); });
  $("nearer").addEventListener("click", () => zoom(1 / 1.25)); $("farther").addEventListener("click", () => zoom(1.25));
  $("above").addEventListener("click", () => { moved = true; above(); }); $("home").addEventListener("click", first);
  canvas.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const move = (input, by) => { input.value = Number(input.value) + by; cut(); };
    const actions = { ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.08), ArrowDown: () => turn(0, 0.08), "+": () => zoom(1 / 1.15), "=": () => zoom(1 / 1.15), "-": () => zoom(1.15),
      PageUp: () => move(high, 1), PageDown: () => move(high, -1), a: above, h: first };
    if (!actions[e.key]) return;
    e.preventDefault(); e.stopPropagation();
    actions[e.key]();
  });
  canvas.addEventListener("webglcontextlost", (e) => { e.preventDefault(); without("The browser has taken WebGL away; load the page again to see the 3-D view."); });
  new ResizeObserver(resize).observe(canvas);
  resize(); recolor(); legend(); cut();
  return { recolor, draw, turn, canvas, renderer, camera, seek: (k) => {
    here.visible = isNumber(column.x[k]);
    if (here.visible) here.position.set(column.x[k] / r, column.y[k] / r, column.z[k] / r);
    ask();
  } };
})();

// ---- Maps from above ----------------------------------------------------------------------------
const cells = (() => {
  if (!run.ground) { $("maps").hidden = true; return null; }
  const out = new Uint8Array(run.ground.width * run.ground.height), next = varints(run.ground.cells);
  for (let at = 0; at < out.length;) {
    const packed = next(), length = Math.floor(packed / 3) + 1;
    out.fill(packed % 3, at, at + length);
    at += length;
  }
  return out;
})();
const drawnCells = {};  // how many of each state were drawn, for the self-test
const startFrame = column.x.findIndex(isNumber);
function drawMap(canvas, colorOf) {
  const g = run.ground, pen = canvas.getContext("2d"), density = devicePixelRatio || 1;
  const width = canvas.clientWidth, left = 38, below = 22, border = 6, right = 14;
  const scale = Math.min((width - left - right) / g.width, Math.max(240, Math.min(560, 0.8 * innerHeight)) / g.height);
  const height = Math.round(scale * g.height) + below + border;
  canvas.style.height = `${height}px`;
  canvas.width = Math.max(1, Math.round(width * density)); canvas.height = Math.max(1, Math.round(height * density));
  pen.setTransform(density, 0, 0, density, 0, 0);
  const small = document.createElement("canvas");
  small.width = g.width; small.height = g.height;
  const ink = small.getContext("2d"), image = ink.createImageData(g.width, g.height), counts = [0, 0, 0];
  const rgb = [0, 1, 2].map((state) => { ink.fillStyle = css(colorOf[state]); return [1, 3, 5].map((i) => parseInt(ink.fillStyle.slice(i, i + 2), 16)); });
  for (let j = 0; j < g.height; ++j) for (let i = 0; i < g.width; ++i) {
    const state = cells[j * g.width + i];
    ++counts[state];
    image.data.set([...rgb[state], 255], 4 * ((g.height - 1 - j) * g.width + i));
  }
  ink.putImageData(image, 0, 0);
  drawnCells[canvas.id] = counts;
  const w = scale * g.width, h = scale * g.height, r = g.resolution;
  const offset = left + Math.max(0, (width - left - right - w) / 2);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(small, offset, border, w, h);
  const X = (x) => offset + (x / r - g.low[0]) * scale, Y = (y) => border + h - (y / r - g.low[1]) * scale;
  // Axes at 1, 2 or 5 times a power of ten metres.
  const span = r / scale, power = 10 ** Math.floor(Math.log10(span * 46));
  const cell = [1, 2, 5, 10].map((m) => m * power).find((c) => c / span >= 46);
  pen.font = "11px system-ui, sans-serif"; pen.fillStyle = css("--ink-3"); pen.strokeStyle = css("--ink-3"); pen.lineWidth = 1;
  pen.strokeRect(offset - 0.5, border - 0.5, w + 1, h + 1);
  const label = (v) => String(+v.toPrecision(6)).replace("-", "−");
  pen.textAlign = "center"; pen.textBaseline = "top";
  for (let i = Math.ceil(g.low[0] * r / cell - 1e-9); i * cell <= (g.low[0] + g.width) * r + 1e-9; ++i) {
    const x = X(i * cell);
    pen.beginPath(); pen.moveTo(x, border + h); pen.lineTo(x, border + h + 4); pen.stroke(); pen.fillText(label(i * cell), x, border + h + 6);
  }
  pen.textAlign = "right"; pen.textBaseline = "middle";
  for (let i = Math.ceil(g.low[1] * r / cell - 1e-9); i * cell <= (g.low[1] + g.height) * r + 1e-9; ++i) {
    const y = Y(i * cell);
    pen.beginPath(); pen.moveTo(offset - 4, y); pen.lineTo(offset, y); pen.stroke(); pen.fillText(label(i * cell), offset - 6, y);
  }
  pen.save(); pen.beginPath(); pen.rect(offset, border, w, h); pen.clip();
  pen.beginPath();
  for (let k = 0, down = false; k < n; ++k) {
    if (!isNumber(column.x[k])) continue;
    if (down) pen.lineTo(X(column.x[k]), Y(column.y[k])); else pen.moveTo(X(column.x[k]), Y(column.y[k]));
    down = true;
  }
  pen.strokeStyle = css("--estimated"); pen.lineWidth = 2; pen.lineJoin = "round"; pen.stroke(); pen.restore();
  const dot = (k, color, radius) => {
    if (k < 0 || !isNumber(column.x[k])) return;
    pen.beginPath(); pen.arc(X(column.x[k]), Y(column.y[k]), radius, 0, 2 * Math.PI);
    pen.fillStyle = css(color); pen.fill(); pen.strokeStyle = css("--halo"); pen.lineWidth = 1.5; pen.stroke();
  };
  dot(startFrame, "--good", 5);
  dot(step, "--horizon", 4);
}
function drawMaps() {
  if (!cells) return;
  drawMap($("explored"), ["--map-unknown", "--map-free", "--map-free"]);
  drawMap($("obstacles"), ["--map-unknown", "--map-free", "--map-occupied"]);
}

// ---- Plots --------------------------------------------------------------------------------------
const { plots, add: addPlot } = recordingPlots({
  column, step: () => step, seek, bands: true, all: { drawPoints: n < 3, drawGapEdgePoints: true, connectSeparatedPoints: false },
});
const within = (unit) => (v, sigma) => (isNumber(v) ? `${fixed(v, 2)}${isNumber(sigma) ? ` ± ${+(2 * sigma).toPrecision(2)}` : ""}${unit}` : "–");
if (!scans) {
  addPlot("Camera above the ground", "m, band: two standard deviations", [{ name: "measured", color: "--accent", values: column.height, sigma: column.sigma_height },
    ...(mapped ? [{ name: "by the pose", color: "--ink-3", values: column.z }] : [])], within(" m"));
  addPlot(mapped ? "Ground off level" : "Camera's pitch down", "degrees, band: two standard deviations", [{ name: "measured", color: "--accent", values: column.tilt, sigma: column.sigma_tilt }], within("°"));
}
if (run.hypotheses.length) {
  const series = run.hypotheses.slice(0, 6).map((h, i) => {
    const values = new Float32Array(n).fill(NaN), sigma = new Float32Array(n).fill(NaN);
    h.frames.forEach((k, j) => { values[k] = h.height[j]; sigma[k] = h.sigma[j]; });
    return { name: `${i}${h.taken[h.taken.length - 1] ? ", taken" : ""}`, color: ["--good", "--horizon", "--frontier", "--accent", "--bad", "--ink-3"][i], values, sigma };
  });
  addPlot("Hypotheses of the floor", "below the first camera [m]", series, within(" m"));
}
addPlot("Rays entered", scans ? "a scan" : "a frame", [{ name: "at obstacles", color: "--horizon", values: column.hits }, { name: "at the floor", color: "--good", values: column.floor }, { name: "beyond range", color: "--ink-3", values: column.misses }], (v) => fixed(v, 0), { valueRange: [0, null] });

// ---- What was left out --------------------------------------------------------------------------
const ranges = (list) => {
  const parts = [];
  for (let i = 0; i < list.length;) {
    let j = i;
    while (j + 1 < list.length && list[j + 1] === list[j] + 1) ++j;
    parts.push(i === j ? String(list[i]) : `${list[i]}–${list[j]}`);
    i = j + 1;
  }
  return parts.length > 12 ? `${parts.slice(0, 12).join(", ")} …` : parts.join(", ");
};
const groups = new Map();
for (const [k, reason] of Object.entries(run.reasons)) {
  const key = `${column.state[k]} ${reason}`;
  if (!groups.has(key)) groups.set(key, { state: column.state[k], reason, frames: [] });
  groups.get(key).frames.push(Number(k));
}
const sorted = [...groups.values()].sort((a, b) => b.state - a.state || b.frames.length - a.frames.length);
const leftOut = make("tbody");
const row = (state, kind, what, count, where) => leftOut.append(make("tr", {}, make("td", { class: `state ${kind}` }, state), make("td", {}, what), make("td", { class: "count" }, String(count)), make("td", {}, where)));
if (s.without_pose) row("no pose", "bad", "no finite pose is known at its time; not among the frames", s.without_pose, "–");
for (const g of sorted) {
  const go = make("button", { title: "Show the first of them" }, ranges(g.frames));
  go.addEventListener("click", () => { play(false); seek(g.frames[0]); });
  row(states[g.state], g.state === 2 ? "bad" : "warn", g.reason, g.frames.length, go);
}
if (leftOut.childElementCount) $("left-out").append(make("thead", {}, make("tr", {}, ...["state", "reason", scans ? "scans" : "frames", "which"].map((t) => make("th", {}, t)))), leftOut);
else $("left-out").append(make("tbody", {}, make("tr", {}, make("td", {}, `Nothing: every ${scans ? "scan" : "frame"} was entered.`))));
$("notes").append(...(s.notes.length ? s.notes : ["Nothing."]).map((note) => make("li", {}, note)));
if (run.hypotheses.length) {
  const body = make("tbody");
  run.hypotheses.forEach((h, i) => {
    const last = h.height.length - 1;
    body.append(make("tr", {}, make("th", { scope: "row" }, `hypothesis ${i}`), make("td", {}, `${fixed(h.height[last], 3)} ± ${+(2 * h.sigma[last]).toPrecision(2)} m`), make("td", {}, `pitch ${fixed(h.pitch_deg, 1)}°, roll ${fixed(h.roll_deg, 1)}°`), make("td", {}, plural(h.support, "frame"))),
      make("tr", { class: "why-floor" }, make("th", { colspan: "4" }, `${h.taken[last] ? "Taken" : "Not taken"}: ${h.why}`)));
  });
  $("floors").append(body);
}
const ground = s.ground || {};
$("changes").append(...(ground.none_because ? [`no ground: ${ground.none_because}`] : []).concat((ground.changes || []).map((c) => `frame ${c.frame}: hypothesis ${c.hypothesis} taken, ${fixed(c.height_m, 3)} m below the first camera: ${c.reason}`)).map((line) => make("li", {}, line)));
$("changes").hidden = !$("changes").childElementCount;

// ---- The frame that is shown --------------------------------------------------------------------
const fields = [
  ["state", (k) => states[column.state[k]], (k) => ["", "warn", "bad"][column.state[k]]],
  ["rays entered", (k) => fixed(column.hits[k] + column.floor[k] + column.misses[k], 0)],
  ...(scans ? [] : [["ground", (k) => (isNumber(column.height[k]) ? `${fixed(column.height[k], 3)} m below` : "not found"), (k) => (isNumber(column.height[k]) ? "" : "warn")]]),
  ...(mapped ? [[scans ? "lidar at" : "camera at", (k) => (isNumber(column.x[k]) ? `${fixed(column.x[k], 2)}, ${fixed(column.y[k], 2)}, ${fixed(column.z[k], 2)} m` : "–")]] : []),
].map(([label, text, kind]) => {
  const value = make("dd");
  $("now").append(make("div", {}, make("dt", {}, label), value));
  return (k) => { value.textContent = text(k); if (kind) value.className = kind(k); };
});
const reason = make("dd"), reasonBox = make("div", { class: "full" }, make("dt", {}, "why"), reason);
$("now").append(reasonBox);

function seek(k) {
  step = Math.max(0, Math.min(n - 1, k));
  $("slider").value = step;
  $("clock").replaceChildren(String(step), make("span", {}, ` / ${n - 1} · ${fixed(column.time[step], 1)} s`));
  for (const field of fields) field(step);
  reasonBox.hidden = !run.reasons[step];
  reason.textContent = run.reasons[step] || "";
  for (const plot of plots) { plot.place(); plot.show(step); }
  view?.seek(step);
  drawMaps();
}
const play = player({ time: column.time, seek, step: () => step, spare: "select, .cuts input, summary" });
$("slider").max = n - 1;
dark.addEventListener("change", () => { for (const plot of plots) plot.recolor(); view?.recolor(); seek(step); });
// #frame=N opens at that frame; otherwise at the last.
const wanted = location.hash.match(/frame=(\d+)/);
seek(wanted ? Number(wanted[1]) : n - 1);
let width = 0;
new ResizeObserver(() => { if ($("stage").clientWidth !== width) { width = $("stage").clientWidth; drawMaps(); } }).observe($("stage"));

// ---- Self-test: map.html#selftest ---------------------------------------------------------------
// Moves the sliders as a hand would and looks at what was drawn. Writes one line a fact into the page.
if (/\bselftest\b/.test(location.hash)) setTimeout(() => {
  const lines = [], failures = [];
  const expect = (what, ok) => { if (!ok) failures.push(what); };
  const set = (id, value) => { $(id).value = value; $(id).dispatchEvent(new Event("input", { bubbles: true })); };
  const painted = () => {
    view.draw();
    const gl = view.renderer.getContext(), pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let other = 0, sum = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      const differs = Math.abs(pixels[i] - pixels[0]) + Math.abs(pixels[i + 1] - pixels[1]) + Math.abs(pixels[i + 2] - pixels[2]) > 12;
      other += differs;
      if (differs) sum = (sum * 31 + pixels[i] + 7 * pixels[i + 1] + 13 * pixels[i + 2] + i) % 1000000007;
    }
    return { share: other / (pixels.length / 4), sum };
  };
  try {
    for (const k of [...new Set([0, Math.floor(n / 2), n - 1])]) {
      set("slider", k);
      lines.push(`frame ${k} ${states[column.state[k]]} rays ${column.hits[k]} ${column.floor[k]} ${column.misses[k]}`);
      expect(`the clock is at ${k}`, $("clock").textContent.startsWith(`${k} /`));
      plots.forEach((plot, i) => {
        const x = plot.cursor.getBoundingClientRect().left - plot.cursor.parentElement.getBoundingClientRect().left;
        expect(`the cursor of plot ${i} is at frame ${k}`, Math.abs(x - plot.graph.toDomXCoord(column.time[k])) < 1);
      });
    }
    if (straight.drawn) {
      lines.push(`shown ${drawn ? "as drawn" : "with loops"}`);
      expect("either can be chosen", $("choice").querySelectorAll("a").length === 2 && $("choice").querySelectorAll("[aria-current]").length === 1);
    }
    lines.push(`plots ${plots.length}`, `left out ${leftOut.childElementCount}`);
    if (cells) {
      lines.push(`cells unknown ${drawnCells.obstacles[0]} free ${drawnCells.obstacles[1]} occupied ${drawnCells.obstacles[2]}`);
      for (const id of ["explored", "obstacles"]) expect(`the map ${id} is not blank`, greyLevels($(id)) > 2);
    }
    if (view) {
      const before = painted();
      lines.push(`view ${run.voxels.occupied} voxels ${run.voxels.rectangles} rectangles`);
      expect(`all rectangles are drawn, not ${shown.triangles} triangles`, shown.triangles >= 2 * run.voxels.rectangles);
      expect("the voxels are painted", before.share > 0.02);
      view.canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
      expect("an arrow turns the view", painted().sum !== before.sum);
      const turned = painted();
      set("cut-high", 2);
      const cut = painted();
      expect("a cut takes voxels away", cut.sum !== turned.sum && $("cut-high-value").textContent === `${fixed(2 * run.voxels.resolution, 2)} m`);
      set("cut-high", $("cut-high").max);
      $("color").value = "1"; $("color").dispatchEvent(new Event("change", { bubbles: true }));
      expect("the colours change", painted().sum !== turned.sum);
    } else {
      lines.push(`no view: ${shown.problem}`);
      expect("it says why there is no 3-D view", !$("no-view").hidden && shown.problem.length > 10);
    }
    dispatchEvent(new KeyboardEvent("keydown", { key: "Home", bubbles: true }));
    expect("the Home key leads to the first frame", step === 0);
  } catch (e) { errors.push(String(e.stack || e)); }
  showSelftest(lines, failures);
}, 0);
})();
