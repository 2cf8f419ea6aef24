# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled module, imported when it is first needed so that this package can be imported without it."""

import os
import platform
import sys


class NativeMissing(RuntimeError):
    """The compiled module is not beside this package or does not fit this Python."""


def native():
    """The module `_native`; raises NativeMissing saying what to do."""
    try:
        import numpy  # noqa: F401 - the module takes and gives its arrays
    except ImportError as error:
        raise NativeMissing(f"Python {platform.python_version()} ({sys.executable}) has no NumPy, which Hybrid Mesh needs ({error})") from error
    try:
        from .. import _native
    except ImportError as error:
        raise NativeMissing(f"the compiled module hybrid_mesh._native cannot be loaded ({error}); scripts/build makes it") from error
    return _native


def explain(error, path=None):
    """One line for people that says what went wrong, whatever was raised. `path` is left out of it: the caller names the input."""
    kind = type(error).__name__
    text = " ".join(str(error).split())
    if isinstance(error, OSError) and error.strerror:
        text = error.strerror if error.filename is None or error.filename == path else f"{error.filename}: {error.strerror}"
    elif kind == "LayoutError" and error.args:
        text = " ".join(str(error.args[0]).split())  # What follows are the problems, with their places.
    elif isinstance(error, MemoryError):
        text = "not enough memory"
    elif kind == "InternalError":
        text = f"internal error: {text}"
    elif not expected(error):
        text = f"internal error: {kind}: {text}"
    if path is not None:
        for name in (os.fspath(path), os.path.basename(path)):
            text = text.removeprefix(f"{name}: ")
    return text or kind


def expected(error):
    """Whether an error was foreseen: its words are then meant for people."""
    if isinstance(error, (NativeMissing, ValueError)):
        return True
    return any(base.__name__ == "Error" for base in type(error).__mro__)
