# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar panels draw, before and after a remesh, with a poor result, for a region of a level, an edited level, a mesh made of one, and with a list of loops; the preview's level changes what the view shows."""

import json
import os
import sys

import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs, registration  # noqa: E402
from hybrid_mesh.bridge import levels  # noqa: E402
from hybrid_mesh.features.layouts import panel as layout_panel  # noqa: E402
from hybrid_mesh.features.remesh import panel as remesh_panel  # noqa: E402
from hybrid_mesh.features.topology import panel as topology_panel  # noqa: E402


def steps():
    view = stepper.view()
    # The tab that is open at first, since no script can choose another in this version.
    panels = [cls for cls in registration.CLASSES if issubclass(cls, bpy.types.Panel)]
    for cls in reversed(panels):
        bpy.utils.unregister_class(cls)
    for cls in panels:
        cls.bl_category = "Item"
        cls.bl_order = getattr(cls, "bl_order", 0) - 10
        bpy.utils.register_class(cls)
    view["space_data"].show_region_ui = True
    bpy.context.preferences.view.ui_scale = 0.8
    stepper.empty_scene()
    with bpy.context.temp_override(**view):
        stepper.large_sphere(40)
    yield 0.5
    stepper.screenshot("panel_before")
    bpy.context.scene.hybrid_mesh.vertices = 3000
    with bpy.context.temp_override(**stepper.view()):
        settings = bpy.context.scene.hybrid_mesh
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=settings.vertices, hide_source=settings.hide_source) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.5
    preview = bpy.data.objects["sphere.preview"]
    shading = stepper.view()["space_data"].shading
    shading.type, shading.color_type = "SOLID", "VERTEX"
    stepper.view()["space_data"].overlay.show_wireframes = True
    for level in (len(levels_of(preview)) - 1, 1, 0):
        levels.set_level(preview, level)
        assert levels.level_of(preview) == level
        yield 2  # for a software renderer to draw it
        stepper.screenshot(f"panel_level{level}")
    # A result that is poor at a corner of the object's box.
    collection, place = preview.hybrid_mesh.hierarchy, Vector(preview.bound_box[6])
    report = json.loads(collection.hybrid_mesh.report)
    reasons = [{"what": "hausdorff", "text": "the mesh is up to 1.94e-01 of the diagonal away from the surface", "where": list(preview.matrix_world @ place)}]
    collection.hybrid_mesh.report = json.dumps({**report, "verdict": {"result": "poor", "reasons": reasons}})
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.show_reason("INVOKE_DEFAULT", True, index=0) == {"FINISHED"}
    place, shown = Vector(reasons[0]["where"]), stepper.view()["space_data"].region_3d
    assert (bpy.context.scene.cursor.location - place).length < 1e-3 and (shown.view_location - place).length < 1e-3
    assert shown.view_distance < max(preview.dimensions)
    yield 2
    stepper.screenshot("panel_poor")
    level = levels_of(preview)[1]
    level.hide_set(False)
    bpy.context.view_layer.objects.active = level
    # Edited, and the other levels follow.
    bpy.utils.unregister_class(remesh_panel.HYBRID_MESH_PT_advanced)
    bpy.utils.unregister_class(remesh_panel.HYBRID_MESH_PT_remesh)
    height = preview.dimensions.z
    for vertex in level.data.vertices:
        vertex.co.z *= 2
    levels.set_level(preview, 3)
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.update_levels("INVOKE_DEFAULT", True) == {"FINISHED"}
        bpy.ops.view3d.view_selected()
    yield 2
    stepper.screenshot("panel_edited")
    assert abs(preview.dimensions.z / height - 2) < 0.2
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.ed.undo()
    yield 0.5
    preview = bpy.data.objects["sphere.preview"]
    assert abs(preview.dimensions.z / height - 1) < 0.2
    # An ordinary mesh that was made of it.
    with bpy.context.temp_override(**stepper.view()):
        bpy.context.view_layer.objects.active = preview
        preview.select_set(True)
        assert bpy.ops.hybrid_mesh.make_mesh("INVOKE_DEFAULT", True) == {"FINISHED"}
    yield 1
    stepper.screenshot("panel_made")
    bpy.data.objects.remove(bpy.context.object)
    for cls in (remesh_panel.HYBRID_MESH_PT_remesh, remesh_panel.HYBRID_MESH_PT_advanced):
        bpy.utils.register_class(cls)
    # Alone, so that it is not below the window's edge.
    for cls in reversed(panels):
        bpy.utils.unregister_class(cls)
    bpy.utils.register_class(layout_panel.HYBRID_MESH_PT_layout)
    for kind in ("DRAWN", "AUTOMATIC", "CUBES", "ROWS", "EVEN", "COPY"):
        bpy.context.scene.hybrid_mesh_region.layout_kind = kind
        stepper.view()["area"].tag_redraw()
        yield 1
        stepper.screenshot(f"panel_region_{kind.lower()}")
    # A torus, and the list of its loops.
    bpy.utils.unregister_class(layout_panel.HYBRID_MESH_PT_layout)
    bpy.utils.register_class(topology_panel.HYBRID_MESH_PT_topology)
    stepper.empty_scene()
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.mesh.primitive_torus_add()
        assert bpy.ops.hybrid_mesh.find_loops("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    bpy.context.object.hybrid_mesh_topology.loops[0].level = 2
    stepper.view()["space_data"].shading.color_type = "MATERIAL"
    stepper.view()["space_data"].overlay.show_wireframes = False
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.view3d.view_selected()
    yield 2
    stepper.screenshot("panel_topology")
    for cls in panels:
        if not hasattr(bpy.types, cls.__name__):
            bpy.utils.register_class(cls)
    bpy.context.scene.hybrid_mesh.refinement = "ADAPTIVE"
    bpy.context.scene.hybrid_mesh.base = "GIVEN"
    bpy.context.scene.hybrid_mesh.features = "ANGLE"
    yield 0.5


def levels_of(preview):
    return [obj for obj in preview.hybrid_mesh.hierarchy.objects if obj.hybrid_mesh.role == "LEVEL"]


stepper.run(steps)
