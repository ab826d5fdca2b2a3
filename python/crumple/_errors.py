"""Every failure of the library, with the sentence and the place that the C++ library gives."""

import os


class Error(Exception):
    """Base of all of crumple's exceptions. The detector that raised one stays usable.

    Attributes:
        code: "invalid_argument", "not_finite", "index_out_of_range", "memory_limit", "backend_unavailable", "file",
            "format", "cancelled" or "device".
        element: what `index` counts: "vertex", "triangle", "group", "option", "line", "byte" or "none".
        index: the first offending element, -1 if there is none.
        bytes_needed: MemoryLimit: the limit, in bytes, that suffices; otherwise 0.
    """

    def __init__(
        self,
        message: str,
        *,
        code: str = "invalid_argument",
        element: str = "none",
        index: int = -1,
        bytes_needed: int = 0,
    ) -> None:
        super().__init__(message)
        self.code = code
        self.element = element
        self.index = index
        self.bytes_needed = bytes_needed

    def __reduce__(self):
        return _restore, (type(self), str(self), self.code, self.element, self.index, self.bytes_needed)


def _restore(kind, message, code, element, index, bytes_needed):
    return kind(message, code=code, element=element, index=index, bytes_needed=bytes_needed)


class InvalidInput(Error, ValueError):
    """An array, an option or a file's content makes no sense: its shape, its type, NaN, an index out of range."""


class InvalidType(InvalidInput, TypeError):
    """An argument is of a type that cannot be one."""


class MemoryLimit(Error, MemoryError):
    """Records or result do not fit the detector's memory limit; `bytes_needed` is a limit that suffices."""


class BackendUnavailable(Error):
    """The backend or instruction set asked for was not built or is not on this machine."""


class FileError(Error, OSError):
    """A file cannot be opened, read or written.

    Attributes:
        errno, strerror: as of OSError; None where it was not the operating system that refused.
    """

    def __init__(self, message: str, *, errno: int | None = None, **place) -> None:
        super().__init__(message, **place)
        if errno:
            self.errno, self.strerror = errno, os.strerror(errno)

    def __str__(self) -> str:
        return self.args[0]

    def __reduce__(self):
        return _restore_file_error, (self.args[0], self.errno, self.code, self.element, self.index)


def _restore_file_error(message, errno, code, element, index):
    return FileError(message, errno=errno, code=code, element=element, index=index)
