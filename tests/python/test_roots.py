# SPDX-License-Identifier: GPL-3.0-or-later
"""Every face names the root quad that it comes of by its number in the plan, whatever was tried on the way to the result."""

import json
from pathlib import Path

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import sphere

BUNNY = _native.read_mesh(Path(__file__).resolve().parents[2] / "blend_samples/bunny.ply")


def lumpy():
    points, offsets, indices = sphere(8)
    x, y, z = points.T
    return points * (1 + 0.25 * np.sin(3 * x) * np.cos(2 * y + 1) + 0.1 * np.sin(5 * z))[:, None], offsets, indices


# With a bound on the error several bases are tried, and the best of them is not always the last.
CASES = {
    "lumpy, error": (lumpy(), {"error": 6e-3}),
    "bunny, error": (BUNNY, {"error": 2e-4}),
    "bunny, vertices": (BUNNY, {"vertices": 4000}),
    "bunny, minimal base": (BUNNY, {"vertices": 4000, "base": "min", "topology": "base"}),
}


@pytest.fixture(scope="module", params=CASES)
def result(request):
    mesh, settings = CASES[request.param]
    return _native.remesh(*mesh, settings)


def root_count(result):
    """How many root quads the addresses of a plan know: those of the base and the new ones of every operation."""
    plan = json.loads(result.plan)
    count = len(plan["base"]["quads"])
    for region in plan.get("operations", []):
        # Towers have a ring of as many quads as the region has sides, at most four a quad, for each cube, and the region's own on top.
        count += len(region["new_quads"]) if "new_quads" in region else len(region["quads"]) * (1 + 4 * region["height"])
    return count


def test_roots_are_numbers_of_root_quads(result):
    count = root_count(result)
    for name in result.hierarchy.level_names:
        level = result.hierarchy.level(name)
        assert level["root"].min() >= 0 and level["root"].max() < count, name
    final = result.final_mesh()
    assert final["root"].min() >= 0 and final["root"].max() < count


def test_a_root_and_a_path_name_one_face(result):
    for name in result.hierarchy.level_names:
        level = result.hierarchy.level(name)
        addresses = np.stack([level["root"], level["path"]], axis=1)
        assert len(np.unique(addresses, axis=0)) == len(addresses), name


def test_faces_of_one_root_are_of_one_patch(result):
    for name in result.hierarchy.level_names:
        level = result.hierarchy.level(name)
        pairs = np.unique(np.stack([level["root"], level["patch"]], axis=1), axis=0)
        assert len(pairs) == len(np.unique(pairs[:, 0])) == len(np.unique(pairs[:, 1])), name


def test_the_base_has_every_quad_of_the_plan_undivided(result):
    base = result.hierarchy.level("N0")
    assert sorted(base["root"]) == list(range(len(json.loads(result.plan)["base"]["quads"]))) and (base["path"] == 1).all()


def test_operations_name_quads_that_there_are(result):
    hierarchy, count = result.hierarchy, root_count(result)
    for number in range(hierarchy.operation_count):
        for address in hierarchy.operation(number)["quads"]:
            assert 0 <= int(address.split(".")[0]) < count
