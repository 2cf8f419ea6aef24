# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts objects where another object stands."""


def same_place(source):
    """A function that gives an object the transform and parent of `source`."""

    def place(obj):
        obj.rotation_mode = source.rotation_mode
        if source.parent is not None:
            obj.parent = source.parent
            obj.parent_type = source.parent_type
            if source.parent_type == "BONE":
                obj.parent_bone = source.parent_bone
            elif source.parent_type in {"VERTEX", "VERTEX_3"}:
                obj.parent_vertices = source.parent_vertices
            obj.matrix_parent_inverse = source.matrix_parent_inverse
        for name in ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale"):
            setattr(obj, name, getattr(source, name))
        for name in ("delta_location", "delta_rotation_euler", "delta_rotation_quaternion", "delta_scale"):
            setattr(obj, name, getattr(source, name))
        if source.constraints or _animated(source):
            # Where something else moves the source, the place where it stands now is what was measured.
            obj.matrix_world = source.matrix_world

    return place


def _animated(obj):
    data = obj.animation_data
    return data is not None and bool(data.drivers)
