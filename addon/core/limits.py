# SPDX-License-Identifier: GPL-3.0-or-later
"""How far settings and plans may go: the native library's own table, asked for when it is first needed."""

import functools
import types

from .native import native


@functools.lru_cache(maxsize=1)
def limits():
    """The limits as attributes; raises NativeMissing where there is no native library to ask."""
    return types.SimpleNamespace(**native().limits())
