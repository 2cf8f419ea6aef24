# SPDX-License-Identifier: GPL-3.0-or-later
"""Loops of a mesh object: found, drawn, removed."""

import bpy

from ...bridge import meshes, objects, strokes
from ...core import loops as lines
from ...core.native import native
from ...core.tasks import Task
from ...jobs import NativeJobOperator
from ..layouts import drawing
from . import display, properties


class _OnSurface:
    """Mix-in of operators that work on the mesh object that the active object stands for."""

    @classmethod
    def poll(cls, context):
        surface = properties.surface_of(objects.active(context), context.scene)
        if surface is None:
            cls.poll_message_set("Make a mesh object that is no level of a hierarchy the active object")
            return False
        if surface.mode != "OBJECT":
            cls.poll_message_set("Works in Object Mode, and in the modes of Grease Pencil")
            return False
        return True


class _OnLoops(_OnSurface):
    """Mix-in of operators that need loops."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not len(properties.loops_of(properties.surface_of(objects.active(context), context.scene))):
            cls.poll_message_set("The object has no loops; Find Loops finds them")
            return False
        return True


class _LoopJobOperator(_OnSurface, NativeJobOperator):
    """Base of operators that make the list of loops anew."""

    _settings = ()  # (level, use) of each loop that there was

    def task(self, context, surface, chosen, drawn, **options):
        """A task that makes the list of the `chosen` loops, of drawn strokes, and of those that are missing, as far as the native search's options let it look for any."""
        properties.refuse_foreign(surface)
        try:
            with objects.evaluated(context, surface) as graph:
                source = meshes.read_source(surface, graph)
            kept = [{"points": points, "drawn": loop.drawn} for loop, points in zip(chosen, properties.world_lines(chosen, source), strict=True)]
        except ValueError as error:
            raise ValueError(f"{surface.name}: {error}") from error
        self._settings = [(loop.level, loop.use) for loop in chosen]
        return Task(surface.name, lambda: native().start_find_loops(*source.mesh, kept, drawn, **options), source)

    def finish(self, context, results):
        ((task, found),) = results
        surface = objects.find(context.scene, task.note.key)
        if surface is None:
            raise ValueError(f"{task.name}: the object is gone from the scene; its loops are not kept")
        properties.write(surface, task.note, found, self._settings)
        display.show(context, surface)
        kinds = [loop["kind"] for loop in found]
        words = [_counted(kinds.count(kind), kind) for kind in ("handle", "tunnel") if kind in kinds]
        self.report({"INFO"}, f"{surface.name}: loops around {' and '.join(words)}" if kinds else f"{surface.name} has no handles and no tunnels")


class HYBRID_MESH_OT_find_loops(_LoopJobOperator):
    """Find short loops around the handles and tunnels of the mesh. Loops that are drawn stay, others are made anew"""

    bl_idname = "hybrid_mesh.find_loops"
    bl_label = "Find Loops"
    bl_options = {"REGISTER", "UNDO"}

    def prepare(self, context):
        surface = properties.surface_of(objects.active(context), context.scene)
        return [self.task(context, surface, [loop for loop in properties.loops_of(surface) if loop.drawn], [])]


class HYBRID_MESH_OT_draw_loop(_LoopJobOperator):
    """Make loops of the closed strokes that are drawn on the mesh, or of several that go on where another one ends. Each becomes the shortest loop around what it goes around, and found ones in its way give place"""

    bl_idname = "hybrid_mesh.draw_loop"
    bl_label = "Draw Loop"
    bl_options = {"REGISTER", "UNDO"}

    _layout = None  # objects.key_of() it
    _used = ()  # (layer, number) of the strokes

    def prepare(self, context):
        surface = properties.surface_of(objects.active(context), context.scene)
        drawn = drawing.read_drawn(context, surface)
        gap = drawn.snap * objects.diagonal(surface)
        closed = lines.closed_lines([stroke.points for stroke in drawn.strokes], gap)
        if not closed:
            raise ValueError(f"Nothing in {drawn.layout[0]} is closed: a loop ends where it begins, or where another stroke goes on")
        self._layout = drawn.layout
        self._used = [(drawn.strokes[number].layer, drawn.strokes[number].number) for _, numbers in closed for number in numbers]
        return [self.task(context, surface, list(properties.loops_of(surface)), [points for points, _ in closed], longest=0)]

    def finish(self, context, results):
        super().finish(context, results)
        surface = objects.find(context.scene, results[0][0].note.key)
        made = [number for number, loop in enumerate(results[0][1]) if loop["source"] < 0]
        surface.hybrid_mesh_topology.index = made[-1]
        layout = objects.find(context.scene, self._layout)
        # As loops they go on; as strokes they would be sides of quads.
        if layout is not None and objects.is_local(layout) and objects.is_local(layout.data):
            strokes.remove(layout, context.scene.frame_current, self._used)


class HYBRID_MESH_OT_remove_loop(_OnLoops, bpy.types.Operator):
    """Remove the loop from the list: what it goes around is then in the base"""

    bl_idname = "hybrid_mesh.remove_loop"
    bl_label = "Remove Loop"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        return _change(self, context, lambda values: values.loops.remove(min(values.index, len(values.loops) - 1)))


class HYBRID_MESH_OT_clear_loops(_OnLoops, bpy.types.Operator):
    """Remove all loops: a remesh looks for them by itself again, where its settings say so"""

    bl_idname = "hybrid_mesh.clear_loops"
    bl_label = "Clear"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        return _change(self, context, lambda values: values.loops.clear())


def _change(operator, context, change):
    surface = properties.surface_of(objects.active(context), context.scene)
    try:
        properties.refuse_foreign(surface)
    except ValueError as error:
        operator.report({"ERROR"}, str(error))
        return {"CANCELLED"}
    values = surface.hybrid_mesh_topology
    change(values)
    values.index = min(values.index, max(len(values.loops) - 1, 0))
    display.show(context, surface)
    return {"FINISHED"}


def _counted(number, thing):
    return f"{number} {thing}{'' if number == 1 else 's'}"
