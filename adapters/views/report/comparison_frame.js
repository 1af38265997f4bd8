// SPDX-License-Identifier: Apache-2.0
// In each of the two pages of a comparison: time and view are the comparison's.
window.mission = page;
addEventListener("keydown", (e) => {
  if (["+", "=", "-", "0", "f"].includes(e.key) || e.ctrlKey || e.metaKey || e.altKey || e.target.closest?.("select, pre")) return;
  if (e.key === " " && e.target.closest?.("button, label")) return;
  e.stopImmediatePropagation();
  if (!parent.dispatchEvent(new KeyboardEvent("keydown", { key: e.key, shiftKey: e.shiftKey, bubbles: true, cancelable: true }))) e.preventDefault();
}, true);
for (const type of ["pointermove", "wheel", "dblclick", "click", "keyup"]) {
  addEventListener(type, () => requestAnimationFrame(() => parent.postMessage("moved", "*")));
}
new ResizeObserver(() => parent.postMessage("grown", "*")).observe(document.body);
