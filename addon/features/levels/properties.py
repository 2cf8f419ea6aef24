# SPDX-License-Identifier: GPL-3.0-or-later
"""What a hierarchy's collection and objects know about themselves, saved in the .blend."""

import functools
import json

import bpy
from bpy.props import EnumProperty, PointerProperty, StringProperty

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


class HybridMeshCollection(bpy.types.PropertyGroup):
    source: PointerProperty(name="Source", type=bpy.types.Object, description="The object that was remeshed")
    preview: PointerProperty(name="Preview", type=bpy.types.Object, description="The object that shows one level at a time")
    report: StringProperty(name="Report", description="What was measured, as JSON")


def describe(built, source, report):
    """Writes into a new hierarchy what it is and what was measured."""
    collection = built.collection.hybrid_mesh
    collection.source = source
    collection.preview = built.preview
    collection.report = json.dumps(report, ensure_ascii=False)
    for level, obj in zip(built.level_names, built.levels, strict=True):
        obj.hybrid_mesh.role = "LEVEL"
        obj.hybrid_mesh.level = level
        obj.hybrid_mesh.hierarchy = built.collection
    built.preview.hybrid_mesh.role = "PREVIEW"
    built.preview.hybrid_mesh.hierarchy = built.collection


def hierarchy_of(obj):
    """The hierarchy collection that an object belongs to or was the latest source of, or None."""
    if obj is None:
        return None
    # Asked first, because reading a property group that was never set leaves an empty one behind.
    if obj.is_property_set("hybrid_mesh") and obj.hybrid_mesh.hierarchy is not None:
        return obj.hybrid_mesh.hierarchy
    hierarchies = (collection for collection in bpy.data.collections if collection.is_property_set("hybrid_mesh"))
    made = [collection for collection in hierarchies if collection.hybrid_mesh.source == obj]
    return max(made, key=lambda collection: collection.name, default=None)


def report_of(collection):
    """The report of a hierarchy as a dictionary; empty where there is none."""
    return _parsed(collection.hybrid_mesh.report)


def quality_of(collection):
    return reports.quality(report_of(collection))


@functools.lru_cache(maxsize=16)
def _parsed(text):
    try:
        return json.loads(text) if text else {}
    except ValueError:
        return {}


def register():
    bpy.types.Object.hybrid_mesh = PointerProperty(type=HybridMeshObject)
    bpy.types.Collection.hybrid_mesh = PointerProperty(type=HybridMeshCollection)


def unregister():
    del bpy.types.Collection.hybrid_mesh
    del bpy.types.Object.hybrid_mesh
