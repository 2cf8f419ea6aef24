# SPDX-License-Identifier: GPL-3.0-or-later
"""The jobs of core/worker.py that need Blender: scenes as inputs and .blend files as outputs of the command line."""

import json

from . import registration
from .bridge import blend_files
from .core import worker
from .features.levels import properties


def extract(job):
    """Every mesh object of a scene's file as arrays in a folder."""
    worker.refuse_unreadable(job["path"])
    return {"objects": blend_files.extract(job["path"], job["folder"], job.get("density", ""))}


def write_blend(job):
    """A .blend with the levels of a hierarchy."""
    with open(job["report"], encoding="utf-8", errors="surrogateescape") as file:
        report = json.load(file)
    blend_files.new()
    registration.register()
    built = blend_files.build(job["hmesh"], job["name"])
    properties.describe(built, None, report)
    blend_files.save(job["target"])
    return {}
