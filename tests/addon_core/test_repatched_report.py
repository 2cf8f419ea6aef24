# SPDX-License-Identifier: GPL-3.0-or-later
import copy

from hybrid_mesh.core import report as reports

REPORT = {
    "levels": [{"level": j, "vertices": 8 * 4**j, "quads": 6 * 4**j, "l2": 0.1, "hausdorff": 0.2, "irregular_vertices": 8, "stretch": {}, "irregular_ops": []} for j in range(3)],
    "final": {"vertices": 98, "quads": 96, "l2": 0.1, "hausdorff": 0.2, "irregular_vertices": {"base": 8}, "scaled_jacobian": {"min": 0.5}},
    "verdict": {"result": "poor", "reasons": [{"what": "hausdorff", "text": "far off"}]},
    "warnings": ["old"],
}
OPERATION = {"kind": "add_cubes", "level": 1, "quads": ["0.0"], "new_quads": [[0, 1, 2, 3]] * 5}
COUNTS = {1: {"vertices": 30, "quads": 28}, 2: {"vertices": 114, "quads": 112}}


def repatched(before=2.0, after=1.0, bound=0):
    report = copy.deepcopy(REPORT)
    made = reports.repatched(report, OPERATION, {"energy_before": before, "energy_after": after, "levels": COUNTS}, bound)
    assert report == REPORT
    return made


def test_what_was_not_measured_again_is_not_told():
    made = repatched()
    assert made["levels"][0] == REPORT["levels"][0]
    assert [(level["vertices"], level["quads"], level["l2"]) for level in made["levels"][1:]] == [(30, 28, None), (114, 112, None)]
    assert made["levels"][1]["irregular_ops"] == [{"kind": "add_cubes", "removed_quads": 1, "new_quads": 5}]
    assert (made["final"]["vertices"], made["final"]["l2"], made["final"]["scaled_jacobian"]) == (114, None, None)
    assert made["warnings"] == [] and made["final"]["self_intersections"] is None and reports.verdict(made) == "" and reports.reasons(made) == []
    assert reports.quality(made)["scaled_jacobian_min"] is None and len(reports.level_table(made)) == 4


def test_one_side_alone_is_not_symmetric():
    made = reports.repatched({**REPORT, "symmetry": {"plane": [1, 0, 0, 0]}}, OPERATION, {"energy_before": 2.0, "energy_after": 1.0, "levels": COUNTS}, 0)
    assert "symmetry" not in made and "no longer symmetric" in made["warnings"][0]


def test_a_region_that_is_no_better_and_a_bound_that_is_passed_are_said():
    assert "no better" in repatched(before=1.0, after=1.0)["warnings"][0]
    assert repatched(bound=114)["warnings"] == []
    assert "more than the bound of 113" in repatched(bound=113)["warnings"][0]


def test_new_quads_that_do_not_follow_a_density_are_said():
    report = {**copy.deepcopy(REPORT), "density": {"name": "dense", "smallest": 0.5, "largest": 2, "met": 0.1}}
    made = reports.repatched(report, OPERATION, {"energy_before": 2.0, "energy_after": 1.0, "levels": COUNTS})
    assert made["density"] == {"name": "dense", "smallest": 0.5, "largest": 2, "met": None} and report["density"]["met"] == 0.1
    assert len(made["warnings"]) == 1 and "'dense'" in made["warnings"][0]
