# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a remesh as Blender properties, one set for the operator and for the panel."""

import math

import bpy
import numpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ...bridge import density
from ...core import settings as core
from ...core.limits import limits

REFINEMENTS = (
    ("UNIFORM", "Uniform", "One quad size everywhere, irregular vertices at the base domain's only"),
    ("ADAPTIVE", "Adaptive", "Smaller quads where the shape needs them"),
)
FACES = (
    ("QUADS", "Quads", "Pure quads without cracks"),
    ("TRANSITION", "Transition", "N-gons where two sizes meet"),
    ("TRIANGLES", "Triangles", "Triangles where two sizes meet"),
)
BASES = (
    ("AUTO", "Automatic", "Fits the base domain to the vertex budget"),
    ("MIN", "Minimal", "As few base quads as the surface allows"),
    ("GIVEN", "Given", "A given number of base quads"),
)
TOPOLOGIES = (
    ("AUTO", "Automatic", "On finer levels with a minimal base, else in the base"),
    ("LATE", "Late", "Handles, tunnels and boundaries open on the first level whose quads can show them"),
    ("BASE", "In the Base", "The base domain has the surface's topology"),
)
COMPONENTS = (
    ("APART", "Apart", "A base domain for each component"),
    ("JOINED", "Joined", "One base domain for all components, which part on finer levels"),
)
FEATURES = (
    ("AUTO", "Automatic", "Edges at which flat or smooth faces meet at an angle are kept; a scan has none"),
    ("NONE", "None", "No edges are kept"),
    ("ANGLE", "From Angle", "All edges are kept at which the surface turns by a given angle or more"),
)

SYMMETRIES = (
    ("NONE", "None", "The mesh follows the surface on both sides"),
    ("AUTO", "Automatic", "In the plane of the object's Mirror modifier if it has one, else in a plane in which the surface is nearly symmetric, if there is one"),
    ("X", "X", "Across the object's X axis, through its origin"),
    ("Y", "Y", "Across the object's Y axis, through its origin"),
    ("Z", "Z", "Across the object's Z axis, through its origin"),
)
SYMMETRY_SIDES = (
    ("POSITIVE", "Positive", "The surface on the positive side is mirrored"),
    ("NEGATIVE", "Negative", "The surface on the negative side is mirrored"),
    ("AVERAGE", "Average", "The mean of both sides is"),
)
EFFORTS = (
    ("QUICK", "Quick", "Nothing: the first mesh is the result"),
    ("NORMAL", "Normal", "Other bases, and smaller quads where they are needed: a few times, and not of surfaces of which a mesh takes long"),
    ("THOROUGH", "Thorough", "The same more often, and of any surface"),
)

# Blender's whole numbers have 32 bits.
_LARGEST_WHOLE_NUMBER = 2**31 - 1


def _whole(most):
    """The largest whole number up to `most` that a property can hold."""
    return min(most, _LARGEST_WHOLE_NUMBER)


def _below(end):
    """The largest number below `end` that a property can hold."""
    return float(numpy.nextafter(numpy.float32(end), numpy.float32(0)))


def _degrees(radians):
    """Of an angle that a property holds, in single precision: without the digits that it does not have, which would put 175 degrees beyond their bound."""
    return round(math.degrees(radians), 4)


def _density_names(properties, context, text):
    obj = context.object
    return [name for name in density.names_of(obj) if text.lower() in name.lower()] if obj is not None and obj.type == "MESH" else []


# Settings that have a value at which they are off, or the remesh decides: that, and what they are when they are switched on.
OFF = {"vertices": (0, 20000), "error": (0.0, 0.001), "levels": (-1, 3), "drop_components": (0.0, 0.001), "remove_noise": (0.0, 0.01), "threads": (0, 4)}


def _switch(name, description):
    """A property that says whether a setting is on, and switches it. description: what is where it is off."""
    off, on = OFF[name]

    def switch(self, value):
        if value != (getattr(self, name) != off):
            setattr(self, name, on if value else off)

    text = f"Whether this is given; else {description}"
    return BoolProperty(name="Given", description=text, get=lambda self: getattr(self, name) != off, set=switch, options={"SKIP_SAVE"})


