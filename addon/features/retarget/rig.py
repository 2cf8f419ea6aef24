# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves the source moves an object made of its hierarchy: armatures with their vertex groups, and shape keys."""

from dataclasses import dataclass

import bpy
import numpy

from ... import compat
from ...bridge import arrays, kept_places, meshes, objects, shapes, transfer
from ..levels import kept
from ..levels.properties import origin_of

_FARTHEST = 0.01  # of the diagonal: an object that is farther from the source, on average, has been made of another shape
_KEY_PROPERTIES = ("slider_min", "slider_max", "value", "mute", "interpolation", "vertex_group")
_ARMATURE_PROPERTIES = (
    "object", "use_deform_preserve_volume", "use_vertex_groups", "use_bone_envelopes", "use_multi_modifier", "vertex_group", "invert_vertex_group",
    "show_viewport", "show_render", "show_in_editmode", "show_on_cage",
)  # fmt: skip


@dataclass
class Retargeted:
    obj: bpy.types.Object
    armatures: int = 0
    groups: int = 0
    keys: int = 0

    def line(self):
        """One line for people."""
        parts = [_count(self.armatures, "armature"), _count(self.groups, "vertex group"), _count(self.keys, "shape key")]
        return f"{self.obj.name}: {', '.join(part for part in parts if part)}"


def retarget(context, obj):
    """Gives an object that was made of a hierarchy what moves its source. Returns Retargeted. Raises ValueError with a line for people; then nothing has changed."""
    source = _source_of(obj)
    with shapes.still(context, source) as still:
        points, triangles = still.read(0, shapes.triangles_of)
        groups = still.read(0, transfer.group_weights)
        keys = source.data.shape_keys.key_blocks if source.data.shape_keys else []
        key_points = [still.read(number) if number else points for number in range(len(keys))]
    for key, shape in zip(keys, key_points):
        if len(shape) != len(points):
            raise ValueError(f"{source.name}: with the shape key {key.name} its modifiers make another mesh, so that its places cannot be told")
    places = meshes.values_of(obj.data.vertices, "co", 3).astype(numpy.float64)
    ride = _ride(context, obj, source, points, triangles, places)
    done = Retargeted(obj)
    obj.shape_key_clear()
    _set_places(obj.data, ride(points))
    for name, weights in groups.items():
        transfer.set_group(obj, name, ride.carried(weights))
    done.groups = len(groups)
    done.keys = _add_keys(obj, source, ride, key_points)
    done.armatures = _add_armatures(context, obj, source)
    _mark_seams(obj.data, source.data)
    _copy_properties(source, obj)
    _copy_properties(source.data, obj.data)
    return done


def moves(source):
    """Whether there is anything that moves an object: an armature, or shape keys."""
    return bool(_armature_modifiers(source)) or source.parent_type == "ARMATURE" or source.data.shape_keys is not None


def _source_of(obj):
    collection = origin_of(obj)
    source = collection.hybrid_mesh.source if collection is not None else None
    if source is None or source.type != "MESH":
        raise ValueError(f"{obj.name}: the object that it was remeshed from is not known")
    if not objects.is_local(obj) or not objects.is_local(obj.data):
        raise ValueError(f"{obj.name} comes of a library and cannot be changed")
    if obj.data.users > 1:
        raise ValueError(f"{obj.name} shares its mesh with other objects, which would be changed with it: make it single-user first")
    if not moves(source):
        raise ValueError(f"{source.name} has neither an armature nor shape keys: there is nothing to retarget")
    return source


def _ride(context, obj, source, rest, triangles, places):
    """Where the object's vertices lie on the source: by what is kept with the mesh, else nearest to it; on the shape that it had when it was remeshed."""
    found = kept_places.find(obj.data)
    if found is not None and found.source_vertices != len(rest):
        found = None  # The source has other vertices since.
    rides = []
    for shape in _candidates(context, obj, source, rest):
        corners, weights = (found.corners, found.weights) if found else shapes.nearest_places(shape, triangles, places)
        rides.append(shapes.Ride(corners, weights, shape, places))
    best = min(rides, key=lambda ride: ride.off())
    diagonal = float(numpy.linalg.norm(numpy.ptp(places, axis=0)))
    if not best.off() <= _FARTHEST * diagonal:
        raise ValueError(
            f"{obj.name} does not lie on {source.name}, neither as that is now nor at rest: go to the frame and the pose in which it was remeshed"
        )
    return best


