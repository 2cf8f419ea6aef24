# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import mathutils
import numpy
from bpy.props import EnumProperty, IntProperty

from ... import compat
from ...bridge import arrays, meshes, objects, strokes, transfer
from ...core import plans, regions
from ...core import settings as core
from ...core.native import native
from ...core.tasks import Chain, Task
from ...jobs import NativeJobOperator
from ..levels import properties as hierarchy_properties
from ..remesh.job import RemeshJobOperator, remesh_task, source_task
from ..remesh.properties import CUBES, core_settings
from . import drawing, properties


class LayoutProblemsError(ValueError):
    """A drawn layout that cannot be remeshed. result: what the native module made of it."""

    def __init__(self, result):
        problems = result["problems"]
        super().__init__(f"The layout has {_count(len(problems), 'problems')}, marked in red and listed in the panel Patch Layout: {problems[0]['message']}")
        self.result = result


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
        _to_object_mode(context)
        _select_only(context, layout)
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
        if not _show_check(self, context, *task.note, result):
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
            self.report({"ERROR"}, f"The layout has {_count(len(found), 'problems')}; there is no number {self.index}")
            return {"CANCELLED"}
        problem = found[self.index]
        layout.hybrid_mesh_layout.problem_index = self.index
        if problem.number >= 0 and not strokes.select(layout, context.scene.frame_current, problem.layer, problem.number):
            self.report({"WARNING"}, "The stroke is gone; check the layout again")
        if problem.size > 0:
            _look_at(context, surface, layout.matrix_world @ mathutils.Vector(problem.place), problem.size)
        return {"FINISHED"}


class HYBRID_MESH_OT_remesh_layout(_OnLayout, RemeshJobOperator):
    """Remesh with the layout drawn as base domain, with the scene's remesh settings. The source stays as it is"""

    bl_idname = "hybrid_mesh.remesh_layout"
    bl_label = "Remesh from Layout"
    bl_options = {"REGISTER", "UNDO"}

    _drawn = None  # drawing.Drawn

    def prepare(self, context):
        settings = core_settings(context.scene.hybrid_mesh)
        source, drawn = _read(context, transfer.collect)
        self._drawn = drawn

        def remesh(result):
            if result["problems"]:
                raise LayoutProblemsError(result)
            return source_task(source.key[0], source, settings, result["plan"]).start()

        return [Task(source.key[0], lambda: Chain(_start(source, drawn), remesh), (source, settings))]

    def finish(self, context, results):
        _to_object_mode(context)
        super().finish(context, results)
        surface = objects.find(context.scene, results[0][0].note[0].key)
        layout = objects.find(context.scene, self._drawn.layout)
        if layout is not None:
            drawing.forget_problems(context, surface, layout)
        if self.hides_source(context):
            drawing.hide(context, surface)

    def failed(self, context, task, error):
        source = task.note[0]
        if not isinstance(error, LayoutProblemsError):
            _show_failure(context, source.key, self._drawn, error)
        elif _show_check(self, context, source, self._drawn, error.result):
            _push_marks()

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
        _to_object_mode(context)
        super().finish(context, results)

    def hides_source(self, context):
        return context.scene.hybrid_mesh.hide_source


_sources = []  # Blender keeps no reference to the texts of items that a function returns.


def _source_items(operator, context):
    """The operations of the active object's hierarchy whose layout can be copied."""
    surface = properties.surface_of(objects.active(context), context.scene) if context is not None else None
    hierarchy = hierarchy_properties.hierarchy_of(surface if properties.is_level(surface) else objects.active(context)) if context is not None else None
    found = hierarchy_properties.operations_of(hierarchy) if hierarchy is not None else []
    choices = [(number, one) for number, one in enumerate(found) if one["corners"]]
    _sources[:] = [
        (str(number), f"Level {one['level']}: {len(one['quads'])} quads to {len(one['new_quads'])}, {one['corners']} sides", "Copy the layout of this operation", place)
        for place, (number, one) in enumerate(choices)
    ] or [("NONE", "None", "The hierarchy has no operation whose layout can be copied", 0)]
    return _sources


