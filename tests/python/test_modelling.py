# SPDX-License-Identifier: GPL-3.0-or-later
"""Hierarchies made and changed by a script."""

import re
from pathlib import Path

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, cube, sphere


def grid_quads(columns, rows, height=0.0):
    points = [[x, y, height] for y in range(rows + 1) for x in range(columns + 1)]
    corner = [y * (columns + 1) + x for y in range(rows) for x in range(columns)]
    return points, [[a, a + 1, a + columns + 2, a + columns + 1] for a in corner]


def box(level=1):
    points, _, indices = cube()
    hierarchy = _native.Hierarchy(points, indices.reshape(-1, 4))
    hierarchy.refine(level)
    return hierarchy


def sheet(columns=3, rows=3, level=1):
    hierarchy = _native.Hierarchy(*grid_quads(columns, rows))
    hierarchy.refine(level)
    return hierarchy


def two_boxes():
    points, _, indices = cube()
    quads = indices.reshape(-1, 4)
    hierarchy = _native.Hierarchy(np.concatenate([points, points + [5, 0, 0]]), np.concatenate([quads, quads + 8]))
    hierarchy.refine(1)
    return hierarchy


def centres(mesh):
    assert (np.diff(mesh["offsets"]) == 4).all()
    return mesh["points"][mesh["indices"].reshape(-1, 4)].mean(axis=1)


def farthest(hierarchy, level, direction, count=1):
    """The quads of a level that lie farthest in a direction."""
    mesh = hierarchy.level(f"N{level}")
    return mesh["quad"][np.argsort(-centres(mesh) @ np.asarray(direction, float), kind="stable")[:count]]


def nearest(hierarchy, level, point, count=1):
    mesh = hierarchy.level(f"N{level}")
    return mesh["quad"][np.argsort(np.linalg.norm(centres(mesh) - point, axis=1), kind="stable")[:count]]


def corners_of(hierarchy, level, quad):
    mesh = hierarchy.level(f"N{level}")
    return mesh["points"][mesh["indices"].reshape(-1, 4)[np.flatnonzero(mesh["quad"] == quad)[0]]]


