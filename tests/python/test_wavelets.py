# SPDX-License-Identifier: GPL-3.0-or-later
"""Levels edited, analysed and put together again by a script."""

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, torus


def depth(hierarchy):
    return int(hierarchy.level_names[-1][1:])


def meshes(hierarchy):
    """Points by the level's name, from the coarsest on; the final mesh last."""
    points = {name: hierarchy.level(name)["points"] for name in hierarchy.level_names}
    return {**points, "final": hierarchy.final_mesh()["points"]}


def turned(points, angle=0.7, scale=1.0, shift=(1, 2, 3)):
    c, s = np.cos(angle), np.sin(angle)
    return scale * points @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + shift


def distance(a, b):
    return np.linalg.norm(a - b, axis=1).max() / np.linalg.norm(np.ptp(b, axis=0))


@pytest.mark.parametrize("coarser", [False, True])
@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_all_that_follows_turns_with_a_level(hierarchy, scale, coarser):
    for name in hierarchy.level_names:
        edited = hierarchy.copy()
        before = meshes(hierarchy)
        edited.set_level(name, turned(before[name], scale=scale), coarser=coarser)
        after, names = meshes(edited), list(before)
        for other in names:
            if coarser or names.index(other) >= names.index(name) or other[1:] == name[1:]:
                assert distance(after[other], turned(before[other], scale=scale)) < 1e-9
            else:
                assert np.array_equal(after[other], before[other])


def test_a_level_that_is_set_to_what_it_was_changes_nothing(hierarchy):
    before = meshes(hierarchy)
    edited = hierarchy.copy()
    for name in hierarchy.level_names:
        edited.set_level(name, before[name], coarser=True)
    assert all(np.array_equal(points, before[name]) for name, points in meshes(edited).items())


