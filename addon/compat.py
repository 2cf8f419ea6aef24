# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between Blender versions: the only module that asks which one this is."""

import math

import blf
import bpy
import numpy

HAS_COMMAND_LINE = bpy.app.version >= (4, 2, 0)
_HAS_NODE_INTERFACE = bpy.app.version >= (4, 0, 0)
_HAS_UV_VECTORS = bpy.app.version >= (3, 5, 0)
_HAS_EDGE_ATTRIBUTES = bpy.app.version >= (4, 0, 0)
_HAS_NODES_ALWAYS = bpy.app.version >= (5, 0, 0)
_HAS_AUTO_SMOOTH = bpy.app.version < (4, 1, 0)


def uv_values(layer):
    """The collection of a UV layer and the name of its property, for foreach_get and foreach_set."""
    return (layer.uv, "vector") if _HAS_UV_VECTORS else (layer.data, "uv")


def new_sharp_edges(mesh):
    """The collection that says which edges of a new mesh are sharp and the name of its property, for foreach_set."""
    return (mesh.attributes.new("sharp_edge", "BOOLEAN", "EDGE").data, "value") if _HAS_EDGE_ATTRIBUTES else (mesh.edges, "use_edge_sharp")


def new_edge_creases(mesh):
    """The same for the creases of its edges."""
    return (mesh.attributes.new("crease_edge", "FLOAT", "EDGE").data, "value") if _HAS_EDGE_ATTRIBUTES else (mesh.edges, "crease")


def split_normals(mesh):
    """Has a smooth mesh's normals split at edges that are marked as sharp, and nowhere else; later versions always do."""
    if _HAS_AUTO_SMOOTH:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.pi


def new_material(name):
    """A material with the nodes that Blender gives a new one."""
    material = bpy.data.materials.new(name)
    if not _HAS_NODES_ALWAYS:
        material.use_nodes = True
    return material


def split_normals_above(mesh, angle):
    """Has a smooth mesh's normals split at edges at which it turns by more than an angle."""
    if _HAS_AUTO_SMOOTH:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = angle
    else:
        mesh.set_sharp_from_angle(angle=angle)


def new_level_input(group, name, description, most):
    """Adds a whole-number input in [0, most] with the default `most` to a node group."""
    if _HAS_NODE_INTERFACE:
        socket = group.interface.new_socket(name, description=description, in_out="INPUT", socket_type="NodeSocketInt")
    else:
        socket = group.inputs.new("NodeSocketInt", name)
        socket.description = description
    socket.min_value = 0
    socket.max_value = most
    socket.default_value = most


def new_geometry_output(group):
    if _HAS_NODE_INTERFACE:
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        group.outputs.new("NodeSocketGeometry", "Geometry")


def _group_input(modifier, name):
    """What has the value of a node group's input in a Geometry Nodes modifier, and under which name: the modifier itself, by a key, or from some later version on a property."""
    group = modifier.node_group
    if _HAS_NODE_INTERFACE:
        items = (item for item in group.interface.items_tree if item.item_type == "SOCKET" and item.in_out == "INPUT")
    else:
        items = group.inputs
    key = next(item.identifier for item in items if item.name == name)
    return (getattr(modifier.properties.inputs, key), "value") if hasattr(modifier, "properties") else (modifier, key)


def get_group_input(modifier, name):
    holder, key = _group_input(modifier, name)
    return holder[key] if holder == modifier else getattr(holder, key)


def set_group_input(modifier, name, value):
    holder, key = _group_input(modifier, name)
    if holder == modifier:
        holder[key] = value
    else:
        setattr(holder, key, value)


def draw_group_input(layout, modifier, name):
    holder, key = _group_input(modifier, name)
    layout.prop(holder, f'["{key}"]' if holder == modifier else key, text=name)


def flat_shader():
    """The shader that draws things of one colour."""
    import gpu  # It is not there without a window.

    return gpu.shader.from_builtin("UNIFORM_COLOR" if _HAS_NODE_INTERFACE else "2D_UNIFORM_COLOR")


def font_size(font, size):
    if _HAS_NODE_INTERFACE:
        blf.size(font, size)
    else:
        blf.size(font, size, 72)


def draw_progress(layout, factor, text):
    """A bar, or in words where there are no bars."""
    if hasattr(layout, "progress"):
        layout.progress(factor=factor, text=text)
    else:
        layout.label(text=text)


def grease_pencils():
    """The Grease Pencil data-blocks that objects have; in some versions another collection holds those of annotations."""
    return bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils


def draw_on_surfaces(tool_settings, data):
    """Has strokes drawn into a Grease Pencil data-block lie on the surface under the pointer, not above it."""
    tool_settings.gpencil_stroke_placement_view3d = "SURFACE"
    if hasattr(tool_settings, "gpencil_surface_offset"):
        tool_settings.gpencil_surface_offset = 0
    if hasattr(data, "zdepth_offset"):
        data.zdepth_offset = 0


def give_numpy_its_old_names():
    """For importers that are older than the numpy they run with, as a distribution may have them: glTF's of 3.4 with numpy 1.24."""
    if "bool" not in vars(numpy):  # Asking for it would warn.
        numpy.bool = bool


def register_command_line(name, function):
    """Makes `blender --command NAME ARGS` call function(list of arguments) -> exit code. Returns a handle or None before 4.2."""
    return bpy.utils.register_cli_command(name, function) if HAS_COMMAND_LINE else None


def unregister_command_line(handle):
    if handle is not None:
        bpy.utils.unregister_cli_command(handle)