def topology(mesh):
    found = _native.topology(mesh["points"], mesh["offsets"], mesh["indices"])
    assert [found[name] for name in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges")] == [0, 0, 0]
    return found["genus"], found["components"], found["boundary_loops"]


def sound(hierarchy):
    """Invariants hold, no point is missing, and the finest level is the final mesh. Returns its topology."""
    assert hierarchy.check() == []
    final, finest = hierarchy.final_mesh(), hierarchy.level(hierarchy.level_names[-1])
    assert np.array_equal(final["indices"], finest["indices"])
    low, high = hierarchy.level("N0")["points"].min(axis=0), hierarchy.level("N0")["points"].max(axis=0)
    for name in hierarchy.level_names:
        points = hierarchy.level(name)["points"]
        assert np.isfinite(points).all() and np.linalg.norm(points, axis=1).max() < 10 * max(np.abs(low).max(), np.abs(high).max())
    return topology(final)


def everything(hierarchy, folder):
    hierarchy.save(folder / "mesh.hmesh")
    return (folder / "mesh.hmesh").read_bytes()


def by_place(mesh):
    """Points in an order that does not depend on numbers."""
    return mesh["points"][np.lexsort(mesh["points"].round(9).T)]


def missing_points(before, after):
    """How many points of a mesh are none of another's."""
    there = {tuple(p) for p in after["points"]}
    return sum(tuple(p) not in there for p in before["points"])


def test_a_base_is_what_was_given():
    points, quads = grid_quads(3, 2)
    hierarchy = _native.Hierarchy(points, quads)
    assert hierarchy.level_names == ["N0"] and sound(hierarchy) == (0, 1, 1)
    mesh = hierarchy.level("N0")
    given = {tuple(map(tuple, np.array(points)[quad])) for quad in quads}
    assert {tuple(map(tuple, face)) for face in mesh["points"][mesh["indices"].reshape(-1, 4)]} == given
    assert sorted(mesh["quad"]) == list(range(6)) and (mesh["source_face"] == -1).all()


@pytest.mark.parametrize(
    "quads, said",
    [
        ([[0, 1, 2]], "shape"),
        ([0, 1, 2, 3], "shape"),
        ([[0, 1, 2, 4]], "4 points"),
        ([[0, 1, 3, 2], [0, 1, 3, 2]], "same direction"),
        (np.zeros((0, 4), int), "no faces"),
        ([[0.5, 1, 3, 2]], "whole numbers"),
        ([[0, 1, 2, 1], [0, 3, 2, 3]], "quad 0 has the same point twice"),
        ([[0, 1, 3, 2], [1, 1, 0, 3]], "quad 1 has the same point twice"),
    ],
)
def test_what_is_no_base_is_refused(quads, said):
    with pytest.raises(_native.InvalidInput, match=said):
        _native.Hierarchy([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], quads)
    with pytest.raises(_native.InvalidInput, match="without a quad"):
        _native.Hierarchy(np.eye(5, 3), [[0, 1, 2, 3]])


def test_refinement_is_subdivision(tmp_path):
    hierarchy = box(0)
    subdivided = [hierarchy.subdivide(0, level) for level in range(4)]
    hierarchy.refine(1)
    hierarchy.refine(3)
    assert hierarchy.level_names == ["N0", "N1", "N2", "N3"] and sound(hierarchy) == (0, 1, 0)
    for level, expected in enumerate(subdivided):
        mesh = hierarchy.level(f"N{level}")
        assert np.array_equal(mesh["indices"], expected["indices"]) and np.allclose(mesh["points"], expected["points"], atol=1e-14)
    assert np.array_equal(hierarchy.final_mesh()["points"], hierarchy.level("N3")["points"])
    before = everything(hierarchy, tmp_path)
    hierarchy.refine(2)
    assert everything(hierarchy, tmp_path) == before
    for level in (-1, 25):
        with pytest.raises(_native.InvalidInput, match="no level"):
            hierarchy.refine(level)
    with pytest.raises(_native.Unsupported, match="quads"):
        hierarchy.refine(20)
    assert everything(hierarchy, tmp_path) == before


@pytest.mark.parametrize("count, height", [(1, 1), (1, 3), (2, 1), (4, 2)])
def test_cubes_stand_on_their_quads(count, height):
    hierarchy = sheet()
    before = hierarchy.level("N1")
    quads = nearest(hierarchy, 1, [1.25, 1.25, 0] if count == 1 else [1.5, 1.25, 0] if count == 2 else [1.5, 1.5, 0], count)
    sides = len(hierarchy.boundary(quads))
    foot = np.concatenate([corners_of(hierarchy, 1, quad) for quad in quads])
    made = hierarchy.add_cubes(quads, height)
    assert len(made) == count + height * sides and sound(hierarchy) == (0, 1, 1)
    mesh = hierarchy.level("N1")
    assert np.isin(made, mesh["quad"]).all() and not np.isin(quads, mesh["quad"]).any()
    assert mesh["irregular"].sum() == len(made) and np.isin(mesh["quad"][mesh["irregular"]], made).all()
    # The sheet is flat and inside it all sides are as long as each other: a tower of cubes.
    edge = 0.5
    top = {tuple(p.round(9)) for p in mesh["points"] if p[2] > (height - 0.5) * edge}
    assert top == {(*p[:2].round(9), height * edge) for p in foot}
    assert set(mesh["points"][:, 2].round(9)) == {edge * k for k in range(height + 1)}
    assert missing_points(before, mesh) == (count == 4)  # the point between the four is none of the mesh any more


def test_tubes_add_handles_and_join_components():
    hierarchy = box()
    made = hierarchy.connect(farthest(hierarchy, 1, [1, 0.1, 0.1]), farthest(hierarchy, 1, [-1, 0.1, 0.1]))
    assert len(made) == 4 and sound(hierarchy) == (1, 1, 0)
    hierarchy = two_boxes()
    assert sound(hierarchy) == (0, 2, 0)
    hierarchy.connect(nearest(hierarchy, 1, [1, 0.5, 0.5]), nearest(hierarchy, 1, [4, 0.5, 0.5]))
    assert sound(hierarchy) == (0, 1, 0)
    hierarchy.connect(nearest(hierarchy, 1, [1, -0.5, -0.5]), nearest(hierarchy, 1, [4, -0.5, -0.5]))
    assert sound(hierarchy) == (1, 1, 0)


def facing_turn(hierarchy, level, a, b):
    """The turn that makes a tube between two regions least twisted."""
    mesh = hierarchy.level(f"N{level}")
    place = {int(quad): mesh["points"][face] for quad, face in zip(mesh["quad"], mesh["indices"].reshape(-1, 4))}
    middles = [np.array([(place[q][s] + place[q][(s + 1) % 4]) / 2 for q, s in hierarchy.boundary(region)]) for region in (a, b)]
    middles = [m - m.mean(axis=0) for m in middles]
    return int(np.argmin(np.linalg.norm(middles[1] - middles[0][0], axis=1)))


def test_points_of_a_tube_lie_between_its_ends():
    # Sixteen sides and four: some rings are needed between them.
    points, quads = grid_quads(8, 8)
    upper, upper_quads = grid_quads(8, 8, 6.0)
    hierarchy = _native.Hierarchy(points + upper, quads + (np.array(upper_quads)[:, ::-1] + len(points)).tolist())
    hierarchy.refine(1)
    wide, narrow = nearest(hierarchy, 1, [4, 4, 0], 16), nearest(hierarchy, 1, [4.25, 4.25, 6])
    assert len(hierarchy.boundary(wide)) == 16
    before = hierarchy.level("N1")
    made = hierarchy.connect(wide, narrow, facing_turn(hierarchy, 1, wide, narrow))
    assert sound(hierarchy) == (0, 1, 2)
    mesh = hierarchy.level("N1")
    new = np.array([p for p in mesh["points"] if tuple(p) not in {tuple(q) for q in before["points"]}])
    assert len(new) > 0
    along = new[:, 2] / 6
    assert (along > 0.05).all() and (along < 0.95).all()
    # Between the two squares, which are 2 and 0.5 wide: the tube narrows evenly.
    centre = np.array([4, 4]) + np.outer(along, [0.25, 0.25])
    half = np.abs(new[:, :2] - centre).max(axis=1)
    assert (half <= 1 - along + 0.25 * along + 1e-9).all() and (half > 0.5 * (1 - along + 0.25 * along)).all()
    assert np.isin(made, mesh["quad"]).all()


def test_holes_have_boundaries():
    hierarchy = box(2)
    for loops, direction in enumerate(np.eye(3), start=1):
        assert len(hierarchy.open_boundary(farthest(hierarchy, 2, direction))) == 0
        assert sound(hierarchy) == (0, 1, loops)


def test_a_layout_takes_the_place_of_a_region():
    for shift in range(4):
        hierarchy = sheet()
        quads = nearest(hierarchy, 1, [1.5, 1.5, 0], 4)
        around = hierarchy.boundary(quads)
        start = tuple(around[shift])
        assert np.array_equal(hierarchy.boundary(quads, start), np.roll(around, -shift, axis=0))
        corners = np.array([corners_of(hierarchy, 1, quad)[side] for quad, side in hierarchy.boundary(quads, start)])
        made = hierarchy.free_layout(quads, [[0, 1, 2, 8], [2, 3, 4, 8], [4, 5, 6, 8], [6, 7, 0, 8]], start)
        assert len(made) == 4 and sound(hierarchy) == (0, 1, 1)
        for k, quad in enumerate(made):
            place = corners_of(hierarchy, 1, quad)
            assert np.array_equal(place[:3], corners[[2 * k, 2 * k + 1, (2 * k + 2) % 8]])
            assert np.allclose(place[3], corners[::2].mean(axis=0), atol=1e-12)  # the new point has four neighbours


REFUSED = [
    (lambda h: h.add_cubes([]), "no quads"),
    (lambda h: h.add_cubes([-1]), "does not exist"),
    (lambda h: h.add_cubes([10**9]), "does not exist"),
    (lambda h: h.add_cubes([0]), "root quad"),
    (lambda h: h.add_cubes(list(nearest(h, 1, [1, 1, 0])) * 2), "twice"),
    (lambda h: h.add_cubes(nearest(h, 1, [1.25, 1.25, 0]), 0), "at least one ring"),
    (lambda h: h.add_cubes(nearest(h, 1, [1.25, 1.25, 0]), 10**9), "more rings"),
    (lambda h: h.add_cubes(nearest(h, 1, [1.25, 1.25, 0]), 10**6), "more rings"),
    (lambda h: h.add_cubes([nearest(h, 1, [0.75, 0.75, 0])[0], nearest(h, 1, [2.25, 2.25, 0])[0]]), "not all joined"),
    (lambda h: h.add_cubes([nearest(h, 1, [0.75, 0.75, 0])[0], nearest(h, 2, [2.25, 2.25, 0])[0]]), "several levels"),
    (lambda h: h.open_boundary(nearest(h, 1, [1, 1, 0], 36)), "nothing would be left"),
    (lambda h: h.open_boundary([nearest(h, 1, [0.75, 0.75, 0])[0], nearest(h, 1, [1.25, 1.25, 0])[0]]), "more than one fan"),
    (lambda h: h.connect(nearest(h, 1, [1.25, 1.25, 0]), nearest(h, 1, [1.75, 1.25, 0])), "touch"),
    (lambda h: h.connect(nearest(h, 1, [1.25, 1.25, 0]), nearest(h, 2, [2.6, 2.6, 0])), "different levels"),
    (lambda h: h.free_layout(nearest(h, 1, [1.25, 1.25, 0]), []), "without quads"),
    (lambda h: h.free_layout(nearest(h, 1, [1.25, 1.25, 0]), [[0, 1, 2, 4]]), "hole"),
    (lambda h: h.free_layout(nearest(h, 1, [1.25, 1.25, 0]), [[3, 2, 1, 0]]), "hole|without a quad"),
    (lambda h: h.free_layout(nearest(h, 1, [1.25, 1.25, 0]), [[0, 1, 2, 3]], (10**6, 0)), "no side"),
    (lambda h: h.free_layout(nearest(h, 1, [1.25, 1.25, 0]), [[0, 1, 2, 3]], (0, 0)), "not on the boundary"),
    (lambda h: h.boundary(nearest(h, 1, [1.25, 1.25, 0]), (0, 4)), "no side"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
def test_what_cannot_be_done_changes_nothing(number, tmp_path):
    act, said = REFUSED[number]
    hierarchy = sheet(level=2)
    before = everything(hierarchy, tmp_path)
    with pytest.raises(_native.InvalidInput, match=said):
        act(hierarchy)
    assert everything(hierarchy, tmp_path) == before


def test_a_layout_that_floats_is_refused(tmp_path):
    hierarchy = sheet()
    quads = nearest(hierarchy, 1, [1.25, 1.25, 0])
    before = everything(hierarchy, tmp_path)
    apart = [[4, 7, 6, 5], [8, 9, 10, 11], [4, 5, 9, 8], [5, 6, 10, 9], [6, 7, 11, 10], [7, 4, 8, 11]]
    with pytest.raises(_native.InvalidInput, match="no edges join"):
        hierarchy.free_layout(quads, [[0, 1, 2, 3], *apart])
    assert everything(hierarchy, tmp_path) == before


def test_cubes_need_to_know_which_way_is_out():
    # Two quads back to back.
    hierarchy = _native.Hierarchy([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0]], [[0, 1, 2, 3], [2, 1, 4, 5]])
    hierarchy.refine(1)
    with pytest.raises(_native.InvalidInput, match="cancel"):
        hierarchy.add_cubes(hierarchy.level("N1")["quad"])


def test_steps_over_several_levels(tmp_path):
    hierarchy = box()
    # A head on the body, then two ears on it, then a ring through the body, a mouth, and a new layout on the back.
    head = hierarchy.add_cubes(farthest(hierarchy, 1, [0, 0, 1], 4))
    assert sound(hierarchy) == (0, 1, 0)
    hierarchy.refine(2)
    for sign in (-1, 1):
        hierarchy.add_cubes(farthest(hierarchy, 2, [sign, 0.1, 1]), 2)
        assert sound(hierarchy) == (0, 1, 0)
    hierarchy.connect(farthest(hierarchy, 2, [1, 0.01, -0.3]), farthest(hierarchy, 2, [-1, 0.01, -0.3]))
    assert sound(hierarchy) == (1, 1, 0)
    hierarchy.refine(3)
    assert sound(hierarchy) == (1, 1, 0)
    hierarchy.open_boundary(farthest(hierarchy, 3, [0, 1, 0.1]))
    assert sound(hierarchy) == (1, 1, 1)
    back = nearest(hierarchy, 3, corners_of(hierarchy, 3, farthest(hierarchy, 3, [0, -1, 0])[0])[0], 4)
    hierarchy.free_layout(back, [[0, 1, 2, 8], [2, 3, 4, 8], [4, 5, 6, 8], [6, 7, 0, 8]])
    assert sound(hierarchy) == (1, 1, 1)
    assert hierarchy.level_names == ["N0", "M1", "N1", "M2", "N2", "M3", "N3"] and len(head) == 4 + 8
    # One more on a coarser level than the last: it is there on all finer ones.
    finest = len(hierarchy.level("N3")["quad"])
    hierarchy.add_cubes(farthest(hierarchy, 2, [0, 0, -1]))
    assert sound(hierarchy) == (1, 1, 1) and len(hierarchy.level("N3")["quad"]) == finest + 4 * 4

    path = tmp_path / "made.hmesh"
    hierarchy.save(path)
    loaded = _native.load_hierarchy(path)
    assert sound(loaded) == (1, 1, 1) and loaded.info() == hierarchy.info()
    for name in hierarchy.level_names:
        assert np.array_equal(by_place(loaded.level(name)), by_place(hierarchy.level(name)))
    loaded.save(tmp_path / "again.hmesh")
    assert (tmp_path / "again.hmesh").read_bytes() == path.read_bytes()
    # Work goes on where it stood.
    loaded.connect(farthest(loaded, 3, [0, 0, 1]), farthest(loaded, 3, [0, 0, -1]))
    assert sound(loaded) == (2, 1, 1)
    # Without the operations it is the subdivided box.
    plain = hierarchy.subdivide(0, 3, False)
    assert len(plain["quad"]) == 6 * 64 and topology(plain) == (0, 1, 0)


def test_random_steps_keep_all_invariants(tmp_path):
    random = np.random.default_rng(7)
    done = dict.fromkeys(("add_cubes", "connect", "open_boundary", "free_layout"), 0)
    refused = 0
    for base in (lambda: box(1), lambda: sheet(2, 2, 1), two_boxes):
        hierarchy = base()
        euler = None
        for step in range(40):
            depth = int(hierarchy.level_names[-1][1:])
            if step in (10, 25):
                hierarchy.refine(depth + 1)
            level = int(random.integers(1, depth + 1))
            mesh = hierarchy.level(f"N{level}")
            at = centres(mesh)
            regions = [mesh["quad"][np.argsort(np.linalg.norm(at - at[random.integers(len(at))], axis=1))[: random.choice([1, 1, 2])]] for _ in range(2)]
            kind = str(random.choice(list(done)))
            before, euler = everything(hierarchy, tmp_path), characteristic(hierarchy)
            try:
                if kind == "connect":
                    hierarchy.connect(*regions, int(random.integers(-3, 4)))
                elif kind == "add_cubes":
                    hierarchy.add_cubes(regions[0], int(random.integers(1, 3)))
                elif kind == "open_boundary":
                    hierarchy.open_boundary(regions[0])
                else:
                    n = len(hierarchy.boundary(regions[0]))
                    ring = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
                    lid = [[n, n + 1, n + 2, n + 3]] if n == 4 else [[n, n + 1, n + 2, n + 5], [n + 2, n + 3, n + 4, n + 5]]
                    hierarchy.free_layout(regions[0], ring + lid)
            except _native.InvalidInput:
                refused += 1
                assert everything(hierarchy, tmp_path) == before
                continue
            done[kind] += 1
            sound(hierarchy)
            change = characteristic(hierarchy) - euler
            if kind in ("add_cubes", "free_layout"):
                assert change == 0
            elif kind == "connect":
                assert change == -2
    assert min(done.values()) > 3 and sum(done.values()) > refused


def test_the_example_of_the_documentation(tmp_path, monkeypatch):
    text = (Path(__file__).resolve().parents[2] / "docs/reference/python.md").read_text("utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(example, names)
    assert sound(names["box"]) == (1, 1, 0) and sound(_native.load_hierarchy("box.hmesh")) == (1, 1, 0)


def characteristic(hierarchy):
    genus, components, loops = topology(hierarchy.final_mesh())
    return 2 * components - 2 * genus - loops


@pytest.mark.parametrize("shape, refinement", [(sphere, "uniform"), (sphere, "adaptive"), (bent_sheet, "adaptive")])
def test_a_remesh_is_changed_on_a_coarse_level(shape, refinement, tmp_path):
    points, offsets, indices = shape()
    result = _native.remesh(points + 3, offsets, indices, {"vertices": 1500, "refinement": refinement})  # away from the origin, where points without a position are
    hierarchy = result.hierarchy
    names = hierarchy.level_names
    before = {name: hierarchy.level(name) for name in names}
    genus, components, loops = topology(result.final_mesh())
    mesh = hierarchy.level("N1")
    whole = mesh["path"] > 1  # quads of level 1, not of the base
    inner = [q for q in mesh["quad"][whole] if can_be_towered(hierarchy, q)]
    made = hierarchy.add_cubes([inner[0]], 2)
    assert hierarchy.check() == [] and len(made) == 9
    assert topology(hierarchy.final_mesh()) == (genus, components, loops)
    for name in names:
        after = hierarchy.level(name)
        assert (after["points"] > 1).all()
        # What the surface was fitted to stays fitted, but for the quads that are gone.
        gone = missing_points(before[name], after)
        assert gone == 0 if name in ("N0", "N1") else gone < len(before[name]["points"]) / 4
    final = hierarchy.final_mesh()
    assert (final["source_face"][np.unique(final["indices"].reshape(-1, 4)[~final["irregular"]])] >= 0).all()
    assert final["irregular"].any()
    # A face's address is its own.
    level = hierarchy.level("N1")
    assert len(set(zip(level["root"], level["path"]))) == len(set(level["quad"]))
    result.save(tmp_path / "changed.hmesh")
    loaded = _native.load_hierarchy(tmp_path / "changed.hmesh")
    assert loaded.check() == [] and np.array_equal(by_place(loaded.final_mesh()), by_place(result.final_mesh()))


def can_be_towered(hierarchy, quad):
    try:
        return len(hierarchy.boundary([quad])) == 4
    except _native.InvalidInput:
        return False


@pytest.mark.parametrize("faces", ["quads", "transition"])
def test_an_adaptive_hierarchy_is_completed(faces):
    surface = bent_sheet()
    hierarchy = _native.remesh(*surface, {"vertices": 1500, "refinement": "adaptive", "faces": faces}).hierarchy
    before, final = hierarchy.copy(), hierarchy.final_mesh()
    hierarchy.complete()
    assert hierarchy.check() == []
    names = [name for name in hierarchy.level_names if name[0] == "N"]
    assert len(names) - len([name for name in before.level_names if name[0] == "N"]) == (faces == "quads")
    counts = [len(hierarchy.level(name)["offsets"]) - 1 for name in names]
    assert all(finer == 4 * coarser for coarser, finer in zip(counts, counts[1:])) and hierarchy.operation_count == 0
    made = hierarchy.final_mesh()
    assert np.array_equal(made["points"], hierarchy.level(names[-1])["points"])

    def error(mesh):
        return _native.compare(mesh["points"], mesh["offsets"], mesh["indices"], *surface, 20000)["l2"]

    # What was large lies on the surface now.
    assert error(made) <= error(final)
    # Edited levels are not where the maps are: what is completed goes where they went.
    before.set_level("N0", before.level("N0")["points"] + [0, 0, 5])
    before.complete()
    assert np.abs(before.final_mesh()["points"].mean(axis=0) - made["points"].mean(axis=0) - [0, 0, 5]).max() < 0.01
