# SPDX-License-Identifier: Apache-2.0
"""The notebooks of the docs run as they are written, from top to bottom, and are stored with what they give."""

import glob
import importlib.machinery
import importlib.util
import os
import sys
import tempfile
import unittest

try:
    import matplotlib  # noqa: F401
    import numpy as np
    import scipy  # noqa: F401
    missing = ""
except ImportError as error:
    missing = str(error)

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NOTEBOOKS = sorted(glob.glob(os.path.join(ROOT, "docs", "notebooks", "*.ipynb")))


def script(name):
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader(name, os.path.join(ROOT, "scripts", name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def kinds(outputs):
    """Of each cell, whether it prints, and how many figures it draws."""
    return [(any("text" in o for o in cell), sum("image/png" in o.get("data", {}) for o in cell)) for cell in outputs]


class NotebooksTest(unittest.TestCase):
    def run_notebook(self, path):
        """Its names."""
        notebooks = script("notebooks")
        notebook, name = notebooks.read(path), os.path.basename(path)
        given, space = notebooks.run(notebook, name)
        stored = [cell["outputs"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
        self.assertEqual(kinds(stored), kinds(given), f"{name} is stored with other outputs: scripts/notebooks {name}")
        pictures = [o["data"]["image/png"] for cell in given for o in cell if "data" in o]
        self.assertGreaterEqual(len(pictures), 2, name)
        for n, picture in enumerate(pictures):
            self.assertGreater(len(picture), 5000, f"{name}: figure {n + 1} is empty")
        return space

    def check_costs(self, steps, parts):
        """Costs times the weights in effect make up the cost that was recorded."""
        cost = steps["cost"]
        planned = np.isfinite(cost)
        self.assertGreater(planned.sum(), 30)
        np.testing.assert_allclose(sum(parts.values())[planned], cost[planned], rtol=1e-12, atol=1e-12)
        changed = sum(np.abs(steps["weight_" + name] - steps["weight_asked_" + name]) for name in parts)
        self.assertGreater((changed[planned] > 0).sum(), 0, "no step tells the one from the other")

    @unittest.skipIf(missing, missing)
    def test_they_run(self):
        self.assertEqual(len(NOTEBOOKS), 3)
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            sys.path.insert(0, os.path.dirname(NOTEBOOKS[0]))  # what lies beside them
            os.chdir(folder)
            try:
                for path in NOTEBOOKS:
                    with self.subTest(os.path.basename(path)):
                        space = self.run_notebook(path)
                        if os.path.basename(path) == "look_at_a_mission.ipynb":
                            self.check_costs(space["steps"], space["parts"])
            finally:
                os.chdir(before)


if __name__ == "__main__":
    unittest.main()
