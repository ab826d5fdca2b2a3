"""How a search for pairs of features is asked of one mesh, or of a world, by one name."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from . import _core
from ._names import suggesting
from ._world import World

if TYPE_CHECKING:
    from ._detector import Detector


def or_of_world(
    of_world: Callable[..., Any], place: int = 0, of_part: Callable[..., Any] | None = None
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The search of a mesh, which is `of_world` where the argument at `place` is a World, and `of_part` where it is a
    Part. Signature: that of meshes."""

    def with_worlds(of_mesh: Callable[..., Any]) -> Callable[..., Any]:
        for search in filter(None, (of_world, of_mesh, of_part)):
            search.__name__, search.__qualname__ = of_mesh.__name__, f"Detector.{of_mesh.__name__}"
        in_world, in_mesh = suggesting(of_world), suggesting(of_mesh)
        in_part = suggesting(of_part) if of_part else None

        @functools.wraps(of_mesh)
        def search(self: Detector, *given: Any, **question: Any) -> Any:
            if len(given) > place and isinstance(given[place], World):
                return in_world(self, *given, **question)
            if in_part and len(given) > place and isinstance(given[place], _core.Part):
                return in_part(self, *given, **question)
            return in_mesh(self, *given, **question)

        return search

    return with_worlds
