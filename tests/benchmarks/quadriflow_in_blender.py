# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs Blender's own QuadriFlow on one mesh:
blender --background --factory-startup --python quadriflow_in_blender.py -- IN.npz OUT.npz FACES

IN and OUT hold points, offsets and indices; OUT also the seconds that the operator took, and `changed`, because the operator ends as
FINISHED even where it has left the mesh alone. If IN's sharp_angle is a number of degrees, the edges at which the surface turns by more are marked as
sharp, and sharp edges and boundaries are to be preserved. QuadriFlow does not look at the marks: sharp to it is what turns by more than 60 degrees."""

import sys
import time

import bpy
import numpy as np


def mark_sharp(item, angle):
    """All edges at which the surface turns by more than an angle in radians."""
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.mesh.edges_select_sharp(sharpness=angle)
    bpy.ops.mesh.mark_sharp()
    bpy.ops.object.mode_set(mode="OBJECT")


def main(source, target, faces):
    data = np.load(source)
    points, offsets, indices = data["points"], data["offsets"], data["indices"]
    # Blender calls a mesh with edges shorter than 0.0001 not manifold, whatever its size.
    following = np.arange(1, len(indices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    shortest = np.linalg.norm(points[indices] - points[indices[following]], axis=1).min()
    scale = max(1.0, 2e-4 / shortest) if shortest > 0 else 1.0
    mesh = bpy.data.meshes.new("input")
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", (points * scale).astype(np.float32).ravel())
    mesh.loops.add(len(indices))
    mesh.loops.foreach_set("vertex_index", indices.astype(np.int32))
    mesh.polygons.add(len(offsets) - 1)
    mesh.polygons.foreach_set("loop_start", offsets[:-1].astype(np.int32))
    mesh.polygons.foreach_set("loop_total", np.diff(offsets).astype(np.int32))
    mesh.update(calc_edges=True)
    mesh.validate()
    item = bpy.data.objects.new("input", mesh)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    angle = float(data["sharp_angle"])
    sharp = not np.isnan(angle)
    if sharp:
        mark_sharp(item, np.radians(angle))
    boundary = sharp or bool(data["has_boundary"])
    before = (len(mesh.vertices), len(mesh.polygons))
    start, cpu_start = time.perf_counter(), time.process_time()
    status = bpy.ops.object.quadriflow_remesh(
        use_mesh_symmetry=False, use_preserve_sharp=sharp, use_preserve_boundary=boundary, mode="FACES", target_faces=faces, seed=0
    )
    seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu_start
    mesh = item.data
    changed = "FINISHED" in status and before != (len(mesh.vertices), len(mesh.polygons))
    result = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", result)
    totals = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", totals)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    np.savez(
        target,
        points=result.reshape(-1, 3).astype(np.float64) / scale,
        offsets=np.concatenate([[0], np.cumsum(totals, dtype=np.int64)]),
        indices=corners,
        seconds=seconds,
        cpu_seconds=cpu_seconds,
        changed=changed,
    )


arguments = sys.argv[sys.argv.index("--") + 1 :]
main(arguments[0], arguments[1], int(arguments[2]))
