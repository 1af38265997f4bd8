# SPDX-License-Identifier: Apache-2.0
"""The package as `cmake --install` and as pip put it down."""

import glob
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.dirname(os.environ["PROSPECT"])
USE = (
    "import prospect; p = prospect.Problem.from_functions([-1], [1], lambda z: z @ z, lambda z: 2 * z);"
    "print(prospect.__file__, prospect.solve(p).quality.name, prospect.Simulation.__name__)"
)


class InstallTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def check(self, interpreter, path):
        environment = {**os.environ, "PYTHONPATH": path}
        done = subprocess.run(
            [interpreter, "-B", "-c", USE], capture_output=True, text=True, env=environment, cwd=self.folder
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(done.stdout.startswith(self.folder), done.stdout)
        packages = done.stdout.split("prospect/__init__.py")[0]
        self.assertIn("FEASIBLE_OPTIMUM Simulation", done.stdout)
        for name in ["py.typed", "_core.pyi", "_program.pyi", "results.py"]:
            self.assertTrue(os.path.exists(os.path.join(packages, "prospect", name)), name)

    def test_cmake_installs_it_where_the_interpreter_looks(self):
        subprocess.run(
            [sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", self.folder], check=True
        )
        subprocess.run(
            ["cmake", "--install", BUILD, "--component", "python", "--prefix", self.folder],
            check=True, capture_output=True,
        )
        self.check(os.path.join(self.folder, "bin", "python3"), "")

    def test_pip_installs_it(self):
        for module in ["pip", "setuptools", "wheel"]:
            if not importlib.util.find_spec(module):
                self.skipTest(f"no {module} here: python3-{module} brings it")
        sources = os.path.join(self.folder, "sources")  # pip writes beside setup.py
        os.makedirs(sources)
        for name in os.listdir(ROOT):
            if name not in ("build", ".git"):
                os.symlink(os.path.join(ROOT, name), os.path.join(sources, name))
        packages = os.path.join(self.folder, "packages")
        done = subprocess.run(
            [sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index",
             "--quiet", "--target", packages, sources],
            capture_output=True, text=True,
            env={**os.environ, "PROSPECT_BUILD": BUILD, "PIP_DISABLE_PIP_VERSION_CHECK": "1"},
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.check(sys.executable, packages)


if __name__ == "__main__":
    unittest.main()
