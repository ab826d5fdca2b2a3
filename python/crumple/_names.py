"""Keyword arguments: suggestions for misspelt ones, as Python 3.13 makes them; and those of queries."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import fields
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


def keywords_of(query: type) -> Callable[[Function], Function]:
    """For a method whose keywords are its own and, as **options, the members of a query: a signature that has them all,
    and errors that suggest a name."""

    from difflib import get_close_matches

    def with_members(method: Function) -> Function:
        signature = inspect.signature(method)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        members = [
            inspect.Parameter(f.name, inspect.Parameter.KEYWORD_ONLY, default=f.default, annotation=f.type)
            for f in fields(query)
        ]
        known = {parameter.name for parameter in (*own, *members)}

        @functools.wraps(method)
        def call(*arguments: Any, **named: Any) -> Any:
            for name in named:
                if name not in known:
                    close = get_close_matches(name, known - {"self"}, n=1)
                    meant = f". Did you mean '{close[0]}'?" if close else ""
                    raise TypeError(f"{method.__qualname__}() got an unexpected keyword argument '{name}'{meant}")
            return method(*arguments, **named)

        call.__signature__ = signature.replace(parameters=[*own, *members])  # type: ignore[attr-defined]
        return call  # type: ignore[return-value]

    return with_members