class RemeshProperties:
    """Mix-in for whatever has the settings of a remesh as properties."""

    vertices: IntProperty(
        name="Vertices", description="Hard upper bound on the final mesh's vertices; 0 takes as many as the source has", default=20000, min=0,
        max=_whole(limits().most_vertices), soft_max=1_000_000,
    )  # fmt: skip
    density: StringProperty(
        name="Density", description="A vertex group, or a number or colour of points, corners or faces, that makes quads smaller where it is high: edges are a quarter as long where it is 1, "
        "as without where it is 0.5 or a vertex is not in the group, four times as long where it is 0, with as many vertices in all. Adaptive: errors count more where it is high",
        search=_density_names, search_options={"SUGGESTION"},
    )  # fmt: skip
    error: FloatProperty(
        name="Error", description="Stop at this L2 distance, as a fraction of the bounding-box diagonal; 0 for no bound", default=0, min=0,
        max=_below(limits().end_of_error), soft_max=0.5, precision=6, step=0.001,
    )  # fmt: skip
    levels: IntProperty(
        name="Levels", description="Regular levels above the base domain: exactly (uniform) or at most (adaptive); -1 for as many as are needed",
        default=-1, min=-1, max=limits().most_levels,
    )  # fmt: skip
    refinement: EnumProperty(name="Refinement", description="How quad sizes are chosen", items=REFINEMENTS, default="UNIFORM")
    faces: EnumProperty(name="Faces", description="What is made where quads of two sizes meet", items=FACES, default="QUADS")
    base: EnumProperty(name="Base", description="How many quads the base domain has", items=BASES, default="AUTO")
    base_quads: IntProperty(
        name="Base Quads", description="Quads of the base domain", default=300, min=1, max=_whole(limits().most_base_quads), soft_max=5000
    )
    topology: EnumProperty(name="Topology", description="Where handles, tunnels and boundaries open", items=TOPOLOGIES, default="AUTO")
    components: EnumProperty(name="Components", description="What the base domain has of components", items=COMPONENTS, default="APART")
    features: EnumProperty(
        name="Sharp Edges", description="Sharp edges that rows of quads run along, and that stay sharp on every level", items=FEATURES, default="AUTO"
    )
    feature_angle: FloatProperty(
        name="Angle", description="Angle between the normals of two faces from which on the edge between them is sharp", subtype="ANGLE",
        default=math.radians(40), min=math.radians(limits().least_feature_angle), max=math.radians(limits().most_feature_angle),
    )  # fmt: skip
    symmetry: EnumProperty(name="Symmetry", description="Whether the mesh is its own mirror image, vertex by vertex", items=SYMMETRIES, default="NONE")
    symmetry_side: EnumProperty(name="Side", description="What is mirrored", items=SYMMETRY_SIDES, default="POSITIVE")
    stretch: FloatProperty(
        name="Stretch", description="Grow skin where the map is stretched more than this", default=4, min=limits().least_stretch_threshold,
        max=limits().most_stretch_threshold, soft_max=20,
    )  # fmt: skip
    semi_regular: BoolProperty(name="Semi-Regular", description="No irregular operations: the topology and layout of the base domain on every level")
    effort: EnumProperty(name="Effort", description="What is tried where the first mesh is poor", items=EFFORTS, default="NORMAL")
    drop_components: FloatProperty(
        name="Drop Components", description="Remove components with less than this fraction of the whole area", default=0, min=0,
        max=_below(limits().end_of_drop_components), soft_max=0.99, precision=4,
    )  # fmt: skip
    remove_noise: FloatProperty(
        name="Remove Noise", description="Close handles and tunnels for good whose loop is shorter than this fraction of the bounding-box diagonal",
        default=0, min=0, max=_below(limits().end_of_remove_noise), soft_max=0.1, precision=4, step=0.1,
    )  # fmt: skip
    strict: BoolProperty(name="Strict", description="Refuse a surface that needs repair instead of repairing it, and take a poor result for an error")
    seed: IntProperty(name="Seed", description="Of what is arbitrary", default=1, min=0, max=_whole(limits().most_seed))
    threads: IntProperty(name="Threads", description="0 for all cores; never changes the result", default=0, min=0, max=limits().most_threads)


CUBES = IntProperty(
    name="Cubes", description="Cubes of the chain on the boundary that the base domain is; 0 for as many as make their sides square", default=0, min=0,
    max=limits().most_cubes, soft_max=20,
)  # fmt: skip
SETTING_NAMES = tuple(RemeshProperties.__annotations__)


class RemeshSwitches:
    """Mix-in beside RemeshProperties: what is shown in the place of values that mean "off". None of them is a setting."""

    use_vertices: _switch("vertices", "as many vertices as the source has")
    use_error: _switch("error", "there is no bound on the distance")
    use_levels: _switch("levels", "as many levels as are needed")
    use_drop_components: _switch("drop_components", "all components are kept")
    use_remove_noise: _switch("remove_noise", "all handles and tunnels are kept")
    use_threads: _switch("threads", "all cores")


