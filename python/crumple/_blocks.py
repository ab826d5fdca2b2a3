"""How answers in blocks are handed over to what the caller gives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._errors import InvalidType


def taker(take: Any, block: type) -> Callable[[Any], Any]:
    """Calls `take` with each block, made of the library's answer."""
    if not callable(take):
        raise InvalidType(f"take must be callable with a crumple.{block.__name__}, not {type(take).__name__}")
    return lambda answer: take(block(answer))
