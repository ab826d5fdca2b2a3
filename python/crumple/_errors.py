"""Every failure of the library, with the sentence and the place that the C++ library gives; and suggestions for
misspelt keyword arguments, as Python 3.13 makes them.
"""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, TypeVar


class Error(Exception):
    """Base of all of crumple's exceptions. The detector that raised one stays usable.

    Attributes:
        code: "invalid_argument", "not_finite", "index_out_of_range", "memory_limit", "backend_unavailable", "file",
            "format", "cancelled", "device" or "communication".
        element: what `index` counts: "vertex", "triangle", "group", "option", "line", "byte", "body",
            "shape", "edge", "point" or "none".
        index: the first offending element, -1 if there is none.
        bytes_needed: MemoryLimit: no limit below so many bytes suffices; otherwise 0.
        rank: crumple.mpi: the rank that failed; otherwise -1.
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
    """An array, an option or a file's content makes no sense: its shape, its type, NaN, an index out of range."""


class InvalidType(InvalidInput, TypeError):
    """An argument is of a type that cannot be one."""


class MemoryLimit(Error, MemoryError):
    """Records or result do not fit the detector's memory limit; `bytes_needed` tells how much is needed."""


class BackendUnavailable(Error):
    """The backend or instruction set asked for was not built or is not on this machine."""


class FileWarning(UserWarning):
    """A file is read, but something about it is odd. The sentence names the file and the line or byte."""


class FileError(Error, OSError):
    """A file cannot be opened, read or written.

    Attributes:
        errno, strerror: as in OSError; None if the failure is not the operating system's.
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
    """The name for messages, with the module of all but Python's own."""
    return f"{kind.__module__}.{kind.__qualname__}".removeprefix("builtins.")


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
    parameters = list(inspect.signature(function).parameters)
    for name in given:
        close = get_close_matches(name, parameters, n=1)
        if name not in parameters and close and sentence.endswith(f"unexpected keyword argument '{name}'"):
            sentence += f". Did you mean '{close[0]}'?"
    return sentence
