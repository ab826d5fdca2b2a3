"""Writes the API reference of the Python package by pdoc, from the sources: nothing has to be built.

    python3 scripts/python_reference.py FOLDER

Substitutes for the classes of the extension modules are made from their bindings and docstrings in python/src. Lists public modules, classes,
functions and properties without a docstring; exit status 1 if there are any. Warnings of pdoc are errors.
"""

import ast
import re
import sys
import types
import warnings
from functools import cached_property
from importlib import import_module
from importlib.machinery import ModuleSpec
from inspect import getattr_static
from pathlib import Path

import pdoc

PACKAGES = ["crumple", "crumple.mpi", "crumple.adapters"]  # without private modules
# Modules whose public entities need docstrings. The methods of crumple.adapters.ipctk need none, since ipctk documents the
# methods that they override.
MODULES = [*PACKAGES, *(f"crumple.adapters.{name}" for name in ("mujoco", "newton", "trimesh_manager", "urdf"))]
LITERALS = r'((?:"(?:[^"\\]|\\.)*"\s*)+)'

root = Path(__file__).resolve().parent.parent


class StandIn(types.ModuleType):
    """Substitute for a module that cannot be imported. It has the given attributes; any other name in it is an empty class."""

    def __init__(self, name, **given):
        super().__init__(name)
        self.__spec__ = ModuleSpec(name, None)
        self.__dict__.update(given)
        sys.modules[name] = self

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        setattr(self, name, made := class_of(name, {}, self.__name__))
        return made


def class_of(name, members, module):
    return type(name, (), {"__module__": module, "__slots__": (), **members})


def bound_classes(folder, module):
    """Returns the classes that C++ sources bind by nanobind, with their properties and docstrings."""
    classes = {}
    for source in sorted((root / folder).glob("*.cpp")):
        for binding in source.read_text().split("nb::class_<")[1:]:
            head = re.match(rf'[^;"]*\(\s*module, "(\w+)",\s*{LITERALS}\)', binding)
            if not head:
                continue
            members = {"__doc__": ast.literal_eval(f"({head[2]})")}
            for call in binding.split(".def_")[1:]:
                if named := re.match(r'(?:prop_)?r[ow]\(\s*"(\w+)"', call):
                    text = re.search(rf",\s*{LITERALS}\)\s*(;|$|\.def\()", call)
                    members[named[1]] = property(lambda _: None, doc=ast.literal_eval(f"({text[1]})") if text else None)
            classes[head[1]] = class_of(head[1], members, module)
    return classes


def describe_functions_of_properties(kind):
    """Copies the docstrings of properties to their functions, where pdoc reads them."""
    for base in kind.__mro__:
        for value in vars(base).values():
            if isinstance(value, property | cached_property):
                function = value.fget if isinstance(value, property) else value.func
                function.__doc__ = value.__doc__


def undocumented(entity):
    """Yields public entities without a docstring. Fields are described by the docstrings of their classes."""
    if not entity.docstring:
        yield entity.fullname
    for name, member in getattr(entity, "members", {}).items():
        is_property = isinstance(getattr_static(entity.obj, name, None), property | cached_property)
        if name[0] != "_" and (member.kind != "variable" or is_property):
            yield from undocumented(member)


def main(folder):
    sys.path.insert(0, str(root / "python"))
    sys.dont_write_bytecode = True
    version = re.findall(r"_(?:MAJOR|MINOR|PATCH) (\d+)$", (root / "include/crumple/version.h").read_text(), re.MULTILINE)
    StandIn("crumple._core", __version__=".".join(version), **bound_classes("python/src", "crumple"))
    StandIn("crumple._mpi", **bound_classes("python/src/mpi", "crumple.mpi"), library=str, handle_size=str, world=str)
    StandIn("mpi4py", MPI=types.SimpleNamespace(
        Comm=None, COMM_WORLD=None, Get_library_version=str, _sizeof=lambda _: "", _handleof=lambda _: ""))
    StandIn("ipctk")
    warnings.simplefilter("error")
    warnings.filterwarnings("ignore", "Error parsing type annotation")  # pdoc then shows the annotation as it is written

    import crumple

    # Documents classes that are not exported, because users only receive their objects, as well.
    crumple.__all__ += sorted(name for name, value in vars(crumple).items() if isinstance(value, type)
                              and name[0] != "_" and name not in crumple.__all__)
    for kind in {value for module in MODULES for value in vars(import_module(module)).values() if isinstance(value, type)}:
        describe_functions_of_properties(kind)
    pdoc.render.configure(docformat="numpy", show_source=False)
    pdoc.pdoc(*PACKAGES, "!.*[.]_", output_directory=Path(folder))
    missing = [name for module in MODULES for name in undocumented(pdoc.doc.Module(sys.modules[module]))]
    for name in missing:
        print(f"{name} has no docstring", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
