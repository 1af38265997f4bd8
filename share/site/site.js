// SPDX-License-Identifier: Apache-2.0
// The button for light and dark. Debian's theme ships its script as a module that browsers refuse: where it has not
// run, the page is still marked as one without scripts.
document.addEventListener("DOMContentLoaded", () => {
  if (!document.documentElement.classList.contains("no-js")) return;
  document.documentElement.classList.remove("no-js");
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const order = dark ? ["auto", "light", "dark"] : ["auto", "dark", "light"];
  for (const button of document.getElementsByClassName("theme-toggle")) {
    button.addEventListener("click", () => {
      const now = order.indexOf(document.body.dataset.theme || "auto");
      document.body.dataset.theme = order[(now + 1) % order.length];
      localStorage.setItem("theme", document.body.dataset.theme);
    });
  }
});
