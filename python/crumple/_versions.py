"""Other versions of this package: refuses two installed distributions, and maps names in pickles of old versions."""

from __future__ import annotations

import os
import re
import sys
from importlib import import_module
from types import ModuleType
from typing import Any

from ._errors import InvalidInput


def refuse_two(folder: str) -> None:
    """Raises ImportError if `folder`, where packages are installed, has metadata of more than one distribution.

    The distributions with and without the cuda backend overwrite each other's files.
    """
    try:
        entries = os.listdir(folder)
    except OSError:  # not imported from a folder
        return
    found = {match[1] for entry in entries if (match := re.match(r"(crumple(?:_cuda\d+)?)-[^-]+\.dist-info$", entry))}
    if len(found) > 1:
        names = [name.replace("_", "-") for name in sorted(found)]
        raise ImportError(
            f"{' and '.join(names)} are both installed in {folder}, and overwrite each other's files: "
            f"pip uninstall {' '.join(names)}, then install the one that you want"
        )


def refuse(*_: Any) -> Any:
    """Raises InvalidInput. Replaces functions that restored results of version 0.2, whose classes no longer exist."""
    raise InvalidInput(
        "this was pickled by crumple 0.2, whose results crumple 0.3 does not read: "
        "unpickle it with crumple 0.2 and save its arrays"
    )


# For functions and classes that old pickles name, with their former modules: the present ones.
_MOVED = {
    "_candidates._restore": "_versions.refuse",
    "_feature_pickling.restore": "_versions.refuse",
    "_fuzzy_c_means.FuzzyCMeans": "_queries.FuzzyCMeans",
    "_impacts.FirstImpact": "_features.FirstImpact",
    "_impacts.FreeStep": "_features.FreeStep",
    "_nearest._restore": "_versions.refuse",
    "_pickling.restore": "_versions.refuse",
    "_proximities.EdgeEdgeType": "_features.EdgeEdgeType",
    "_proximities.VertexEdgeType": "_features.VertexEdgeType",
    "_proximities.VertexFaceType": "_features.VertexFaceType",
    "_proximities.VertexVertexType": "_features.VertexVertexType",
    "_result.ContactKind": "_results.ContactKind",
    "_result.Contacts": "_results.Contacts",
    "_shape.OwnName": "_mesh.OwnName",
    "_world_pickling.restore_configurations": "_world.restore_configurations",
    "_world_pickling.restore_result": "_versions.refuse",
    "_world_pickling.restore_shape": "_mesh.restore_shape",
    "_world_pickling.restore_world": "_world.restore_world",
}


class _Gone(ModuleType):
    """Module that replaces a former module, so that names in it can be imported from old pickles."""

    def __getattr__(self, name: str) -> Any:
        place = _MOVED.get(f"{self.__name__.removeprefix('crumple.')}.{name}")
        if place is None:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        module, _, name = place.rpartition(".")
        return getattr(import_module(f"crumple.{module}"), name)


refuse_two(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
for _module in {path.partition(".")[0] for path in _MOVED}:
    sys.modules[f"crumple.{_module}"] = _Gone(f"crumple.{_module}")
