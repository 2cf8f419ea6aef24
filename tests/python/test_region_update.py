# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of a finished hierarchy that are laid out anew."""

import json

import numpy
import pytest
from hybrid_mesh import _native
from shapes import torus


def remeshed():
    return _native.remesh(*torus(40, 20), {"levels": 3, "base": 40})


def addresses_of(mesh, faces):
    """Addresses of faces, as a plan has them."""
    found = []
    for root, path in zip(mesh["root"][faces].tolist(), mesh["path"][faces].tolist(), strict=True):
        digits = []
        while path > 1:
            digits.insert(0, str(path % 4))
            path //= 4
        found.append(".".join([str(root), *digits]))
    return found


def square_of(mesh):
    """The four quads of level 2 that a quad of level 1 was cut into."""
    first = mesh["root"][0]
    return numpy.flatnonzero((mesh["root"] == first) & (mesh["path"] // 4 == mesh["path"][0] // 4))


def test_a_region_is_laid_out_anew_and_the_rest_stays():
    hierarchy = remeshed().hierarchy
    before = hierarchy.level("N2")
    faces = square_of(before)
    assert len(faces) == 4
    operation = {"level": 2, "quads": addresses_of(before, faces), "layout": "cubes", "height": 1, "buffer_rings": 1}
    outcome = hierarchy.repatch(operation)
    assert outcome["operation"] == 0 and hierarchy.operation_count == 1
    assert outcome["energy_before"] > 0 and outcome["energy_after"] > 0
    done = hierarchy.operation(0)
    assert sorted(done["quads"]) == sorted(operation["quads"]) and len(done["new_quads"]) == 12
    after = hierarchy.level("N2")
    assert len(after["offsets"]) == len(before["offsets"]) + 8
    known = {tuple(point) for point in before["points"].tolist()}
    assert sum(tuple(point) in known for point in after["points"].tolist()) > 0.8 * len(known)
    assert after["root"].min() >= 0 and after["root"].max() < len(before["root"])
    # New quads follow the numbers that there were.
    assert set(after["root"][after["irregular"]]) == set(range(before["root"].max() + 1, before["root"].max() + 13))
    assert not hierarchy.check()


def test_a_job_does_the_same():
    one, other = remeshed().hierarchy, remeshed().hierarchy
    level = one.level("N2")
    operation = {"level": 2, "quads": addresses_of(level, square_of(level)), "layout": "automatic"}
    job = one.start_repatch(json.dumps(operation))
    assert job.result() == other.repatch(operation)
    assert numpy.array_equal(one.final_mesh()["points"], other.final_mesh()["points"])


@pytest.mark.parametrize(
    ("operation", "words"),
    [
        ({"level": 2, "quads": ["999.0.0"], "layout": "automatic"}, "no quad 999.0.0"),
        ({"level": 9, "quads": ["0.0"], "layout": "automatic"}, "no level 9"),
        ({"level": 2, "quads": ["0.0.0"]}, "neither"),
        ({"level": 2, "quads": ["0.0.0"], "layout": "spiral"}, "must be"),
        ("{", "not JSON"),
    ],
)
def test_what_cannot_be_done_is_said_and_changes_nothing(operation, words):
    hierarchy = remeshed().hierarchy
    with pytest.raises(_native.InvalidInput, match=words):
        hierarchy.repatch(operation)
    assert hierarchy.operation_count == 0
