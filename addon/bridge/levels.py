# SPDX-License-Identifier: GPL-3.0-or-later
"""A hierarchy as objects: a collection with one mesh object a level, and a preview object that switches between them."""

from dataclasses import dataclass

import bpy
import numpy

from .. import compat
from ..core.colors import stretch_colors
from . import meshes
from .names import with_suffix

LEVEL_INPUT = "Level"
PREVIEW_MODIFIER = "Hybrid Mesh Level"
SUBDIVISION_MODIFIER = "Subdivision Preview"
_OBJECT_NODE = "GeometryNodeObjectInfo"


@dataclass
class Built:
    collection: bpy.types.Collection
    level_names: list
    levels: list
    preview: bpy.types.Object
    blocks: list  # all data-blocks that were made, in order
    matrix: numpy.ndarray  # object to world, when it was built
    warning: str = ""  # what could not be carried over, for people


def build(name, levels, matrix, scene, place=None, source=None, carry=None):
    """Makes the objects of a hierarchy in a new collection of the scene.

    levels: (level name, MeshDict in world space) from coarse to fine; matrix: object to world, as the objects will have it;
    place(obj): puts an object where the source stands; carry(obj, MeshDict): adds what the source's surface carries.
    On an error nothing is left behind.
    """
    made = []
    collection = bpy.data.collections.new(with_suffix(name, " hierarchy"))
    made.append(collection)
    try:
        scene.collection.children.link(collection)
        objects = []
        for level_name, arrays in levels:
            mesh = meshes.new_mesh(with_suffix(name, f".{level_name}"), arrays, matrix)
            made.append(mesh)
            add_figures(mesh, arrays)
            if source is not None:
                for slot in source.material_slots:
                    mesh.materials.append(slot.material)
            obj = _new_object(mesh.name, mesh, collection, place)
            made.append(obj)
            if carry is not None:
                carry(obj, arrays)
            modifier = obj.modifiers.new(SUBDIVISION_MODIFIER, "SUBSURF")
            modifier.levels = 1
            modifier.render_levels = 1
            modifier.show_viewport = False
            modifier.show_render = False
            objects.append(obj)
        preview = _preview(name, objects, collection, place, made)
    except BaseException:
        _remove(made)
        raise
    return Built(collection, [level_name for level_name, _ in levels], objects, preview, made, matrix)


def remove(built):
    """Takes back what build() has made."""
    _remove(built.blocks)


def take_over(built, collection, preview, old):
    """Has the objects of a hierarchy show what build() has made, which is taken apart; returns Built of these objects.

    old: level name: object. Objects of levels that there are no more go; those of new ones come into the collection. The preview (None: it is gone) shows the level
    of the same name as before.
    """
    shown = next((name for name, obj in old.items() if preview is not None and obj == shown_object(preview)), None)
    chosen, unused, names = [], [], []  # names: (data-block, the name that it takes over)
    for name, made in zip(built.level_names, built.levels, strict=True):
        obj = old.pop(name, None)
        if obj is None:
            collection.objects.link(made)
            obj = made
        else:
            before, obj.data = obj.data, made.data
            unused.append(made)
            if not before.users:
                names.append((obj.data, before.name))
                unused.append(before)
        chosen.append(obj)
    for obj in old.values():
        unused += [obj] if obj.data.users > 1 else [obj, obj.data]
    if preview is None:
        preview = built.preview
        collection.objects.link(preview)
        modifier = preview.modifiers[PREVIEW_MODIFIER]
    else:
        modifier = preview.modifiers.get(PREVIEW_MODIFIER) or preview.modifiers.new(PREVIEW_MODIFIER, "NODES")
        unused += [built.preview, built.preview.data]
    before, temporary = modifier.node_group, built.preview.modifiers[PREVIEW_MODIFIER].node_group
    modifier.node_group = _level_switch(temporary.name, chosen)
    if before is not None and not before.users:
        unused.append(before)
    if before != temporary:
        unused.append(temporary)
    names.append((modifier.node_group, temporary.name if before is None else before.name))
    set_level(preview, built.level_names.index(shown) if shown in built.level_names else len(chosen) - 1)
    # All at once: Blender 5.0 crashes where they go one after the other.
    bpy.data.batch_remove([*unused, built.collection])
    for block, name in names:
        block.name = name
    return Built(collection, built.level_names, chosen, preview, [], built.matrix, built.warning)


def add_figures(mesh, arrays):
    """What a level says of its faces as attributes: stretch (also as the active colours), anisotropy, patch, irregular faces, what opened there, addresses."""
    stretch = arrays.get("stretch")
    if stretch is not None:
        meshes.set_attribute(mesh, meshes.STRETCH, "FLOAT", "FACE", stretch)
        corners = numpy.repeat(stretch_colors(stretch), numpy.diff(arrays["offsets"]), axis=0)
        meshes.set_attribute(mesh, meshes.STRETCH_COLOR, "BYTE_COLOR", "CORNER", corners)
        mesh.color_attributes.active_color_index = mesh.color_attributes.find(meshes.STRETCH_COLOR)
    for key, name, kind in (
        ("anisotropy", meshes.ANISOTROPY, "FLOAT"), ("patch", meshes.PATCH, "INT"), ("irregular", meshes.IRREGULAR, "BOOLEAN"),
        ("opened", meshes.OPENED, "INT"), ("opened_level", meshes.OPENED_LEVEL, "INT"), ("root", meshes.ROOT, "INT"), ("path", meshes.PATH, "INT"),
    ):  # fmt: skip
        if arrays.get(key) is not None:
            meshes.set_attribute(mesh, name, kind, "FACE", arrays[key])


