# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy
import pytest
from hybrid_mesh.core import plans
from hybrid_mesh.core.limits import limits

PLAN = json.dumps({"format": "hybrid-mesh plan", "version": 1, "base": {"quads": [[0, 1, 2, 3]]}, "operations": [], "later": "kept"})
LINE = numpy.array([[0, 0, 0.1], [1, 2, 1 / 3]])


def operation(**changes):
    values = {"level": 2, "addresses": ["12.0.3"], "strokes": [(LINE, "tight")], "buffer_rings": 1, **changes}
    strokes = values.pop("strokes")
    return plans.repatch_operation(layout=plans.drawn_layout(strokes), **values)


def test_an_address_names_every_child_on_the_way():
    assert plans.address(12, 1) == "12"
    assert plans.address(12, 4 + 2) == "12.2"
    assert plans.address(numpy.int32(12), numpy.int32(16 + 0 * 4 + 3)) == "12.0.3"


def test_addresses_are_unique():
    deep = [plans.address(0, path) for depth in range(5) for path in range(4**depth, 2 * 4**depth)]
    assert len(set(deep)) == len(deep) == sum(4**depth for depth in range(5))
    assert all(len(plans.digits(4**depth)) == depth for depth in range(15))


@pytest.mark.parametrize("root, path", [(-1, 1), (0, 0), (0, -1), (0, 2), (0, 3), (0, 8)])
def test_what_is_no_address(root, path):
    with pytest.raises(plans.PlanError):
        plans.address(root, path)


def test_quads_of_a_level_that_has_inserted_roots():
    # Roots 0 and 1 are of the base domain, root 7 was inserted at level 1.
    levels = [(1, [0, 0, 7], [4, 5, 1]), (0, [0, 1], [1, 1]), (2, [0, 7, 7], [16, 4, 7])]
    of_root = plans.root_levels(levels)
    assert of_root == {0: 0, 1: 0, 7: 1}
    assert plans.quad_addresses(2, [7, 0, 7], [7, 16, 7], of_root) == ["0.0.0", "7.3"]
    assert plans.quad_addresses(1, [0, 7], [4, 1], of_root) == ["0.0", "7"]
    for roots, paths in (([0], [4]), ([7], [16]), ([0, 0], [16, 1])):
        with pytest.raises(plans.PlanError, match="another level"):
            plans.quad_addresses(2, roots, paths, of_root)
    with pytest.raises(plans.PlanError, match="another level"):
        plans.quad_addresses(1, [3], [16], {})
    with pytest.raises(plans.PlanError, match="selected"):
        plans.quad_addresses(1, [], [], of_root)


def test_addresses_are_in_the_order_of_numbers():
    assert plans.quad_addresses(1, [10, 9, 9], [4, 7, 5], {9: 0, 10: 0}) == ["9.1", "9.3", "10.0"]


def test_an_operation_is_plain_json_with_exact_points():
    one = operation(strokes=[(LINE, "tight"), ([(1, 2, 3)], "drawn")], addresses=("12.0.3", "4"))
    assert json.loads(json.dumps(one)) == one
    assert one == {
        "level": 2,
        "quads": ["12.0.3", "4"],
        "curves": [{"points": LINE.tolist(), "fit": "tight"}, {"points": [[1.0, 2.0, 3.0]], "fit": "drawn"}],
        "buffer_rings": 1,
    }


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"level": -1}, "level"),
        ({"level": 1.5}, "level"),
        ({"addresses": []}, "no quads"),
        ({"strokes": []}, "no curves"),
        ({"buffer_rings": limits().most_buffer_rings + 1}, "buffer rings"),
        ({"level": 0}, "level"),
        ({"level": limits().most_levels + 1}, "level"),
        ({"buffer_rings": -1}, "buffer rings"),
        ({"buffer_rings": True}, "buffer rings"),
        ({"strokes": [(LINE, "loose")]}, "loose"),
        ({"strokes": [(LINE, "tight"), ([[0, 0, float("nan")]], "tight")]}, "stroke 1"),
        ({"strokes": [(LINE[:, :2], "tight")]}, "stroke 0"),
    ],
)
def test_what_is_no_operation(changes, message):
    with pytest.raises(plans.PlanError, match=message):
        operation(**changes)


