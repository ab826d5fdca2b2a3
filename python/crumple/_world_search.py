"""Detector.find for worlds."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from . import _core
from ._errors import InvalidInput
from ._names import suggesting
from ._world_result import WorldResult

if TYPE_CHECKING:
    from ._detector import Detector
    from ._world import World

Wants = Literal["any", "any_by_world", "body_pairs", "count", "pairs", "contacts"]


def find_in_world(
    self: Detector,
    world: World,
    *,
    wants: Wants = "pairs",
    neighbours: Any = "geometric",
    intersections: Any = "all",
    weld: bool = False,
    bodies: Any = "both",
    groups: Any = "both",
    excluded: Any = None,
    excluded_groups: Any = None,
    index: bool = False,
    poses: Any = None,
    copy: bool = False,
) -> WorldResult:
    question = _core.Question(wants, neighbours, intersections, weld, bodies, groups, excluded_groups, index)
    excluded = excluded_in(world, excluded)
    if poses is None:
        poses = world.poses
    return WorldResult(with_names(world, self._find_world, world, poses, question, excluded, copy), world, poses)


def excluded_in(world: World, excluded: Any) -> Any:
    """Pairs of bodies by their indices, or None."""
    if excluded is None:
        return None
    from ._world_arrays import excluded_pairs

    return excluded_pairs(world, excluded)


def with_names(world: World, find: Callable[..., Any], *given: Any) -> Any:
    """What find(*given) gives, whose errors then name the body."""
    try:
        return find(*given)
    except InvalidInput as error:
        named = _named(world, str(error))
        if named == str(error):
            raise
        raise type(error)(named, code=error.code, element=error.element, index=error.index) from None


def _of_shape(number: int) -> str:
    """What a shape's name names, in words: its number was made here if the name is a str, or is its own."""
    from ._world import name_of_number

    name = name_of_number(number)
    return "what a file named " if name is None else f"what is named {name!r} "


def _named(world: World, message: str) -> str:
    """The message with names instead of numbers: of the body, if it has one, and its configuration; of a shape."""
    message = re.sub(r"what is named (\d+) ", lambda found: _of_shape(int(found[1])), message)
    found = re.match(r"body (\d+): ", message)
    if not found or int(found[1]) >= len(world):
        return message
    body = int(found[1])
    name, moving = world.names[world.originals[body]], world._moving
    told = [repr(name)] if name else []
    if len(world) > world.distinct and body < moving * world._count:
        told.append(f"of configuration {body // moving}")
    return f"body {body} ({' '.join(told)}): {message[found.end() :]}" if told else message


find_in_world.__name__, find_in_world.__qualname__ = "find", "Detector.find"
find_in_world = suggesting(find_in_world)