class HYBRID_MESH_OT_repatch_region(properties.RegionProperties, RemeshJobOperator):
    """Lay out the selected faces of a level anew, along curves drawn over them or by a rule: the source is remeshed with one more operation"""

    bl_idname = "hybrid_mesh.repatch_region"
    bl_label = "Repatch Region"
    bl_options = {"REGISTER", "UNDO"}

    source: EnumProperty(name="Operation", description="The operation whose layout is copied", items=_source_items)

    _level = _hierarchy = None  # objects.key_of() them
    _drawn = None  # drawing.Drawn, if curves were drawn

    @classmethod
    def poll(cls, context):
        if not properties.is_level(properties.surface_of(objects.active(context), context.scene)):
            cls.poll_message_set("Make a level of a hierarchy, or the layout drawn on it, the active object")
            return False
        return True

    def draw(self, context):
        properties.draw_region(self.layout, self)
        if self.layout_kind == "COPY":
            self.layout.prop(self, "source")

    def prepare(self, context):
        self._drawn = None
        level = properties.surface_of(objects.active(context), context.scene)
        hierarchy = level.hybrid_mesh.hierarchy
        source = hierarchy.hybrid_mesh.source
        if source is None or not objects.in_scene(source, context.scene):
            raise ValueError(f"{hierarchy.name}: the object that it was made of is gone from the scene")
        plan = hierarchy_properties.plan_of(hierarchy)
        if not plan:
            raise ValueError(f"{hierarchy.name} has no plan; remesh {source.name} again")
        addresses = _selected_quads(level, hierarchy)
        operation = plans.repatch_operation(_level_number(level), addresses, self._new_layout(context, level, hierarchy), self.buffer_rings)
        self._level, self._hierarchy = objects.key_of(level), objects.key_of(hierarchy)
        with objects.evaluated(context, source) as graph:
            return [remesh_task(source, graph, _settings_of(hierarchy, context.scene), plans.with_operation(plan, operation))]

    def _new_layout(self, context, level, hierarchy):
        if self.layout_kind == "AUTOMATIC":
            return plans.automatic_layout()
        if self.layout_kind == "CUBES":
            return plans.cubes_layout(self.height)
        if self.layout_kind == "COPY":
            return _copied_layout(level, hierarchy, self.source, self.turn)
        self._drawn = drawn = drawing.read_drawn(context, level)
        for stroke in drawn.strokes:
            if not numpy.isfinite(stroke.points).all():
                raise ValueError(f"{drawn.layout[0]}: {_named('a stroke has points that are not finite', stroke)}")
        return plans.drawn_layout([(stroke.points, fit) for stroke, fit in zip(drawn.strokes, drawn.fits, strict=True)])

    def finish(self, context, results):
        _to_object_mode(context)
        super().finish(context, results)
        level = objects.find(context.scene, self._level)
        if level is not None:
            layout = objects.find(context.scene, self._drawn.layout) if self._drawn is not None else properties.layout_of(level, context.scene)
            if layout is not None:
                drawing.forget_problems(context, level, layout)
            drawing.hide(context, level)
        hierarchy = bpy.data.collections.get(self._hierarchy)
        if hierarchy is None:
            return
        for obj in hierarchy.objects:
            # What was made before would cover what is new.
            if objects.in_view_layer(obj, context.view_layer):
                obj.hide_set(True)
        _, settings = results[0][0].note
        lost = _finest(hierarchy) - _finest(objects.active(context).hybrid_mesh.hierarchy)
        if lost > 0 and settings.vertices:
            self.report({"WARNING"}, f"With the new quads the bound of {settings.vertices:,} vertices leaves {'one level' if lost == 1 else f'{lost} levels'} less")

    def failed(self, context, task, error):
        _show_failure(context, self._level, self._drawn, error)

    def hides_source(self, context):
        return False


def _read(context, collect=None):
    """The meshes.Source and the drawing.Drawn of the mesh object that the active object stands for; raises ValueError. collect: as in meshes.read_source()."""
    surface = properties.surface_of(objects.active(context), context.scene)
    try:
        with objects.evaluated(context, surface) as graph:
            return meshes.read_source(surface, graph, collect), drawing.read_drawn(context, surface)
    except ValueError as error:
        raise ValueError(f"{surface.name}: {error}") from error


