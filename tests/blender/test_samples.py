# SPDX-License-Identifier: GPL-3.0-or-later
"""Every sample opens and is remeshed to what its README says of it."""

import collections
import pathlib

import bpy
import pytest

from conftest import module

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "blend_samples"

# sample: {object: (genus, boundary loops)}
EXPECTED = {
    "bunny": {"bunny": (0, 5)},
    "buddha": {"buddha": (6, 0)},
    "head": {"head": (0, 1)},
    "head_layout": {"head": (0, 0)},
    "knot": {"knot": (1, 0)},
    "tail": {"cat": (1, 0)},
    "two_bones": {"two bones": (0, 0)},
    "foot": {"foot": (0, 0)},
    "transforms": {"Größe 猫": (1, 0), "Stern ★": (0, 0), "mirrored": (1, 0)},
}

# sample: (genus, components) of what its README says to open on finer levels, and the settings
OPENING = {
    "tail": ((1, 1), {"base": "MIN", "refinement": "ADAPTIVE"}),
    "two_bones": ((0, 2), {"base": "MIN"}),
    "foot": ((0, 26), {"base": "MIN"}),
}


def test_every_sample_is_tested_and_named_with_its_licence():
    assert {path.stem for path in SAMPLES.glob("*.blend")} == set(EXPECTED)
    described = (SAMPLES / "README.md").read_text(encoding="utf-8")
    for path in [*SAMPLES.glob("*.blend"), *SAMPLES.glob("*.ply")]:
        assert f"`{path.name}`" in described
        assert path.stat().st_size < 1.5e6


@pytest.mark.parametrize("name", EXPECTED)
def test_sample(world, name):
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{name}.blend"))
    objects = [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]
    assert {obj.name for obj in objects} == set(EXPECTED[name])
    for obj in objects:
        hierarchy, levels, _ = world.remesh(obj, vertices=6000)
        report = module("features.levels.properties").report_of(hierarchy)
        genus, loops = EXPECTED[name][obj.name]
        for surface in (report["input"], *report["levels"], report["final"]):
            assert (surface["genus"], surface["boundary_loops"]) == (genus, loops)
        assert world.distance(obj, levels[-1])["hausdorff"] < 0.03


@pytest.mark.parametrize("name", OPENING)
def test_sample_opens_on_finer_levels(world, name):
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{name}.blend"))
    (obj,) = (obj for obj in bpy.context.scene.objects if obj.type == "MESH")
    (genus, components), settings = OPENING[name]
    hierarchy, levels, _ = world.remesh(obj, vertices=8000, topology="LATE", components="JOINED", **settings)
    report = module("features.levels.properties").report_of(hierarchy)
    shapes = [(level["genus"], level["components"]) for level in report["levels"]]
    assert shapes[0] == (0, 1) and shapes[-1] == (genus, components) and shapes == sorted(shapes)
    assert report["final"]["scaled_jacobian"]["inverted"] == 0
    for level in levels:
        sides = collections.Counter(key for polygon in level.data.polygons for key in polygon.edge_keys)
        assert set(sides.values()) == {2}
    assert world.distance(obj, levels[-1])["l2"] < 0.001


def test_the_mesh_file_is_the_bunny(world):
    points, offsets, indices = world.native().read_mesh(str(SAMPLES / "bunny.ply"))
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / "bunny.blend"))
    mesh = bpy.data.objects["bunny"].data
    assert (len(points), len(offsets) - 1) == (len(mesh.vertices), len(mesh.polygons))
