"""Refuses pickles of crumple 0.2, whose results had other classes, by a sentence that says so."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

from ._errors import InvalidInput


def refuse(*_: Any) -> Any:
    """Stands for a function that results of 0.2 were restored by."""
    raise InvalidInput(
        "this was pickled by crumple 0.2, whose results crumple 0.3 does not read: "
        "unpickle it with crumple 0.2 and save its arrays"
    )


# Functions by the modules that 0.2 had and 0.3 has not; those of _candidates and _world_pickling are there.
for _module, _function in (("_pickling", "restore"), ("_feature_pickling", "restore"), ("_nearest", "_restore")):
    _gone = ModuleType(f"crumple.{_module}")
    setattr(_gone, _function, refuse)
    sys.modules[_gone.__name__] = _gone
