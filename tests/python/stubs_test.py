# SPDX-License-Identifier: Apache-2.0
"""The stubs say what the modules have, each name with its parameters."""

import ast
import os
import re
import unittest

import prospect
from prospect import _core, _program

FOLDER = os.path.dirname(prospect.__file__)


def stubbed(module):
    """name -> members of each class, None of each function and value; parameters by dotted name."""
    with open(os.path.join(FOLDER, module + ".pyi")) as file:
        tree = ast.parse(file.read())
    names, parameters = {}, {}

    def note(node, path):
        a = node.args
        given = [p.arg for p in a.posonlyargs + a.args + a.kwonlyargs if p.arg != "self"]
        is_property = any(getattr(d, "id", "") == "property" for d in node.decorator_list)
        if not is_property:
            parameters[path] = given

    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            members = set()
            for m in node.body:
                if isinstance(m, ast.FunctionDef):
                    members.add(m.name)
                    note(m, f"{node.name}.{m.name}")
                elif isinstance(m, ast.AnnAssign):
                    members.add(m.target.id)
                elif isinstance(m, ast.Assign):
                    members.add(m.targets[0].id)
            names[node.name] = members
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = None
            note(node, node.name)
        elif isinstance(node, ast.AnnAssign):
            names[node.target.id] = None
    return names, parameters


def public(members):
    return {m for m in members if not m.startswith("_")}


class StubsTest(unittest.TestCase):
    def test_every_name_is_stubbed_and_no_other(self):
        for name, module in [("_core", _core), ("_program", _program)]:
            names, _ = stubbed(name)
            self.assertEqual(public(dir(module)), public(names), name)
            for cls, members in names.items():
                if members is None or issubclass(getattr(module, cls), Exception):
                    continue
                # Of an enumeration pybind11 adds `name` and `value`, as Enum has.
                actual = public(vars(getattr(module, cls))) - {"name", "value"} | (
                    public(vars(getattr(module, cls))) & public(members)
                )
                self.assertEqual(actual, public(members), cls)

    def test_parameters_are_those_of_the_signature(self):
        for name, module in [("_core", _core), ("_program", _program)]:
            for path, given in stubbed(name)[1].items():
                target = module
                for part in path.split("."):
                    target = getattr(target, part)
                if path.endswith("__len__"):
                    continue
                signature = target.__doc__.splitlines()[0]
                inside = signature[signature.index("(") + 1 : signature.rindex(")")]
                inside = re.sub(r"<[^<>]*>", "", inside)  # defaults that are enumerations
                found = [p for p in re.findall(r"(\w+): ", inside) if p not in ("self", "arg0")]
                self.assertEqual(found, given, path)

    def test_everything_has_a_docstring_or_says_itself(self):
        for module in (_core, _program):
            for name in public(dir(module)):
                o = getattr(module, name)
                if isinstance(o, type) and not issubclass(o, Exception):
                    self.assertTrue(o.__doc__, name)

    def test_the_package_has_every_name_that_it_lists(self):
        for name in prospect.__all__:
            self.assertTrue(hasattr(prospect, name), name)
        self.assertLessEqual(public(dir(_core)), set(prospect.__all__))


if __name__ == "__main__":
    unittest.main()
