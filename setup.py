# SPDX-License-Identifier: Apache-2.0
"""Builds the Python package by CMake, for pip: docs/tutorials/python.md.

PROSPECT_BUILD: a build tree that is there already, whose package is taken as it is. Without it, one
is made in build/pip.
"""

import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = os.path.dirname(os.path.abspath(__file__))


def version():
    with open(os.path.join(ROOT, "models", "version.h"), encoding="utf-8") as file:
        return re.search(r'kVersion.*"([^"]+)"', file.read()).group(1)


class CMakeBuild(build_ext):
    def run(self):
        build = os.environ.get("PROSPECT_BUILD")
        if not build:
            build = os.path.join(ROOT, "build", "pip")
            subprocess.check_call(
                [
                    "cmake", "-S", ROOT, "-B", build, "-G", "Ninja",
                    f"-DPython_EXECUTABLE={sys.executable}",
                    "-DPROSPECT_BUILD_TESTS=OFF",
                    "-DPROSPECT_BUILD_BENCHMARKS=OFF",
                ]
            )  # fmt: skip
        subprocess.check_call(["cmake", "--build", build, "--target", "_core", "_program"])
        with tempfile.TemporaryDirectory() as prefix:
            subprocess.check_call(
                ["cmake", "--install", build, "--component", "python", "--prefix", prefix]
            )
            (made,) = glob.glob(os.path.join(prefix, "lib", "*", "*", "prospect"))
            shutil.copytree(made, os.path.join(self.build_lib, "prospect"), dirs_exist_ok=True)

    def get_outputs(self):
        return []


setup(
    version=version(),
    packages=[],
    ext_modules=[Extension("prospect._core", []), Extension("prospect._program", [])],
    cmdclass={"build_ext": CMakeBuild},
)
