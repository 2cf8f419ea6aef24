# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop drawn by mouse around the Buddha's arm, half of it from either side, becomes the cut; the remesh opens it on the level that it is given."""

import json
import os
import sys

import bpy
import numpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402
from hybrid_mesh.bridge import arrays, levels, meshes, strokes  # noqa: E402
from hybrid_mesh.core import loops as lines  # noqa: E402
from hybrid_mesh.features.layouts import properties as layout_properties  # noqa: E402
from hybrid_mesh.features.topology import properties  # noqa: E402

SAMPLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "blend_samples", "buddha.blend")
# The right arm, which is raised: a place inside, and how wide it is from there to its outline. Seen from the front and from behind there is nothing beside it.
ARM, HALF_WIDTH = Vector((-0.197, 0.165, 1.83)), 0.04
UP, ACROSS, FRONT = Vector((0, 0, 1)), Vector((1, 0, 0)), Vector((0, -1, 0))


def steps():
    stepper.empty_scene()
    with bpy.data.libraries.load(SAMPLE) as (_, chosen):
        chosen.objects = ["buddha"]
    buddha = chosen.objects[0]
    bpy.context.scene.collection.objects.link(buddha)
    bpy.context.view_layer.objects.active = buddha
    view = stepper.view()
    view["space_data"].show_region_ui = False
    with bpy.context.temp_override(**view):
        assert bpy.ops.hybrid_mesh.draw_layout("INVOKE_DEFAULT", True) == {"FINISHED"}
    yield 1
    for name, towards in (("front", FRONT), ("back", -FRONT)):
        look(towards)
        yield 1
        yield from stepper.draw(across())
        stepper.screenshot(f"loop_{name}")
    layout = layout_properties.layout_of(buddha, bpy.context.scene)
    drawn = strokes.read(layout, bpy.context.scene.frame_current)
    # Neither half is closed by itself.
    assert len(drawn) == 2 and all(len(one.points) > 10 and lines.closed(one.points, 0.05) is None for one in drawn), "the mouse drew something else"

    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.draw_loop("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.5
    stepper.screenshot("loop_made")
    (loop,) = properties.loops_of(buddha)
    points = arrays.transformed(lines.from_text(loop.points), numpy.array(buddha.matrix_world, dtype=float))
    assert loop.drawn and loop.kind == "HANDLE" and not strokes.read(layout, bpy.context.scene.frame_current)
    # Around the arm where the mouse was.
    away = points - numpy.array(ARM)
    assert numpy.linalg.norm(away, axis=1).max() < 4 * HALF_WIDTH and (away.min(0) < 0)[:2].all() and (away.max(0) > 0)[:2].all()

    loop.level = 2
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.context.view_layer.objects.active = buddha
        buddha.select_set(True)
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", True, vertices=8000, base="GIVEN", base_quads=120) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.5
    collection = bpy.data.collections["buddha hierarchy"]
    report = json.loads(collection.hybrid_mesh.report)
    (opened,) = report["topology"]["loops"]
    assert (opened["level"], opened["number"], opened["kind"]) == (2, 1, "handle") and abs(opened["length"] - loop.length) < 1e-4
    assert [level["genus"] for level in report["levels"]] == [5, 5, 6, 6]
    # Its quads are around the arm, and say so.
    level = bpy.data.objects["buddha.N2"]
    where = meshes.face_numbers(level, meshes.OPENED) == 1
    assert where.any() and (meshes.face_numbers(level, meshes.OPENED_LEVEL)[where] == 2).all()
    middles = numpy.array([tuple(level.matrix_world @ polygon.center) for polygon in level.data.polygons])
    nearest = numpy.linalg.norm(middles - numpy.array(ARM), axis=1).argsort()[:4]
    assert where[nearest].all()
    levels.set_level(bpy.data.objects["buddha.preview"], 2)
    yield 1
    stepper.screenshot("loop_opened")


def look(towards):
    """Turns the view to look at the arm from a direction."""
    region = stepper.view()["space_data"].region_3d
    region.view_perspective = "ORTHO"
    region.view_rotation = Matrix((UP.cross(towards), UP, towards)).transposed().to_quaternion()
    region.view_location, region.view_distance = ARM, 0.6


def across():
    """Places of the window on the way across the arm, from just beside it to just beside it."""
    view = stepper.view()
    region, region_3d = view["region"], view["space_data"].region_3d
    ends = [location_3d_to_region_2d(region, region_3d, ARM + sign * 1.03 * HALF_WIDTH * ACROSS) for sign in (-1, 1)]
    assert (ends[1] - ends[0]).length > 50, "the arm is not looked at from near enough"
    return [numpy.array((region.x, region.y)) + numpy.array(ends[0].lerp(ends[1], t)) for t in numpy.linspace(0, 1, 30)]


stepper.run(steps)
