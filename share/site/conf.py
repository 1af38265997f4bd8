# SPDX-License-Identifier: Apache-2.0
"""Sphinx's configuration of the site: scripts/site copies it beside the pages."""
import os

project = "Prospect"
author = "The Prospect contributors"
copyright = author  # pylint: disable=redefined-builtin
release = version = os.environ["PROSPECT_VERSION"]
extensions = ["myst_parser", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
root_doc = "index"
myst_heading_anchors = 6
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
html_theme = "furo"
html_title = f"Prospect {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_extra_path = ["_extra"]
html_copy_source = False
html_show_sourcelink = False
html_last_updated_fmt = None
pygments_style = "default"
pygments_dark_style = "monokai"
# A prompt and what stands behind it are copied, the output is not.
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
