# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a drawn layout: marked on the surface, listed and said."""

import bpy
import mathutils
import numpy

from ...bridge import objects
from . import drawing


class LayoutProblemsError(ValueError):
    """A drawn layout that cannot be remeshed. result: what the native module made of it."""

    def __init__(self, result):
        problems = result["problems"]
        super().__init__(f"The layout has {counted(len(problems), 'problems')}, marked in red and listed in the panel Patch Layout: {problems[0]['message']}")
        self.result = result


def show_check(operator, context, source, drawn, result):
    """Shows what was made of what is drawn, and says it; returns whether there is still something to show it with."""
    surface, layout = objects.find(context.scene, source.key), objects.find(context.scene, drawn.layout)
    if surface is None or layout is None:
        return False
    size = _diagonal(source.mesh.points)
    drawing.show_curves(context, surface, result, size)
    drawing.show_problems(context, surface, layout, drawn.strokes, result["problems"], size)
    summary = ", ".join(counted(len(result[things]), things) for things in ("nodes", "curves", "faces"))
    layout.hybrid_mesh_layout.summary = summary
    for problem in result["problems"]:
        number = problem["stroke"]
        operator.report({"WARNING"}, named(problem["message"], drawn.strokes[number]) if 0 <= number < len(drawn.strokes) else problem["message"])
    if not result["problems"]:
        operator.report({"INFO"}, f"{surface.name}: {summary}; nothing is wrong")
    return True


def named(words, stroke):
    return f"{words} (stroke {stroke.number + 1} of {stroke.layer})"


def show_failure(context, key, drawn, error):
    """Marks what the native module says of the curves of a region. key: of the object that they are drawn on."""
    surface = objects.find(context.scene, key)
    layout = objects.find(context.scene, drawn.layout) if drawn is not None else None
    if surface is None or layout is None or type(error).__name__ != "LayoutError" or len(error.args) < 2:
        return
    points = numpy.array([surface.matrix_world @ mathutils.Vector(corner) for corner in surface.bound_box])
    drawing.show_problems(context, surface, layout, drawn.strokes, error.args[1], _diagonal(points))
    push_marks()


def push_marks():
    """An operator that is cancelled makes no undo step; what it has marked is one of its own."""
    bpy.ops.ed.undo_push(message="Mark Layout Problems")


def counted(number, things):
    return f"{number} {things.removesuffix('s') if number == 1 else things}"


def _diagonal(points):
    return float(numpy.linalg.norm(numpy.ptp(points, axis=0)))
