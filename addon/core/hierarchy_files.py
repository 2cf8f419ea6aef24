# SPDX-License-Identifier: GPL-3.0-or-later
"""Hierarchies as bytes, as .hmesh files have them, and the notes that are written beside them."""

import contextlib
import json
import math
import os
import tempfile
from dataclasses import dataclass, field
from typing import Any

from .native import explain, native

EXTENSION = ".hmesh"
_STREAM = b"HMw"  # what a stream starts with, of whatever version
_IDENTITY = [float(i % 5 == 0) for i in range(16)]


@dataclass
class Notes:
    """What a container's metadata says of where the hierarchy is and how good; the default of what it does not say, or not rightly."""

    matrix: list = field(default_factory=lambda: _IDENTITY)  # 4 x 4, row by row: from the space of the objects to the hierarchy's
    placement: list = None  # 4 x 4: from the space of the objects to the world, where they were moved since; None: they were not
    edited: bool = False  # levels were put elsewhere than the surface is
    verdict: Any = None  # as a report has it

    def __post_init__(self):
        self.placement = self.placement or self.matrix


def read(path):
    """The bytes of a file. Raises OSError, and ValueError if there are none."""
    with open(path, "rb") as file:
        data = file.read()
    if not data:
        raise ValueError("the file is empty")
    return data


def is_stream(data):
    return data[: len(_STREAM)] == _STREAM


def decode(data):
    """The native hierarchy of a container's or stream's bytes. Raises the native errors, in words that name no file."""
    with _scratch_file() as path:
        with open(path, "wb") as file:
            file.write(data)
        try:
            return native().load_hierarchy(path)
        except native().Error as error:
            raise type(error)(explain(error, path)) from None


def encode(hierarchy, metadata):
    """The bytes of a container; metadata: whatever JSON has."""
    with _scratch_file() as path:
        hierarchy.save(path, json.dumps(metadata))
        return read(path)


def least_prefix(data):
    """How many bytes of a stream have its base whole, so that they can be decoded. Raises as decode() where all of them have not."""
    decode(data)
    too_few, enough = 0, len(data)
    while enough - too_few > 1:
        middle = (too_few + enough) // 2
        try:
            decode(data[:middle])
            enough = middle
        except native().CorruptStream:
            too_few = middle
    return enough


def parse_notes(text):
    """The notes of a container's metadata, which may have been written by anyone."""
    try:
        found = json.loads(text)
    except ValueError:
        return Notes()
    if not isinstance(found, dict):
        return Notes()
    matrix, verdict = found.get("matrix"), found.get("verdict")
    if not _is_matrix(matrix):
        return Notes(verdict=verdict if _is_verdict(verdict) else None)
    placement = found.get("placement")
    return Notes(matrix, placement if _is_matrix(placement) else None, found.get("edited") is True, verdict if _is_verdict(verdict) else None)


def report(hierarchy, verdict):
    """What a report says of a hierarchy that was not measured: its counts, and the verdict that was kept."""
    info = json.loads(hierarchy.info())
    levels = [{"level": int(level["name"][1:]), **level} for level in info["levels"] if level["name"].startswith("N")]
    return {"base": info["base"], "levels": levels, "final": {**info["final"], "irregular_vertices": None}, "verdict": verdict}


def _is_matrix(values):
    return _is_numbers(values, 16)


def _is_verdict(verdict):
    if not isinstance(verdict, dict) or not isinstance(verdict.get("result"), str) or not isinstance(verdict.get("reasons"), list):
        return False
    return all(_is_reason(reason) for reason in verdict["reasons"])


def _is_reason(reason):
    return isinstance(reason, dict) and isinstance(reason.get("text"), str) and _is_numbers(reason.get("where", [0, 0, 0]), 3)


def _is_numbers(values, count):
    return isinstance(values, list) and len(values) == count and all(type(value) in (int, float) and math.isfinite(value) for value in values)


@contextlib.contextmanager
def _scratch_file():
    with tempfile.TemporaryDirectory() as folder:
        yield os.path.join(folder, "hierarchy" + EXTENSION)