def test_far_from_an_edit_nothing_changes(hierarchy):
    before = meshes(hierarchy)
    name = f"N{depth(hierarchy) - 1}"
    points = before[name].copy()
    points[len(points) // 2] += 0.01
    edited = hierarchy.copy()
    edited.set_level(name, points)
    after = meshes(edited)
    changed = (after["final"] != before["final"]).any(axis=1)
    assert 0 < changed.sum() < 0.25 * len(changed)
    assert (after[name] != before[name]).any(axis=1).sum() == 1


def normals(mesh):
    corners = mesh["points"][mesh["indices"].reshape(-1, 4)]
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return across / np.linalg.norm(across, axis=1)[:, None]


def test_details_turn_where_a_level_is_bent():
    hierarchy = _native.remesh(*torus(), {"vertices": 3000}).hierarchy

    def bent(points):
        angle = 0.3 * points[:, :1]
        c, s = np.cos(angle), np.sin(angle)
        # Turned about the x axis, the more the farther out.
        return np.hstack([points[:, :1], c * points[:, 1:2] - s * points[:, 2:], s * points[:, 1:2] + c * points[:, 2:]])

    edited = hierarchy.copy()
    edited.set_level("N1", bent(hierarchy.level_points("N1")))
    before, after = hierarchy.final_mesh(), edited.final_mesh()
    wanted = {**before, "points": bent(before["points"])}
    assert distance(after["points"], wanted["points"]) < 0.01
    deviation = np.degrees(np.arccos(np.clip((normals(after) * normals(wanted)).sum(axis=1), -1, 1)))
    assert np.median(deviation) < 1 and deviation.max() < 15
    # Without turning they would be off by as much as the surface turns.
    assert np.degrees(np.arccos(np.clip((normals(before) * normals(wanted)).sum(axis=1), -1, 1))).max() > 15


def test_points_alone_are_those_of_the_level(hierarchy):
    for name in hierarchy.level_names:
        assert np.array_equal(hierarchy.level_points(name), hierarchy.level(name)["points"])
    with pytest.raises(_native.InvalidInput, match="there is no level"):
        hierarchy.level_points("N99")


def test_what_a_point_carries_goes_with_it(hierarchy):
    edited = hierarchy.copy()
    edited.set_level("N0", turned(hierarchy.level("N0")["points"], angle=np.pi))
    before, after = hierarchy.level("N1"), edited.level("N1")
    if (before["source_face"] < 0).any():
        pytest.skip("vertices that an operation made have no map")
    surface = before["source_face"], before["source_weights"]
    # Not the nearest place of the surface any more, which would be on its other side; it may be a little beside it, where vertices were fitted to.
    same = (after["source_face"] == surface[0]).mean()
    assert same > 0.3
    assert np.array_equal(after["uv"], before["uv"])


def test_an_edit_is_saved(hierarchy, tmp_path):
    edited = hierarchy.copy()
    edited.set_level("N1", turned(hierarchy.level("N1")["points"]))
    edited.save(tmp_path / "edited.hmesh")
    loaded = _native.load_hierarchy(tmp_path / "edited.hmesh")
    assert loaded.check() == []
    assert distance(loaded.final_mesh()["points"], edited.final_mesh()["points"]) < 1e-6


def test_a_copy_knows_nothing_of_an_edit(hierarchy):
    before = meshes(hierarchy)
    edited = hierarchy.copy()
    edited.set_level("N0", before["N0"] * 2)
    assert all(np.array_equal(points, before[name]) for name, points in meshes(hierarchy).items())


def test_analysis_and_synthesis_are_inverse(hierarchy):
    points = hierarchy.final_mesh()["points"]
    low, steps = points, []
    for level in range(depth(hierarchy), 0, -1):
        steps.append((level, hierarchy.analyse(level, low)))
        low = steps[-1][1]["coarse"]
        assert low.shape == hierarchy.level(f"N{level - 1}")["points"].shape
    for level, step in reversed(steps):
        assert len(step["details"]) == len(step["detail_vertices"]) == len(step["detail_kinds"])
        assert len(step["remainder"]) == 0
        low = hierarchy.synthesise(level, low, step["details"])
    assert distance(low, points) < 1e-12


def test_without_points_a_level_is_analysed_as_it_is(hierarchy):
    level = depth(hierarchy)
    given, own = hierarchy.analyse(level, hierarchy.level(f"N{level}")["points"]), hierarchy.analyse(level)
    assert np.array_equal(given["details"], own["details"]) and given["detail_kinds"] == own["detail_kinds"]


def test_details_have_their_kinds():
    uniform = _native.remesh(*torus(), {"vertices": 2000}).hierarchy
    assert set(uniform.analyse(depth(uniform))["detail_kinds"]) == {"edge", "face"}
    adaptive = _native.remesh(*bent_sheet(), {"vertices": 1500, "refinement": "adaptive"}).hierarchy
    kinds = set().union(*(adaptive.analyse(level)["detail_kinds"] for level in range(1, depth(adaptive) + 1)))
    assert kinds == {"edge", "face", "closing"}
    uniform.add_cubes(uniform.level("N1")["quad"][:1])
    assert uniform.analyse(1)["detail_kinds"].count("inserted") == 4


def test_a_cube_leaves_a_remainder():
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    box = _native.Hierarchy(corners, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    box.refine(1)
    points = np.random.default_rng(1).normal(size=(26, 3))
    step = box.analyse(1, points)
    assert step["remainder"].shape == (26, 3)
    assert distance(box.synthesise(1, step["coarse"], step["details"], step["remainder"]), points) < 1e-12
    assert distance(box.synthesise(1, step["coarse"], step["details"]), points) > 1e-3


def test_what_cannot_be_done_is_refused(hierarchy):
    points = hierarchy.level("N1")["points"]
    for name in ("N99", "M0", "", "1"):
        with pytest.raises(_native.InvalidInput, match="there is no level"):
            hierarchy.set_level(name, points)
    with pytest.raises(_native.InvalidInput, match="points for a level"):
        hierarchy.set_level("N1", points[:-1])
    with pytest.raises(_native.InvalidInput, match="not finite"):
        hierarchy.set_level("N1", np.where(points == points[3], np.inf, points))
    with pytest.raises(_native.InvalidInput, match="points must have the shape"):
        hierarchy.set_level("N1", points.ravel())
    with pytest.raises(_native.InvalidInput, match="points must hold numbers"):
        hierarchy.set_level("N1", [["a", "b", "c"]])
    for level in (0, 99, -1):
        with pytest.raises(_native.InvalidInput, match="there is no step"):
            hierarchy.analyse(level)
    step = hierarchy.analyse(1)
    with pytest.raises(_native.InvalidInput, match="details"):
        hierarchy.synthesise(1, step["coarse"], step["details"][:-1])
    with pytest.raises(_native.InvalidInput, match="coarse positions"):
        hierarchy.synthesise(1, step["coarse"][:-1], step["details"])


def test_no_region_of_an_edited_hierarchy_is_laid_out_anew():
    hierarchy = _native.remesh(*torus(), {"vertices": 2000}).hierarchy
    edited = hierarchy.copy()
    edited.set_level("N0", turned(hierarchy.level("N0")["points"]))
    operation = {"level": 1, "quads": ["0.0", "0.1"], "layout": "automatic", "buffer_rings": 1}
    for changed in (edited, edited.copy()):
        with pytest.raises(_native.Unsupported, match="were edited"):
            changed.repatch(operation)
    assert hierarchy.repatch(operation)["operation"] == 0