def _start(source, drawn):
    """A native job that makes a layout, and a plan of it where it has no problems."""
    return native().start_layout_plan(*_triangles(source), drawn.for_native(), drawn.snap)


def _triangles(source):
    return source.mesh.points, source.mesh.indices.reshape(-1, 3)


def _diagonal(points):
    return float(numpy.linalg.norm(numpy.ptp(points, axis=0)))


def _count(number, things):
    return f"{number} {things.removesuffix('s') if number == 1 else things}"


def _show_check(operator, context, source, drawn, result):
    """Shows what was made of what is drawn, and says it; returns whether there is still something to show it with."""
    surface, layout = objects.find(context.scene, source.key), objects.find(context.scene, drawn.layout)
    if surface is None or layout is None:
        return False
    size = _diagonal(source.mesh.points)
    drawing.show_curves(context, surface, result, size)
    drawing.show_problems(context, surface, layout, drawn.strokes, result["problems"], size)
    count = ", ".join(_count(len(result[things]), things) for things in ("nodes", "curves", "faces"))
    layout.hybrid_mesh_layout.summary = count
    for problem in result["problems"]:
        number = problem["stroke"]
        operator.report({"WARNING"}, _named(problem["message"], drawn.strokes[number]) if 0 <= number < len(drawn.strokes) else problem["message"])
    if not result["problems"]:
        operator.report({"INFO"}, f"{surface.name}: {count}; nothing is wrong")
    return True


def _named(words, stroke):
    return f"{words} (stroke {stroke.number + 1} of {stroke.layer})"


def _show_failure(context, key, drawn, error):
    """Marks what the native module says of the curves of a region. key: of the object that they are drawn on."""
    surface = objects.find(context.scene, key)
    layout = objects.find(context.scene, drawn.layout) if drawn is not None else None
    if surface is None or layout is None or type(error).__name__ != "LayoutError" or len(error.args) < 2:
        return
    points = numpy.array([surface.matrix_world @ mathutils.Vector(corner) for corner in surface.bound_box])
    drawing.show_problems(context, surface, layout, drawn.strokes, error.args[1], _diagonal(points))
    _push_marks()


def _push_marks():
    """An operator that is cancelled makes no undo step; what it has marked is one of its own."""
    bpy.ops.ed.undo_push(message="Mark Layout Problems")


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


def _selected_quads(level, hierarchy):
    """Addresses of the faces that are selected in a level object; raises ValueError where they cannot be had."""
    root, path = _addresses(level)
    if root is None:
        raise ValueError(f"{level.name} does not know its quads; remesh the source again")
    chosen = meshes.selected_faces(level)
    made_by_hand = int((path[chosen] < 1).sum())
    if made_by_hand:
        raise ValueError(f"{made_by_hand} of the selected faces of {level.name} were not made by a remesh; deselect them")
    _refuse_replaced(level, hierarchy, list(zip(root[chosen].tolist(), path[chosen].tolist())))
    known = []
    for obj in _levels(hierarchy):
        roots, paths = _addresses(obj)
        if roots is not None:
            known.append((_level_number(obj), roots[paths == 1].tolist(), paths[paths == 1].tolist()))
    return plans.quad_addresses(_level_number(level), root[chosen].tolist(), path[chosen].tolist(), plans.root_levels(known))


def _refuse_replaced(level, hierarchy, quads):
    """Raises ValueError where quads (root, path) of a level before its operations are not there after them."""
    name = f"N{_level_number(level)}"
    after = next((obj for obj in _levels(hierarchy) if obj.hybrid_mesh.level == name), None)
    root, path = _addresses(after) if after is not None and after != level else (None, None)
    if root is None:
        return
    there = set(zip(root.tolist(), path.tolist()))
    replaced = sum(quad not in there for quad in quads)
    if replaced:
        raise ValueError(f"{replaced} of the selected faces of {level.name} {'has' if replaced == 1 else 'have'} been laid out anew already; select faces of {after.name}")


def _finest(hierarchy):
    return max(map(_level_number, _levels(hierarchy)), default=0)


