# SPDX-License-Identifier: GPL-3.0-or-later
"""What every operator that remeshes has in common: the native work as a task, and its result as a hierarchy of objects."""

import json

from ...bridge import arrays, density, meshes, objects, placement, transfer, view
from ...core import loops
from ...core import report as reports
from ...core.native import native
from ...core.tasks import Task
from ...core.version import VERSION
from ...jobs import NativeJobOperator
from ..display import properties as display_properties
from ..levels import hierarchies, kept
from ..levels import properties as hierarchy_properties
from ..topology import properties as topology_properties


def _mirror_plane(obj, matrix, symmetry):
    """The native setting `symmetry` of an object with that matrix for the settings' one; its axes are the object's. Raises meshes.SourceError."""
    if symmetry == "auto":
        symmetry = objects.mirrored_axis(obj) or symmetry
    return arrays.mirror_plane(matrix, "xyz".index(symmetry)) if symmetry in ("x", "y", "z") else symmetry


def remesh_task(obj, depsgraph, settings, plan=""):
    """A task that remeshes an object with RemeshSettings, by a plan if there is one, else with the object's loops. An object that cannot be read is a task that fails."""
    try:
        source = meshes.read_source(obj, depsgraph, transfer.collect, density.reader(settings.density))
        plan = plan or topology_properties.plan_of(obj, source)
        symmetry = _mirror_plane(obj, source.matrix, settings.symmetry)
    except (meshes.SourceError, arrays.MatrixError, loops.LoopError) as error:
        return Task(obj.name, _refusal(error))
    return source_task(obj.name, source, settings, plan, symmetry)


def source_task(name, source, settings, plan="", symmetry=None):
    """A task that remeshes a meshes.Source, which was read of the object of that name. symmetry: the native setting, in world space; None: the settings'."""
    module, values = native(), settings.native()
    if symmetry is not None:
        values["symmetry"] = symmetry
    if plan:
        values["plan"] = plan
    return Task(name, lambda: module.start_remesh(*source.mesh, values, source.density), (source, settings))


class RemeshJobOperator(NativeJobOperator):
    """Base of operators whose tasks are remesh_task()s. Subclasses have hides_source(context)."""

    def finish(self, context, results):
        # Everything is looked up again: objects may have gone while the work ran.
        sources = [objects.find(context.scene, task.note[0].key) for task, _ in results]
        for obj, (task, _) in zip(sources, results):
            if obj is None:
                raise ValueError(f"{task.name}: the object is gone from the scene; nothing was made")
        built = []
        try:
            for obj, (task, result) in zip(sources, results, strict=True):
                built.append(self.build(context, obj, result, *task.note))
        except BaseException:
            for one in built:
                hierarchies.remove(one)
            raise
        view.select_only(context, *(one.preview for one in built))
        for one in built:
            display_properties.show(context, one.collection)
        if self.hides_source(context):
            for obj in sources:
                if objects.in_view_layer(obj, context.view_layer):
                    obj.hide_set(True)
                if objects.is_local(obj):
                    obj.hide_render = True  # The preview is rendered in its place.
        for one in built:
            self.report({"INFO"}, _line(one))
            if one.warning:
                self.report({"WARNING"}, f"{one.collection.name}: {one.warning}")
        for task, result in results:
            self._judge(task.name, json.loads(result.report), task.note[1].strict)

    def _judge(self, name, report, strict):
        """Says why a result is poor, which for strict settings is an error, and what else is worth knowing. It is there all the same."""
        for warning in report.get("warnings", []):
            self.report({"WARNING"}, f"{name}: {warning}")
        for reason in reports.reasons(report):
            self.report({"ERROR" if strict else "WARNING"}, f"{name}: poor: {reason['text']}")

    def build(self, context, obj, result, source, settings):
        """levels.Built of a task's result."""
        return build_hierarchy(context, obj, result, source, settings)

    def hides_source(self, context):
        raise NotImplementedError


def _refusal(error):
    """A start that fails: the object is named among the errors, and the others are done."""

    def start():
        raise error

    return start


def build_hierarchy(context, obj, result, source, settings):
    """The objects of a task's result, with the report and the plan; returns levels.Built. source, settings: the task's note."""
    report = json.loads(result.report)
    report["version"] = VERSION
    report["settings"] = settings.reported()
    repaired = result.repaired()
    at_hand = kept.Kept(result.hierarchy, source.matrix, source=source, settings=settings, repaired=repaired)
    carry = transfer.Carrier(source, repaired)
    built = hierarchies.build(context, obj.name, at_hand, report, plan=result.plan, place=placement.same_place(obj), source=obj, carry=carry)
    built.warning = carry.warning(built.level_names)
    return built


def _line(built):
    quality = hierarchy_properties.quality_of(built.collection)
    figures = [f"{quality['vertices']:,} vertices"] if quality["vertices"] is not None else []
    if quality["l2"] is not None:
        figures.append(f"L2 {quality['l2']:.2e}")
    return f"{built.collection.name}: {', '.join([f'{len(built.levels)} levels', *figures])}"
