#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Links of a static site: each leads to a file, and in the pages to an anchor, that is there; from the front page every
page is reached. What Doxygen makes (api/) is held to files alone.

  site_links.py DIR
"""
import html.parser
import os
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        link = values.get("href") if tag in ("a", "link") else values.get("src")
        if link:
            self.links.append(link)


def main():
    root = os.path.realpath(sys.argv[1])
    pages, broken = {}, []
    for folder, _, names in os.walk(root):
        for name in names:
            if name.endswith(".html"):
                path = os.path.join(folder, name)
                with open(path, encoding="utf-8") as file:
                    pages[path] = Page(file.read())
    reached, open_pages = set(), [os.path.join(root, "index.html")]
    while open_pages:
        path = open_pages.pop()
        if path in reached or path not in pages:
            continue
        reached.add(path)
        for link in pages[path].links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = os.path.normpath(os.path.join(os.path.dirname(path), urllib.parse.unquote(parts.path)))
            target = path if not parts.path else target
            where = f"{os.path.relpath(path, root)}: {link}"
            anchor = urllib.parse.unquote(parts.fragment)
            if not target.startswith(root):
                broken.append(f"{where}: outside of the site")
            elif not os.path.exists(target):
                broken.append(f"{where}: no such file")
            elif anchor and target in pages and "/api/" not in target and anchor not in pages[target].anchors:
                broken.append(f"{where}: no such anchor")
            open_pages.append(target)
    alone = sorted(set(pages) - reached)
    broken += [f"{os.path.relpath(path, root)}: no page leads there" for path in alone if "/api/" not in path]
    for problem in broken:
        print(problem, file=sys.stderr)
    print(f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links, {len(broken)} broken")
    sys.exit(len(broken) > 0 or len(pages) < 1)


main()
