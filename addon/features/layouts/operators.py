# SPDX-License-Identifier: GPL-3.0-or-later
"""Layouts of a whole mesh object: drawn, checked, remeshed from."""

import bpy
import mathutils
from bpy.props import IntProperty

from ... import compat
from ...bridge import arrays, density, meshes, objects, strokes, transfer, view
from ...core import plans
from ...core.native import native
from ...core.tasks import Chain, Task
from ...jobs import NativeJobOperator
from ..remesh.job import RemeshJobOperator, remesh_task, source_task
from ..remesh.properties import CUBES, core_settings
from ..topology import properties as topology_properties
from . import drawing, problems, properties


class _OnSurface:
    """Mix-in of operators that work on the mesh object that the active object stands for."""

    @classmethod
    def poll(cls, context):
        if properties.surface_of(objects.active(context), context.scene) is None:
            cls.poll_message_set("Make a mesh object, or its layout, the active object")
            return False
        return True


class _OnLayout(_OnSurface):
    """Mix-in of operators that use a layout that was drawn."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if objects.active(context).type == "MESH" and context.mode != "OBJECT":
            cls.poll_message_set("Works in Object Mode, and in the modes of Grease Pencil")
            return False
        if properties.drawn_on(properties.surface_of(objects.active(context), context.scene), context) is None:
            cls.poll_message_set("The object has no layout; Draw Layout makes one")
            return False
        return True


class HYBRID_MESH_OT_draw_layout(_OnSurface, bpy.types.Operator):
    """Draw a patch layout on the mesh with Grease Pencil. The mesh stays as it is"""

    bl_idname = "hybrid_mesh.draw_layout"
    bl_label = "Draw Layout"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        surface = properties.surface_of(objects.active(context), context.scene)
        context.view_layer.update()
        try:
            arrays.world_matrix(surface.matrix_world)
        except arrays.MatrixError as error:
            self.report({"ERROR"}, f"{surface.name}: {error}")
            return {"CANCELLED"}
        try:
            layout = drawing.drawn_layout(context, surface)
        except drawing.LayoutInputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        view.to_object_mode(context)
        view.select_only(context, layout)
        compat.draw_on_surfaces(context.scene.tool_settings, layout.data)
        bpy.ops.object.mode_set(mode=strokes.draw_mode(layout))
        if not surface.visible_get():
            self.report({"WARNING"}, f"{surface.name} is hidden: strokes will not lie on it")
        return {"FINISHED"}


class HYBRID_MESH_OT_check_layout(_OnLayout, NativeJobOperator):
    """Make curves on the surface of the strokes drawn, and show them and whatever keeps them from being a patch layout"""

    bl_idname = "hybrid_mesh.check_layout"
    bl_label = "Check Layout"
    bl_options = {"REGISTER", "UNDO"}

    def prepare(self, context):
        source, drawn = _read(context)
        return [Task(source.key[0], lambda: _start(source, drawn), (source, drawn))]

    def finish(self, context, results):
        ((task, result),) = results
        if not problems.show_check(self, context, *task.note, result):
            raise ValueError(f"{task.name}: the object or its layout is gone from the scene; nothing is shown")


class HYBRID_MESH_OT_show_problem(_OnLayout, bpy.types.Operator):
    """Look at a problem of the layout, and select the stroke that is wrong"""

    bl_idname = "hybrid_mesh.show_problem"
    bl_label = "Show Problem"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    index: IntProperty(name="Problem", min=0)

    def execute(self, context):
        surface = properties.surface_of(objects.active(context), context.scene)
        layout = properties.drawn_on(surface, context)
        found = layout.hybrid_mesh_layout.problems
        if self.index >= len(found):
            self.report({"ERROR"}, f"The layout has {problems.counted(len(found), 'problems')}; there is no number {self.index}")
            return {"CANCELLED"}
        problem = found[self.index]
        layout.hybrid_mesh_layout.problem_index = self.index
        if problem.number >= 0 and not strokes.select(layout, context.scene.frame_current, problem.layer, problem.number):
            self.report({"WARNING"}, "The stroke is gone; check the layout again")
        if problem.size > 0:
            view.look_at(context, surface, layout.matrix_world @ mathutils.Vector(problem.place), problem.size)
        return {"FINISHED"}


class HYBRID_MESH_OT_remesh_layout(_OnLayout, RemeshJobOperator):
    """Remesh with the layout drawn as base domain, with the scene's remesh settings. The source stays as it is"""

    bl_idname = "hybrid_mesh.remesh_layout"
    bl_label = "Remesh from Layout"
    bl_options = {"REGISTER", "UNDO"}

    _drawn = None  # drawing.Drawn

    def prepare(self, context):
        settings = core_settings(context.scene.hybrid_mesh)
        source, drawn = _read(context, transfer.collect, density.reader(settings.density))
        self._drawn = drawn

        def remesh(result):
            if result["problems"]:
                raise problems.LayoutProblemsError(result)
            return source_task(source.key[0], source, settings, result["plan"]).start()

        return [Task(source.key[0], lambda: Chain(_start(source, drawn), remesh), (source, settings))]

    def finish(self, context, results):
        view.to_object_mode(context)
        super().finish(context, results)
        surface = objects.find(context.scene, results[0][0].note[0].key)
        layout = objects.find(context.scene, self._drawn.layout)
        if layout is not None:
            drawing.forget_problems(context, surface, layout)
        topology_properties.say_unused(self, surface)
        if self.hides_source(context):
            drawing.hide(context, surface)

    def failed(self, context, task, error):
        source = task.note[0]
        if not isinstance(error, problems.LayoutProblemsError):
            problems.show_failure(context, source.key, self._drawn, error)
        elif problems.show_check(self, context, source, self._drawn, error.result):
            problems.push_marks()

    def hides_source(self, context):
        return context.scene.hybrid_mesh.hide_source


