# SPDX-License-Identifier: GPL-3.0-or-later
"""Run as a script, by Python or in Blender: does the one job that stands as a line of JSON on stdin. See core/process.py."""

import importlib.util
import os
import sys


def load_package():
    """This folder as the package `hybrid_mesh`, whatever the folder is called and without touching sys.path."""
    folder = os.path.dirname(os.path.abspath(__file__))
    spec = importlib.util.spec_from_file_location("hybrid_mesh", os.path.join(folder, "__init__.py"), submodule_search_locations=[folder])
    package = importlib.util.module_from_spec(spec)
    sys.modules["hybrid_mesh"] = package
    spec.loader.exec_module(package)
    return package


def extract(job):
    from hybrid_mesh import blend_jobs

    return blend_jobs.extract(job)


def write_blend(job):
    from hybrid_mesh import blend_jobs

    return blend_jobs.write_blend(job)


if __name__ == "__main__":
    # Python puts the script's own folder first; its modules are the package's, not top-level ones.
    if sys.path and os.path.abspath(sys.path[0]) == os.path.dirname(os.path.abspath(__file__)):
        del sys.path[0]
    load_package()
    from hybrid_mesh.core import worker

    # Blender is loaded for the jobs that need it only: most children are plain Python.
    sys.exit(worker.main({**worker.JOBS, "extract": extract, "write_blend": write_blend}))
