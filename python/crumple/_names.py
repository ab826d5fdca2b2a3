"""Keyword arguments by nearly their names: what Python 3.13 suggests, in every version."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def suggest(error: TypeError, function: Callable[..., Any], given: dict[str, Any]) -> None:
    """Raises the error again, with the parameter that was meant if one of the given names is close to it."""
    from difflib import get_close_matches

    sentence = str(error)
    parameters = list(inspect.signature(function).parameters)
    for name in given:
        close = get_close_matches(name, parameters, n=1)
        if name not in parameters and close and sentence.endswith(f"unexpected keyword argument '{name}'"):
            sentence += f". Did you mean '{close[0]}'?"
    raise TypeError(sentence) from None


def refuse(function: Callable[..., Any], /, *arguments: Any, **named: Any) -> None:
    """Raises what Python raises when a function is given arguments that it does not take."""
    try:
        function(*arguments, **named)
    except TypeError as error:
        suggest(error, function, named)


def suggesting(function: Function) -> Function:
    """The function, with suggestions for names of arguments that it does not know."""

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except TypeError as error:
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise  # from within
            suggest(error, function, named)

    return call  # type: ignore[return-value]