def show_preview_only(built):
    """Hides the levels in the viewport and in renders, so that the preview is what one sees; the eye icon brings them back."""
    for obj in built.levels:
        obj.hide_render = True
        try:
            obj.hide_set(True)
        except RuntimeError:
            pass  # The collection is excluded from the view layer: not seen anyway.


def level_of(preview):
    return compat.get_group_input(preview.modifiers[PREVIEW_MODIFIER], LEVEL_INPUT)


def set_level(preview, level):
    """Shows a level, 0 the coarsest; what is out of range shows the nearest."""
    compat.set_group_input(preview.modifiers[PREVIEW_MODIFIER], LEVEL_INPUT, int(level))
    preview.update_tag()


def shown_object(preview):
    """The object whose mesh a preview shows; None where that object, or the modifier, is gone."""
    modifier = preview.modifiers.get(PREVIEW_MODIFIER)
    if modifier is None or modifier.node_group is None:
        return None
    objects = _switched(modifier)
    return objects[min(max(level_of(preview), 0), len(objects) - 1)] if objects else None


def count(preview):
    """How many levels a preview switches between."""
    return len(_switched(preview.modifiers[PREVIEW_MODIFIER]))


def _switched(modifier):
    return [node.inputs["Object"].default_value for node in modifier.node_group.nodes if node.bl_idname == _OBJECT_NODE]


def draw_level(layout, preview):
    """The Level input as a slider."""
    modifier = preview.modifiers.get(PREVIEW_MODIFIER)
    if modifier and modifier.node_group:
        compat.draw_group_input(layout, modifier, LEVEL_INPUT)


def _preview(name, levels, collection, place, made):
    title = with_suffix(name, ".preview")
    mesh = bpy.data.meshes.new(title)
    made.append(mesh)
    for material in levels[-1].data.materials:
        mesh.materials.append(material)
    switch = _level_switch(with_suffix(name, " levels"), levels)
    made.append(switch)
    preview = _new_object(title, mesh, collection, place)
    made.append(preview)
    # What a modifier above the preview's own looks groups up in; the weights come with the level's geometry, by the groups' numbers.
    for group in levels[-1].vertex_groups:
        preview.vertex_groups.new(name=group.name)
    modifier = preview.modifiers.new(PREVIEW_MODIFIER, "NODES")
    modifier.node_group = switch
    set_level(preview, len(levels) - 1)
    return preview


def _level_switch(name, levels):
    """A node group with the input Level whose output is the geometry of that level's object, in its own space.

    Each step asks for its object by name, not for the n-th of a collection: renaming and adding objects must not change what is shown.
    Only the level shown is evaluated.
    """
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    compat.new_level_input(group, LEVEL_INPUT, "Level of the hierarchy, 0 the coarsest", len(levels) - 1)
    compat.new_geometry_output(group)
    nodes, links = group.nodes, group.links
    entry = nodes.new("NodeGroupInput")
    entry.location = (-400, 0)
    shown = None
    for number, obj in enumerate(levels):
        info = nodes.new(_OBJECT_NODE)
        info.label = obj.name
        info.transform_space = "ORIGINAL"
        info.inputs["Object"].default_value = obj
        info.location = (-100, -260 * number)
        if shown is None:
            shown = info.outputs["Geometry"]
            continue
        compare = nodes.new("FunctionNodeCompare")
        compare.data_type = "INT"
        compare.operation = "GREATER_EQUAL"
        compare.location = (100 + 220 * number, 160)
        links.new(entry.outputs[0], _socket(compare.inputs, "A", "INT"))
        _socket(compare.inputs, "B", "INT").default_value = number
        switch = nodes.new("GeometryNodeSwitch")
        switch.input_type = "GEOMETRY"
        switch.location = (100 + 220 * number, -60)
        condition = next(socket for socket in switch.inputs if socket.name == "Switch" and socket.enabled)
        links.new(compare.outputs[0], condition)
        links.new(shown, _socket(switch.inputs, "False", "GEOMETRY"))
        links.new(info.outputs["Geometry"], _socket(switch.inputs, "True", "GEOMETRY"))
        shown = next(socket for socket in switch.outputs if socket.type == "GEOMETRY")
    leave = nodes.new("NodeGroupOutput")
    leave.location = (400 + 220 * len(levels), 0)
    links.new(shown, leave.inputs[0])
    return group


def _socket(sockets, name, kind):
    return next(socket for socket in sockets if socket.name == name and socket.type == kind)


def _new_object(name, data, collection, place):
    obj = bpy.data.objects.new(name, data)
    collection.objects.link(obj)
    if place is not None:
        place(obj)
    return obj


def _remove(blocks):
    for block in reversed(blocks):
        _collection_of(block).remove(block)


def _collection_of(block):
    return {
        bpy.types.Collection: bpy.data.collections,
        bpy.types.Mesh: bpy.data.meshes,
        bpy.types.GeometryNodeTree: bpy.data.node_groups,
    }.get(type(block), bpy.data.objects)