def _levels(hierarchy):
    """The level objects of a hierarchy that are in its collection."""
    return [obj for obj in hierarchy.objects if properties.is_level(obj) and obj.hybrid_mesh.hierarchy == hierarchy]


def _copied_layout(level, hierarchy, source, turn):
    """The layout of an operation, to be put onto the selected faces; raises ValueError where it does not fit them."""
    found = hierarchy_properties.operations_of(hierarchy)
    if not source.isdigit() or int(source) >= len(found) or not found[int(source)]["corners"]:
        raise ValueError(f"{hierarchy.name} has no operation whose layout can be copied; lay out a region in another way first")
    operation = found[int(source)]
    chosen = meshes.selected_faces(level)
    quads = meshes.quad_corners(level, chosen)
    if quads is None:
        raise ValueError(f"the selected faces of {level.name} are not all quads, or its UV map {meshes.PATCH_UV} is gone")
    quad, side = regions.copy_start(quads, _removed_counts(hierarchy, operation), turn)
    root, path = (values[chosen] for values in _addresses(level))
    return plans.template_layout(plans.address(root[quad], path[quad]), side, operation["new_quads"])


def _removed_counts(hierarchy, operation):
    """regions.corner_counts() of the quads that an operation replaced, from its layout's corner 0 on; all 0 where the level that had them is gone."""
    unknown = [0] * operation["corners"]
    name = f"M{operation['level']}"
    before = next((obj for obj in _levels(hierarchy) if obj.hybrid_mesh.level == name and obj.mode == "OBJECT"), None)
    root, path = _addresses(before) if before is not None else (None, None)
    if root is None:
        return unknown
    wanted = set(operation["quads"])
    removed = [number > 0 and plans.address(of, number) in wanted for of, number in zip(root.tolist(), path.tolist())]
    quads = meshes.quad_corners(before, removed)
    if quads is None or len(quads) != len(operation["quads"]):
        return unknown
    addresses = [plans.address(root[face], path[face]) for face in numpy.nonzero(removed)[0]]
    sides = regions.boundary(quads)
    start = next((k for k, (quad, side) in enumerate(sides) if [addresses[quad], side] == operation["start"]), None)
    return unknown if start is None else regions.corner_counts(quads, sides[start:] + sides[:start])


def _addresses(level):
    """(root, path) of every face of a level object as arrays, or (None, None)."""
    root, path = (meshes.face_numbers(level, name) for name in (meshes.ROOT, meshes.PATH))
    return (None, None) if root is None or path is None else (root, path)


def _level_number(level):
    return hierarchy_properties.level_number(level.hybrid_mesh.level)


def _settings_of(hierarchy, scene):
    """The settings that a hierarchy was made with: another region is no reason for another size. The scene's, if they are not known."""
    recorded = hierarchy_properties.report_of(hierarchy).get("settings")
    given = core_settings(scene.hybrid_mesh)
    if not isinstance(recorded, dict):
        return given
    return core.from_mapping({**recorded, "threads": given.threads})


def _to_object_mode(context):
    if objects.active(context) is not None and context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


def _select_only(context, obj):
    for other in list(context.view_layer.objects.selected):
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


def _look_at(context, surface, place, size):
    """Turns the 3D views of the window to a place, from outside the surface."""
    if context.window is None:
        return
    inverse = surface.matrix_world.inverted_safe()
    try:
        found, _, normal, _ = surface.evaluated_get(context.evaluated_depsgraph_get()).closest_point_on_mesh(inverse @ place)
    except RuntimeError:  # It has no faces any more.
        found = False
    outward = (inverse.to_3x3().transposed() @ normal).normalized() if found else None
    for area in context.window.screen.areas:
        if area.type != "VIEW_3D":
            continue
        view = area.spaces.active.region_3d
        if view.view_perspective == "CAMERA":
            view.view_perspective = "PERSP"
        toward = view.view_rotation @ mathutils.Vector((0, 0, 1))
        if outward is not None and toward.dot(outward) < 0.5:
            view.view_rotation = outward.to_track_quat("Z", "Y")
        view.view_location = place
        view.view_distance = 10 * size
