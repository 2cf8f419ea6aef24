# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke sculpted by mouse on level 2 of a Multires object moves its surface, and is there in the reopened file."""

import os
import subprocess
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh.bridge import meshes  # noqa: E402

REOPEN = """
import bpy, numpy
mesh = bpy.data.objects[{!r}].evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
points = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
mesh.vertices.foreach_get("co", points)
numpy.save({!r}, points.reshape(-1, 3))
"""


def shape(obj):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = meshes.values_of(evaluated.to_mesh().vertices, "co", 3).copy()
    evaluated.to_mesh_clear()
    return points


def steps():
    stepper.empty_scene()
    with bpy.context.temp_override(**stepper.view()):
        scan = stepper.large_sphere(24)
        assert bpy.ops.hybrid_mesh.remesh(vertices=4000) == {"FINISHED"}
        assert bpy.ops.hybrid_mesh.convert_to_multires() == {"FINISHED"}
        obj, preview = bpy.data.objects["sphere_multires"], bpy.data.objects["sphere.preview"]
        scan.hide_set(True)
        preview.hide_set(True)
        assert bpy.context.object == obj and obj.modifiers[0].total_levels > 2
        before, coarse = shape(obj), meshes.values_of(obj.data.vertices, "co", 3)
        bpy.ops.view3d.view_selected()
        obj.modifiers[0].sculpt_levels = 2
        bpy.ops.object.mode_set(mode="SCULPT")
    yield 2
    view = stepper.view()
    x, y = view["region"].x + view["region"].width // 2, view["region"].y + view["region"].height // 2
    yield from stepper.draw([(x + 4 * i - 40, y) for i in range(20)])
    stepper.screenshot("sculpt_stroke")
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.object.mode_set(mode="OBJECT")
    obj.modifiers[0].levels = obj.modifiers[0].total_levels
    yield 0.5
    after = shape(obj)
    moved = numpy.abs(after - before).max(axis=1)
    print(f"the stroke has moved {(moved > 1e-4).sum()} of {len(moved)} vertices by at most {moved.max():.3f}")
    assert after.shape == before.shape and moved.max() > 1e-3 and 0.002 < (moved > 1e-4).mean() < 0.5
    folder = tempfile.mkdtemp()
    path = os.path.join(folder, "sculpted.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    # Timers end with their file: another Blender opens it.
    points = os.path.join(folder, "points.npy")
    subprocess.run([bpy.app.binary_path, "--background", "--factory-startup", path, "--python-exit-code", "1", "--python-expr", REOPEN.format(obj.name, points)], check=True)
    assert numpy.array_equal(numpy.load(points), after)
    assert numpy.array_equal(meshes.values_of(obj.data.vertices, "co", 3), coarse)


stepper.run(steps)
