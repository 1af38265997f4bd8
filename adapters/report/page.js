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

// ---- Self-test ----------------------------------------------------------------------------------
// Writes into the page what a self-test saw, one line a fact, and whether it passed.
function showSelftest(lines, failures) {
  for (const failure of failures) lines.push(`FAILED ${failure}`);
  for (const error of errors) lines.push(`ERROR ${error}`);
  lines.push(failures.length || errors.length ? "selftest failed" : "selftest passed");
  document.body.append(make("pre", { id: "selftest" }, lines.join("\n")));
}
