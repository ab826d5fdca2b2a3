"""Every failure of the library, with the sentence and the place that the C++ library gives."""

import os


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
