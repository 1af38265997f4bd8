// SPDX-License-Identifier: Apache-2.0
// The other versions of this page, where the site is one of several (scripts/site --version): ../versions.js says
// which there are. A page that another version has not leads to its first.
document.addEventListener("DOMContentLoaded", () => {
  const root = document.getElementById("documentation_options")?.dataset.url_root ?? "./";
  const script = document.createElement("script");
  script.src = root + "../versions.js";
  script.onload = () => {
    const base = new URL(root, location.href), parts = base.pathname.split("/").filter(Boolean);
    const here = decodeURIComponent(parts.at(-1)), page = decodeURIComponent(location.pathname.slice(base.pathname.length)) || "index.html";
    const choice = document.createElement("select");
    choice.className = "versions";
    choice.setAttribute("aria-label", "Version of Prospect");
    for (const version of Object.keys(window.prospectVersions)) choice.add(new Option(version, version, false, version === here));
    choice.addEventListener("change", () => {
      const pages = window.prospectVersions[choice.value];
      location.href = new URL(`../${choice.value}/${pages.includes(page) ? page : "index.html"}`, base);
    });
    document.querySelector(".sidebar-brand")?.after(choice);
  };
  document.head.append(script);
});

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
