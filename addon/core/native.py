# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled module, imported when it is first needed so that this package can be imported without it."""

import os
import platform
import re
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
        raise NativeMissing(_misfit(error)) from error
    return _native


def _misfit(error):
    """Why the module does not load, in one sentence: what this zip is for and what this machine is."""
    folder = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    tags = [found for name in os.listdir(folder) if (found := re.fullmatch(r"_native\.cpython-(\d)(\d+)-x86_64-linux-gnu\.so", name))]
    built = [f"{tag[1]}.{tag[2]}" for tag in sorted(tags, key=lambda tag: int(tag[2]))]
    if not built:
        return f"the compiled module hybrid_mesh._native cannot be loaded ({error}); scripts/build makes it"
    if (sys.platform, platform.machine()) != ("linux", "x86_64"):
        return f"this build of Hybrid Mesh is for Linux on x86-64 processors, not for {platform.system()} on {platform.machine()}"
    here = "{}.{}".format(*sys.version_info)
    if here not in built:
        return f"this build of Hybrid Mesh is for Python {' and '.join(built)}, not for Python {here}, which runs here"
    library = re.search(r"version `(GLIBC|GLIBCXX|CXXABI)_([\d.]+)' not found", str(error))
    if library:
        name = "glibc" if library[1] == "GLIBC" else f"a C++ library with {library[1]}"
        return f"this build of Hybrid Mesh needs {name} {library[2]} or later; this system has {' '.join(platform.libc_ver())}"
    return f"the compiled module hybrid_mesh._native cannot be loaded ({error})"


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
