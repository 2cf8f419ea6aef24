# SPDX-License-Identifier: GPL-3.0-or-later
import sys
from pathlib import Path

import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, sphere, torus

# The samples' shapes, and the measures of the benchmarks.
ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "blend_samples"), str(ROOT / "tests/benchmarks")]


@pytest.fixture(scope="module", params=["uniform", "open", "adaptive", "operations"])
def hierarchy(request):
    """One of each kind. A test that changes it leaves it changed for the others of its file."""
    if request.param == "uniform":
        return _native.remesh(*torus(), {"vertices": 2000}).hierarchy
    if request.param == "open":
        return _native.remesh(*bent_sheet(), {"vertices": 1000}).hierarchy
    if request.param == "adaptive":
        return _native.remesh(*bent_sheet(), {"vertices": 1500, "refinement": "adaptive"}).hierarchy
    hierarchy = _native.remesh(*sphere(), {"vertices": 2000}).hierarchy
    hierarchy.add_cubes(hierarchy.level("N1")["quad"][:1], height=2)
    return hierarchy
