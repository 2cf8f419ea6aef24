# SPDX-License-Identifier: GPL-3.0-or-later
"""What a hierarchy's collection and objects know about themselves, saved in the .blend."""

import functools
import json
import re

import bpy
import mathutils
from bpy.props import EnumProperty, FloatVectorProperty, PointerProperty, StringProperty

from ...bridge.names import with_suffix
from ...core import plans
from ...core import report as reports

ROLES = (
    ("NONE", "None", "Not part of a hierarchy"),
    ("LEVEL", "Level", "One level of a hierarchy"),
    ("PREVIEW", "Preview", "Shows one level of a hierarchy at a time"),
)


class HybridMeshObject(bpy.types.PropertyGroup):
    role: EnumProperty(name="Role", items=ROLES, default="NONE")
    level: StringProperty(name="Level", description="Name of the level in the hierarchy")
    hierarchy: PointerProperty(name="Hierarchy", type=bpy.types.Collection, description="Collection of the levels")
    made_of: PointerProperty(name="Made Of", type=bpy.types.Collection, description="The hierarchy that an ordinary object was made of; it is no part of it")
    made_level: StringProperty(name="Made Level", description="Name of the level that an ordinary object was made of")


class HybridMeshCollection(bpy.types.PropertyGroup):
    source: PointerProperty(name="Source", type=bpy.types.Object, description="The object that was remeshed; none where the hierarchy was imported")
    file: StringProperty(name="File", description="The file that the hierarchy was imported from", subtype="FILE_PATH")
    preview: PointerProperty(name="Preview", type=bpy.types.Object, description="The object that shows one level at a time")
    report: StringProperty(name="Report", description="What was measured, as JSON")
    matrix: FloatVectorProperty(
        name="Matrix", description="Object to world when it was measured: the report's places are the world's", size=16, subtype="MATRIX",
        default=[float(i % 5 == 0) for i in range(16)],
    )  # fmt: skip
    operations: StringProperty(name="Operations", description="The irregular operations, as JSON: where they are and what quads they put there")
    token: StringProperty(name="Token", description="Names the native hierarchy", options={"HIDDEN"})
    stored: StringProperty(name="Stored", description="The token of the native hierarchy that is in the file", options={"HIDDEN"})
    plan: PointerProperty(name="Plan", type=bpy.types.Text, description="What was decided, as JSON; a remesh can be given it again")


def describe(built, source, report, plan="", operations=()):
    """Writes into a new hierarchy what it is, what was measured and, as JSON text, what was decided; operations: of the native hierarchy."""
    collection = built.collection.hybrid_mesh
    collection.source = source
    collection.preview = built.preview
    collection.report = json.dumps(report, ensure_ascii=False)
    collection.matrix = [value for column in built.matrix.T for value in column]
    collection.operations = json.dumps(list(operations))
    if plan:
        collection.plan = bpy.data.texts.new(with_suffix(built.collection.name, " plan"))
        collection.plan.write(plans.in_lines(plan))
    for level, obj in zip(built.level_names, built.levels, strict=True):
        obj.hybrid_mesh.role = "LEVEL"
        obj.hybrid_mesh.level = level
        obj.hybrid_mesh.hierarchy = built.collection
    built.preview.hybrid_mesh.role = "PREVIEW"
    built.preview.hybrid_mesh.hierarchy = built.collection


def is_level(obj):
    # Asked first, because reading a property group that was never set leaves an empty one behind.
    return obj is not None and obj.is_property_set("hybrid_mesh") and obj.hybrid_mesh.role == "LEVEL" and obj.hybrid_mesh.hierarchy is not None


def hierarchy_of(obj):
    """The hierarchy collection that an object belongs to or was the latest source of, or None."""
    if obj is None:
        return None
    if obj.is_property_set("hybrid_mesh") and obj.hybrid_mesh.hierarchy is not None:
        return obj.hybrid_mesh.hierarchy
    hierarchies = (collection for collection in bpy.data.collections if collection.is_property_set("hybrid_mesh"))
    made = [collection for collection in hierarchies if collection.hybrid_mesh.source == obj]
    return max(made, key=lambda collection: collection.name, default=None)


def origin_of(obj):
    """The hierarchy collection that an ordinary object was made of, or None."""
    return obj.hybrid_mesh.made_of if obj is not None and obj.is_property_set("hybrid_mesh") else None


def name_of(collection):
    """The name of what a hierarchy was made of."""
    source = collection.hybrid_mesh.source
    return source.name if source is not None else re.sub(r" hierarchy(\.\d+)?$", "", collection.name)


def report_of(collection):
    """The report of a hierarchy as a dictionary; empty where there is none."""
    return _parsed(collection.hybrid_mesh.report)


def place_of(collection, where):
    """A place that a report names, in the world: it has gone where the hierarchy has gone since."""
    matrix, preview = collection.hybrid_mesh.matrix, collection.hybrid_mesh.preview
    place = mathutils.Vector(where)
    return place if preview is None else preview.matrix_world @ (matrix.inverted_safe() @ place)


def plan_of(collection):
    """The plan of a hierarchy as text; empty where there is none."""
    plan = collection.hybrid_mesh.plan
    return plan.as_string() if plan is not None else ""


def operations_of(collection):
    """The irregular operations of a hierarchy: [{kind, level, quads, corners, start, new_quads}], as the native hierarchy tells them."""
    return _parsed(collection.hybrid_mesh.operations) or []


def level_number(name):
    """The number in a level's name: 2 of M2 and of N2."""
    return int(name[1:])


def quality_of(collection):
    return reports.quality(report_of(collection))


@functools.lru_cache(maxsize=16)
def _parsed(text):
    try:
        return json.loads(text) if text else {}
    except ValueError:
        return {}


PROPERTIES = ((bpy.types.Object, "hybrid_mesh", HybridMeshObject), (bpy.types.Collection, "hybrid_mesh", HybridMeshCollection))
