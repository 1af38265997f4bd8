# SPDX-License-Identifier: Apache-2.0
"""The command line, with plug-ins that are written in Python."""

import importlib.util
import os
import sys


def run_plugin(path, registries):
    """Runs a file of Python and has its prospect_plugin(registries) add what it offers."""
    if not os.path.isfile(path):
        raise ValueError("no such file; expected a file of Python with a function prospect_plugin")
    folder = os.path.dirname(os.path.abspath(path))
    if folder not in sys.path:
        sys.path.insert(0, folder)  # a plug-in may have files beside it
    name = "prospect_plugin_" + os.path.splitext(os.path.basename(path))[0]
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    if not hasattr(module, "prospect_plugin"):
        raise ValueError("has no function prospect_plugin(registries); expected one")
    module.prospect_plugin(registries)


def main(arguments=None):
    """Runs `prospect ARGUMENTS...` (list of str) in this process and gives its exit code.

    As the program does, but --plugin takes files of Python, too. Missions of studies and replays
    are processes of their own, each by this interpreter. Signals are the program's from
    then on: Ctrl-C ends a mission with its files.
    """
    from prospect import _program

    arguments = sys.argv[1:] if arguments is None else list(arguments)
    # Missions of studies and replays: the same interpreter, which finds the same modules.
    again = f"import sys; sys.path[:] = {sys.path!r}; from prospect.program import main; sys.exit(main())"
    sys.stdout.flush()
    return _program.run_program(arguments, run_plugin, [sys.executable, "-c", again])
