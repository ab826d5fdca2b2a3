"""Scenes, made of what the caller passes."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from . import _core
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh, as_mesh, is_mesh, mesh_of, name_of_number
from ._world import World

#: A scene as the extension module takes it (python/src/scene.h).
Scene = World | _core.Part | Mesh | tuple[Mesh, Mesh]


def scene_of(given: Any, second: Any = None, **attributes: Any) -> Scene:
    """A scene of one object, of two meshes, or of vertices and faces; with attributes of a mesh.

    One object is a crumple.World, a crumple.Part, a list or tuple of two meshes, or what as_mesh takes.
    """
    attributes = {name: value for name, value in attributes.items() if value is not None} if attributes else {}
    is_whole = isinstance(given, (World, _core.Part))
    if second is None and not attributes and (is_whole or isinstance(given, Mesh)):
        return given
    if is_whole:
        for name in [*attributes, *([] if second is None else ["a second argument"])]:
            raise InvalidType(f"{name} is for meshes, but the scene is a crumple.{type(given).__name__}")
        return given
    if second is None and isinstance(given, (list, tuple)) and len(given) == 2 and all(map(is_mesh, given)):
        given, second = given
    if second is not None and is_mesh(second):
        for name in attributes:
            raise InvalidType(f"{name} is for one mesh, but the scene is two")
        return as_mesh(given), as_mesh(second)
    return mesh_of(given, second, **attributes) if attributes or second is None else Mesh(given, second)


def kind_of(scene: Scene) -> str:
    """ "mesh", "meshes", "world" or "part"."""
    if isinstance(scene, World):
        return "world"
    if isinstance(scene, _core.Part):
        return "part"
    return "mesh" if isinstance(scene, Mesh) else "meshes"


def excluded_in(scene: Scene, excluded: Any) -> Any:
    """Pairs of bodies that are excluded, by their indices, or None."""
    if excluded is None:
        return None
    if not isinstance(scene, World):
        raise InvalidInput("excluded_bodies are bodies of a crumple.World")
    from ._world_arrays import excluded_pairs

    return excluded_pairs(excluded, scene.distinct, scene.index)


def with_names(scene: Scene, call: Callable[..., Any], *given: Any) -> Any:
    """What call(*given) gives, whose errors then name the body of a world."""
    try:
        return call(*given)
    except InvalidInput as error:
        named = _named(scene, str(error)) if isinstance(scene, World) else str(error)
        if named == str(error):
            raise
        raise type(error)(named, code=error.code, element=error.element, index=error.index) from None


def _of_shape(number: int) -> str:
    """What a shape's name names, in words: its number was made here if the name is a str, or is its own."""
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