def _candidates(context, obj, source, rest):
    """Shapes that the source may have had when it was remeshed, in its own space."""
    yield rest
    yield from (shape for shape in [shapes.as_it_is(context, source)] if len(shape) == len(rest))
    at_hand = kept.find(origin_of(obj))
    if at_hand is not None and at_hand.source is not None and len(at_hand.source.mesh.points) == len(rest):
        yield arrays.transformed(at_hand.source.mesh.points, numpy.linalg.inv(at_hand.matrix))


def _set_places(mesh, places):
    before = meshes.values_of(mesh.vertices, "co", 3)
    # What is at rest already stays as it is, to the last digit.
    meshes.set_places(mesh, numpy.where(numpy.abs(places - before) > 1e-6 * numpy.ptp(before, axis=0).max(initial=0), places, before).astype(numpy.float32))


def _add_keys(obj, source, ride, key_points):
    keys = source.data.shape_keys
    if keys is None:
        return 0
    basis, moved = meshes.values_of(obj.data.vertices, "co", 3), ride(key_points[0])
    for key, shape in zip(keys.key_blocks, key_points):
        made = obj.shape_key_add(name=key.name, from_mix=False)
        if key != keys.key_blocks[0]:
            shapes.set_key(made, basis + (ride(shape) - moved))
        for name in _KEY_PROPERTIES:
            setattr(made, name, getattr(key, name))
    own = obj.data.shape_keys
    for key, made in zip(keys.key_blocks, own.key_blocks):
        made.relative_key = own.key_blocks[key.relative_key.name]
    own.use_relative = keys.use_relative
    if not keys.use_relative:
        own.eval_time = keys.eval_time
    obj.active_shape_key_index = source.active_shape_key_index
    obj.show_only_shape_key = source.show_only_shape_key
    _copy_animation(keys, own)
    obj.data.update()
    return len(key_points) - 1


def _copy_animation(source, target):
    """The action and the drivers of shape keys, which go by the keys' names."""
    data = source.animation_data
    if data is None:
        return
    own = target.animation_data_create()
    if data.action is not None:
        own.action = data.action
        if getattr(data, "action_slot", None) is not None:
            own.action_slot = data.action_slot
    for driver in data.drivers:
        own.drivers.from_existing(src_driver=driver)


def _armature_modifiers(source):
    return [modifier for modifier in source.modifiers if modifier.type == "ARMATURE" and modifier.object is not None]


def _add_armatures(context, obj, source):
    """The armature modifiers, before all others, so that Multires has its details move with the surface."""
    for modifier in [one for one in obj.modifiers if one.type == "ARMATURE"]:
        obj.modifiers.remove(modifier)
    found = _armature_modifiers(source)
    for place, modifier in enumerate(found):
        made = obj.modifiers.new(modifier.name, "ARMATURE")
        for name in _ARMATURE_PROPERTIES:
            setattr(made, name, getattr(modifier, name))
        with context.temp_override(object=obj, active_object=obj):
            bpy.ops.object.modifier_move_to_index(modifier=made.name, index=place)
    if source.parent_type == "ARMATURE":
        obj.parent_type = "ARMATURE"
        return len(found) + 1
    return len(found)


def _mark_seams(mesh, source):
    """Seams where the UV map that is the source's active one has them, if the source has seams at all."""
    layer = source.uv_layers.active
    own = mesh.uv_layers.get(layer.name) if layer is not None else None
    if own is None or not meshes.values_of(source.edges, "use_seam", 1, bool).any():
        return
    vertices, edges = (meshes.values_of(mesh.loops, name, 1, numpy.int32) for name in ("vertex_index", "edge_index"))
    following = arrays.following_corners(meshes.mesh_arrays(mesh).offsets)
    marked = arrays.seam_edges(vertices, edges, following, meshes.values_of(*compat.uv_values(own), 2), len(mesh.edges))
    meshes.mark_seams(mesh, marked)


def _copy_properties(source, target):
    """Custom properties with what Blender knows of them; not those that this and other add-ons keep for themselves."""
    for name in source.keys():
        registered = source.bl_rna.properties.get(name)
        if name.startswith(("_", "hybrid_mesh")) or (registered is not None and registered.is_runtime):
            continue
        target[name] = source[name]
        try:
            target.id_properties_ui(name).update_from(source.id_properties_ui(name))
        except TypeError:
            pass  # Of what is no number or text there is nothing to know.


def _count(number, what):
    return f"{number} {what}{'' if number == 1 else 's'}" if number else ""
