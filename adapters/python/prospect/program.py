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

    As the program does, but --plugin takes files of Python, too. Signals are the program's from
    then on: Ctrl-C ends a mission with its files.
    """
    from prospect import _program

    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if arguments and arguments[0] in ("study", "replay"):
        # They start missions as processes of their own, by the path of the program that runs.
        print(
            f"prospect: {arguments[0]}: cannot be run by Python; expected the program `prospect`",
            file=sys.stderr,
        )
        return 2
    sys.stdout.flush()
    return _program.run_program(arguments, run_plugin)
