"""Suggestions for misspelt keyword arguments, as Python 3.13 makes them, in every version."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def suggesting(function: Function) -> Function:
    """The function, which then suggests a name for an argument that it does not know."""

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except TypeError as error:
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise  # from within
            raise TypeError(_with_suggestions(str(error), function, named)) from None

    return call  # type: ignore[return-value]


def _with_suggestions(sentence: str, function: Callable[..., Any], given: dict[str, Any]) -> str:
    from difflib import get_close_matches

    parameters = list(inspect.signature(function).parameters)
    for name in given:
        close = get_close_matches(name, parameters, n=1)
        if name not in parameters and close and sentence.endswith(f"unexpected keyword argument '{name}'"):
            sentence += f". Did you mean '{close[0]}'?"
    return sentence
