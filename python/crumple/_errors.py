"""Exceptions, with message and location as in the C++ library, and suggestions for misspelt keyword arguments.

The suggestions have the same form as the suggestions of Python 3.13.
"""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, TypeVar


class Error(Exception):
    """Base class of all exceptions of crumple. A detector that raised one stays usable.

    Attributes
    ----------
    code : str
        "invalid_argument", "not_finite", "index_out_of_range", "memory_limit", "backend_unavailable", "file", "format",
        "cancelled", "device" or "communication".
    element : str
        Kind of element that `index` is an index of: "vertex", "triangle", "group", "option", "line", "byte", "body",
        "shape", "edge", "point" or "none".
    index : int
        First offending element; -1 if there is none.
    bytes_needed : int
        For MemoryLimit, a lower bound on a sufficient limit; otherwise 0.
    rank : int
        For crumple.mpi, the rank that failed; otherwise -1.
    """

    def __init__(
        self,
        message: str,
        *,
        code: str = "invalid_argument",
        element: str = "none",
        index: int = -1,
        bytes_needed: int = 0,
        rank: int = -1,
    ) -> None:
        super().__init__(message)
        self.code = code
        self.element = element
        self.index = index
        self.bytes_needed = bytes_needed
        self.rank = rank

    def __reduce__(self):
        place = {name: getattr(self, name) for name in _PLACE}
        return _restore, (type(self), str(self), place)


_PLACE = ("code", "element", "index", "bytes_needed", "rank")


def _restore(kind, message, place):
    return kind(message, **place)


class InvalidInput(Error, ValueError):
    """Invalid array, option or file contents: a wrong shape or type, NaN, an index out of range, or a contradiction."""


class InvalidType(InvalidInput, TypeError):
    """Argument of the wrong type."""


class MemoryLimit(Error, MemoryError):
    """Data of a search exceed the detector's memory limit; `bytes_needed` is a lower bound on a sufficient limit."""


class BackendUnavailable(Error):
    """Requested backend or instruction set that was not built, or that this machine lacks."""


class FileWarning(UserWarning):
    """Oddity of a file that is read nevertheless. The message names the file and the line or byte."""


class FileError(Error, OSError):
    """File that cannot be opened, read or written.

    Attributes
    ----------
    errno, strerror : int, str or None
        As in OSError; None if the operating system did not report the failure.
    """

    def __init__(self, message: str, *, errno: int | None = None, **place) -> None:
        super().__init__(message, **place)
        if errno:
            self.errno, self.strerror = errno, os.strerror(errno)

    def __str__(self) -> str:
        return self.args[0]

    def __reduce__(self):
        return _restore_file_error, (self.args[0], self.errno, self.code, self.element, self.index, self.rank)


def _restore_file_error(message, errno, code, element, index, rank=-1):
    return FileError(message, errno=errno, code=code, element=element, index=index, rank=rank)


def name_of_type(kind: type) -> str:
    """Returns the name of a type for messages, with its module unless that is builtins."""
    return f"{kind.__module__}.{kind.__qualname__}".removeprefix("builtins.")


Function = TypeVar("Function", bound=Callable[..., Any])


def suggesting(function: Function) -> Function:
    """Decorates a function: if it is called with an unknown keyword argument, its TypeError suggests a similar name."""

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except TypeError as error:
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise  # the TypeError comes from inside the function
            raise TypeError(with_suggestions(str(error), function, named)) from None

    return call  # type: ignore[return-value]


def with_suggestions(sentence: str, function: Callable[..., Any], given: dict[str, Any]) -> str:
    """Returns the message `sentence` about an unknown argument, with a similar name of a parameter appended, if any."""
    parameters = list(inspect.signature(function).parameters)
    for name in given:
        close = get_close_matches(name, parameters, n=1)
        if name not in parameters and close and sentence.endswith(f"unexpected keyword argument '{name}'"):
            sentence += f". Did you mean '{close[0]}'?"
    return sentence
