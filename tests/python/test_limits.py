# SPDX-License-Identifier: GPL-3.0-or-later
"""The native library and the Python around it go by one table: what one takes, the other takes."""

import json
import math

import pytest
from hybrid_mesh import _native
from hybrid_mesh.core import plans, settings
from shapes import cube

LIMITS = _native.limits()
FARTHEST = [
    ("vertices", LIMITS["most_vertices"]),
    ("error", math.nextafter(LIMITS["end_of_error"], 0)),
    ("levels", LIMITS["most_levels"]),
    ("base", LIMITS["most_base_quads"]),
    ("stretch_threshold", LIMITS["least_stretch_threshold"]),
    ("stretch_threshold", LIMITS["most_stretch_threshold"]),
    ("features", LIMITS["least_feature_angle"]),
    ("features", LIMITS["most_feature_angle"]),
    ("drop_components", math.nextafter(LIMITS["end_of_drop_components"], 0)),
    ("seed", LIMITS["most_seed"]),
    ("threads", LIMITS["most_threads"]),
]
BEYOND = [
    ("vertices", LIMITS["most_vertices"] + 1),
    ("error", LIMITS["end_of_error"]),
    ("levels", LIMITS["most_levels"] + 1),
    ("base", LIMITS["most_base_quads"] + 1),
    ("stretch_threshold", math.nextafter(LIMITS["least_stretch_threshold"], 0)),
    ("stretch_threshold", math.nextafter(LIMITS["most_stretch_threshold"], math.inf)),
    ("features", math.nextafter(LIMITS["least_feature_angle"], 0)),
    ("features", math.nextafter(LIMITS["most_feature_angle"], math.inf)),
    ("features", "some"),
    ("drop_components", LIMITS["end_of_drop_components"]),
    ("seed", LIMITS["most_seed"] + 1),
    ("threads", LIMITS["most_threads"] + 1),
]


def refused_by_native(values):
    """What the native library says of settings that are followed by one that there is not."""
    with pytest.raises(_native.InvalidInput) as raised:
        _native.start_remesh(*cube(), {**values, "nonsense": 0})
    return str(raised.value)


@pytest.mark.parametrize("name, value", FARTHEST)
def test_settings_at_their_bounds(name, value):
    assert "nonsense" in refused_by_native({name: value})
    settings.from_mapping({name: value})


@pytest.mark.parametrize("name, value", BEYOND)
def test_settings_beyond_their_bounds(name, value):
    assert f"the setting {name} must be" in refused_by_native({name: value})
    with pytest.raises(settings.SettingsError):
        settings.from_mapping({name: value})


def place_refused(base, operation):
    """The place in a plan where the native library stops, of an operation that is followed by one that is none."""
    plan = {"format": plans.FORMAT, "version": plans.VERSION, "base": base, "operations": [operation, {}]}
    with pytest.raises(_native.InvalidInput) as raised:
        _native.remesh(*cube(), {"plan": json.dumps(plan)})
    return str(raised.value)


def operation(level=1, height=1, buffer_rings=1):
    return plans.repatch_operation(level, ["0.0"], plans.cubes_layout(height), buffer_rings)


@pytest.mark.parametrize("name, most", [("level", "most_levels"), ("height", "most_cubes"), ("buffer_rings", "most_buffer_rings")])
def test_plans(name, most):
    base, most = {"boundary_nodes": "automatic"}, LIMITS[most]
    assert "operations[1]" in place_refused(base, operation(**{name: most}))
    assert f"operations[0].{name} must be" in place_refused(base, {**operation(), name: most + 1})
    with pytest.raises(plans.PlanError):
        operation(**{name: most + 1})


def test_towers_on_a_boundary():
    base = json.loads(plans.boundary_plan(cubes=LIMITS["most_cubes"]))["base"]
    assert "operations[1]" in place_refused(base, operation())
    assert "base.cubes must be" in place_refused({**base, "cubes": LIMITS["most_cubes"] + 1}, operation())
    with pytest.raises(plans.PlanError):
        plans.boundary_plan(cubes=LIMITS["most_cubes"] + 1)


def test_levels_of_a_plan():
    corners = {"nodes": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "quads": [[0, 1, 2, 3]]}
    operation = {"level": LIMITS["most_levels"] + 1, "quads": ["0.0"], "layout": "automatic"}
    plan = {"format": plans.FORMAT, "version": plans.VERSION, "base": corners, "operations": [operation]}
    with pytest.raises(_native.InvalidInput, match=rf"operations\[0\].level must be a whole number from 1 to {LIMITS['most_levels']}"):
        _native.remesh(*cube(), {"plan": json.dumps(plan)})


def test_snap():
    points, offsets, indices = cube()
    faces = [[indices[begin], *indices[begin + k : begin + k + 2]] for begin, end in zip(offsets[:-1], offsets[1:]) for k in range(1, end - begin - 1)]
    with pytest.raises(_native.InvalidInput, match="snap"):
        _native.make_layout(points, faces, [], math.nextafter(LIMITS["most_snap"], 1))
    _native.make_layout(points, faces, [], LIMITS["most_snap"])


def test_the_largest_seed_survives_a_plan():
    """Bases that are tried one after another count on from it, and a plan says which one it was."""
    given = {"vertices": 300, "seed": LIMITS["most_seed"], "base": 40}
    first = _native.remesh(*cube(), given)
    again = _native.remesh(*cube(), {**given, "plan": first.plan})
    assert (again.final_mesh()["points"] == first.final_mesh()["points"]).all()