def test_layouts_that_are_not_drawn():
    def region(layout):
        return plans.repatch_operation(3, ["0.1.2.3"], layout, 0)

    assert region(plans.automatic_layout()) == {"level": 3, "quads": ["0.1.2.3"], "layout": "automatic", "buffer_rings": 0}
    assert region(plans.cubes_layout(2))["height"] == 2 and region(plans.cubes_layout())["height"] == 0
    assert region(plans.rows_layout(3)) | {"layout": "rows", "height": 3} == region(plans.rows_layout(3))
    assert region(plans.even_layout(40)) | {"layout": "even", "even_quads": 40} == region(plans.even_layout(40))
    copied = region(plans.template_layout("0.1.2.3", 2, numpy.array([[0, 1, 2, 3]])))
    assert json.loads(json.dumps(copied)) == {"level": 3, "quads": ["0.1.2.3"], "layout": "template", "start": ["0.1.2.3", 2], "new_quads": [[0, 1, 2, 3]], "buffer_rings": 0}


@pytest.mark.parametrize("height", [-1, 1.0, True, limits().most_cubes + 1])
def test_what_is_no_tower(height):
    with pytest.raises(plans.PlanError, match="height"):
        plans.cubes_layout(height)


def test_the_bounds_are_the_native_modules():
    most = limits()
    one = operation(level=most.most_levels, buffer_rings=most.most_buffer_rings)
    assert (one["level"], one["buffer_rings"]) == (most.most_levels, most.most_buffer_rings)
    assert plans.cubes_layout(most.most_cubes)["height"] == most.most_cubes
    assert json.loads(plans.boundary_plan(cubes=most.most_cubes))["base"]["cubes"] == most.most_cubes


@pytest.mark.parametrize("side, quads", [(4, [[0, 1, 2, 3]]), (-1, [[0, 1, 2, 3]]), (0, []), (0, [[0, 1, 2]]), (0, [[0, 1, 2, -1]])])
def test_what_is_no_template(side, quads):
    with pytest.raises(plans.PlanError):
        plans.template_layout("0", side, quads)


def test_operations_are_appended_and_the_rest_is_kept():
    first, second = operation(), operation(level=3)
    text = plans.with_operation(plans.with_operation(PLAN, first), second)
    assert json.loads(text) == {**json.loads(PLAN), "operations": [first, second]}
    assert json.loads(PLAN)["operations"] == []


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "{}", PLAN.replace("1", "2", 1), PLAN.replace("plan", "report"), PLAN.replace("[]", "{}")])
def test_what_is_no_plan(text):
    with pytest.raises(plans.PlanError):
        plans.with_operation(text, operation())


@pytest.mark.parametrize("text, words", [(PLAN.replace("[]", "[NaN]"), "NaN"), (PLAN.replace("[]", "[-Infinity]"), "-Infinity"), ("[" * 100000, "nested")])
def test_what_python_alone_would_read_is_no_plan(text, words):
    with pytest.raises(plans.PlanError, match=words):
        plans.with_operation(text, operation())


def test_a_mark_that_some_editors_write_is_no_part_of_a_plan():
    assert plans.parse("\ufeff" + PLAN) == plans.parse(PLAN)


def test_a_base_on_a_boundary():
    assert json.loads(plans.boundary_plan())["base"] == {"boundary_nodes": "automatic", "cubes": 0}
    nodes = numpy.eye(4)[:, :3]
    plan = plans.parse(plans.boundary_plan(nodes, 3))
    assert plan["base"] == {"boundary_nodes": nodes.tolist(), "cubes": 3}
    for wrong in (nodes[:3], nodes[:, :2], numpy.full((4, 3), numpy.inf)):
        with pytest.raises(plans.PlanError):
            plans.boundary_plan(wrong)
    with pytest.raises(plans.PlanError, match="cubes"):
        plans.boundary_plan(nodes, -1)


def test_plans_are_broken_into_lines_and_stay_what_they_are():
    plan = json.dumps({"base": {"nodes": [[1, 2, 3]] * 1000, "quads": [[0, 1, 2, 3]]}, "levels": [{"operations": [{"kind": "repatch"}, {}]}]})
    text = plans.in_lines(plan)
    assert json.loads(text) == json.loads(plan)
    assert max(map(len, text.splitlines())) < 100
    assert plans.in_lines(text) == text