class HybridMeshScene(RemeshSwitches, RemeshProperties, bpy.types.PropertyGroup):
    hide_source: BoolProperty(name="Hide Source", description="Hide the source in viewports and renders, so that the result is seen in its place", default=True)
    cubes: CUBES


def core_settings(properties):
    """The RemeshSettings that properties stand for; raises SettingsError."""
    return core.RemeshSettings(
        vertices=properties.vertices,
        error=properties.error,
        levels=properties.levels,
        refinement=properties.refinement.lower(),
        faces=properties.faces.lower(),
        base=properties.base_quads if properties.base == "GIVEN" else properties.base.lower(),
        topology=properties.topology.lower(),
        components=properties.components.lower(),
        features=_degrees(properties.feature_angle) if properties.features == "ANGLE" else properties.features.lower(),
        symmetry=properties.symmetry.lower(),
        symmetry_side=properties.symmetry_side.lower(),
        effort=properties.effort.lower(),
        remove_noise=properties.remove_noise,
        stretch_threshold=properties.stretch,
        semi_regular=properties.semi_regular,
        drop_components=properties.drop_components,
        density=properties.density,
        strict=properties.strict,
        seed=properties.seed,
        threads=properties.threads,
    ).validate()


def apply_settings(properties, settings):
    """Sets properties to RemeshSettings."""
    given, angle = not isinstance(settings.base, str), not isinstance(settings.features, str)
    properties.vertices = settings.vertices
    properties.error = settings.error
    properties.levels = settings.levels
    properties.refinement = settings.refinement.upper()
    properties.faces = settings.faces.upper()
    properties.base = "GIVEN" if given else settings.base.upper()
    if given:
        properties.base_quads = settings.base
    properties.topology = settings.topology.upper()
    properties.components = settings.components.upper()
    properties.features = "ANGLE" if angle else settings.features.upper()
    if angle:
        properties.feature_angle = math.radians(settings.features)
    properties.symmetry = settings.symmetry.upper()
    properties.symmetry_side = settings.symmetry_side.upper()
    properties.effort = settings.effort.upper()
    properties.remove_noise = settings.remove_noise
    properties.stretch = settings.stretch_threshold
    properties.semi_regular = settings.semi_regular
    properties.drop_components = settings.drop_components
    properties.density = settings.density
    properties.strict = settings.strict
    properties.seed = settings.seed
    properties.threads = settings.threads


def draw_settings(layout, properties):
    column = _column(layout)
    column.prop(properties, "refinement", expand=True)
    _draw_switched(column, properties, "vertices")
    column.prop(properties, "density")
    _draw_switched(column, properties, "error")
    _draw_switched(column, properties, "levels")
    if properties.refinement == "ADAPTIVE":
        column.prop(properties, "faces")


def draw_advanced(layout, properties):
    for title, draw in (("Base and Topology", _draw_base), ("Edges and Symmetry", _draw_shape), ("Repair", _draw_repair), ("Run", _draw_run)):
        box = layout.box()
        box.label(text=title)
        draw(_column(box), properties)


def _column(layout):
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout.column()


def _draw_switched(column, properties, name):
    """A setting with its switch; where it is off, *Auto* in the place of the value that means so."""
    row = column.row(align=True, heading=properties.bl_rna.properties[name].name)
    if getattr(properties, f"use_{name}"):
        row.prop(properties, f"use_{name}", text="")
        row.prop(properties, name, text="")
    else:
        row.prop(properties, f"use_{name}", text="Auto")


def _draw_base(column, properties):
    column.prop(properties, "base")
    if properties.base == "GIVEN":
        column.prop(properties, "base_quads")
    column.prop(properties, "topology")
    column.prop(properties, "components")
    column.prop(properties, "stretch")
    column.prop(properties, "semi_regular")


def _draw_shape(column, properties):
    column.prop(properties, "features")
    if properties.features == "ANGLE":
        column.prop(properties, "feature_angle")
    column.prop(properties, "symmetry")
    if properties.symmetry != "NONE":
        column.prop(properties, "symmetry_side")


def _draw_repair(column, properties):
    _draw_switched(column, properties, "drop_components")
    _draw_switched(column, properties, "remove_noise")
    column.prop(properties, "strict")


def _draw_run(column, properties):
    column.prop(properties, "effort")
    column.prop(properties, "seed")
    _draw_switched(column, properties, "threads")


PROPERTIES = ((bpy.types.Scene, "hybrid_mesh", HybridMeshScene),)