class HYBRID_MESH_OT_remesh_boundary(_OnSurface, RemeshJobOperator):
    """Remesh a surface with one boundary loop from a base domain of cubes that stand on it, each on the one before. In Edit Mode, four selected vertices of the boundary are the first one's corners; else they are found"""

    bl_idname = "hybrid_mesh.remesh_boundary"
    bl_label = "Remesh from Boundary"
    bl_options = {"REGISTER", "UNDO"}

    cubes: CUBES

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if context.mode != "OBJECT" and not (context.mode == "EDIT_MESH" and objects.active(context).type == "MESH"):
            cls.poll_message_set("Works in Object Mode and in Edit Mode")
            return False
        return True

    def draw(self, context):
        self.layout.prop(self, "cubes")

    def prepare(self, context):
        surface = properties.surface_of(objects.active(context), context.scene)
        nodes = None
        if surface.mode == "EDIT":
            nodes = _boundary_nodes(surface)
            surface.update_from_editmode()
        settings = core_settings(context.scene.hybrid_mesh)
        with objects.evaluated(context, surface) as graph:
            return [remesh_task(surface, graph, settings, plans.boundary_plan(nodes, self.cubes))]

    def finish(self, context, results):
        view.to_object_mode(context)
        super().finish(context, results)
        topology_properties.say_unused(self, objects.find(context.scene, results[0][0].note[0].key))

    def hides_source(self, context):
        return context.scene.hybrid_mesh.hide_source


def _read(context, collect=None, densities=None):
    """The meshes.Source and the drawing.Drawn of the mesh object that the active object stands for; raises ValueError. collect, densities: as in meshes.read_source()."""
    surface = properties.surface_of(objects.active(context), context.scene)
    try:
        with objects.evaluated(context, surface) as graph:
            return meshes.read_source(surface, graph, collect, densities), drawing.read_drawn(context, surface)
    except ValueError as error:
        raise ValueError(f"{surface.name}: {error}") from error


def _start(source, drawn):
    """A native job that makes a layout, and a plan of it where it has no problems."""
    return native().start_layout_plan(*_triangles(source), drawn.for_native(), drawn.snap)


def _triangles(source):
    return source.mesh.points, source.mesh.indices.reshape(-1, 3)


def _boundary_nodes(surface):
    """The four points that are selected on the boundary of a mesh in Edit Mode, or None where nothing is; raises ValueError."""
    points, on_boundary = meshes.selected_vertices(surface)
    if not len(points):
        return None
    if len(points) != 4:
        raise ValueError(f"{surface.name}: {len(points)} {'vertex is' if len(points) == 1 else 'vertices are'} selected; select four of the boundary, or none")
    if not on_boundary.all():
        raise ValueError(f"{surface.name}: {4 - int(on_boundary.sum())} of the four selected vertices {'is' if on_boundary.sum() == 3 else 'are'} not on the boundary")
    return points
