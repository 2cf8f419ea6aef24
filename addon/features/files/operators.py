# SPDX-License-Identifier: GPL-3.0-or-later
import os
import traceback

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...bridge import objects, view
from ...bridge.names import readable
from ...core import hierarchy_files
from ...core.native import expected, explain
from ...jobs import NativeJobOperator
from ..display import properties as display_properties
from ..levels import properties as hierarchy_properties
from . import exporting, importing

_MOST = 2**31 - 1  # Blender's whole numbers have 32 bits
LABEL = "Hybrid Mesh (.hmesh)"

PARTS = (
    ("WHOLE", "Whole", "All of a stream is read"),
    ("PREFIX", "First Bytes", "Of a stream so many bytes are read as are given: a coarser version of the same"),
)
FORMATS = (
    ("CONTAINER", "Container", "All levels with their maps, exactly as they are"),
    ("STREAM", "Stream", "Compressed, without maps: every part of the file from its start on is a coarser version of the same"),
)
BOUNDS = (
    ("NONE", "Whole", "All details"),
    ("BYTES", "Bytes", "No more bytes than are given"),
    ("ERROR", "Error", "No more bytes than it takes for an L2 distance"),
)


class HYBRID_MESH_OT_import_hmesh(bpy.types.Operator, ImportHelper):
    """Make the level objects of hybrid mesh files, containers or streams"""

    bl_idname = "hybrid_mesh.import_hmesh"
    bl_label = "Import Hybrid Mesh"
    bl_options = {"REGISTER", "UNDO", "PRESET"}

    filename_ext = hierarchy_files.EXTENSION
    filter_glob: StringProperty(default="*" + hierarchy_files.EXTENSION, options={"HIDDEN"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    part: EnumProperty(name="Streams", description="What is read of streams; containers are read whole", items=PARTS, default="WHOLE")
    most_bytes: IntProperty(name="Bytes", description="How many bytes are read of each stream", default=4000, min=1, max=_MOST, soft_max=1_000_000)

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        self.layout.prop(self, "part")
        if self.part == "PREFIX":
            self.layout.prop(self, "most_bytes")

    def execute(self, context):
        view.to_object_mode(context)
        built, errors = [], []
        with view.waiting(context):
            for path in self._paths():
                try:
                    built.append(importing.import_file(context, path, self.most_bytes if self.part == "PREFIX" else 0))
                except Exception as error:
                    errors.append(_line(error, path))
        if built:
            view.select_only(context, *(one.preview for one in built))
        for one in built:
            display_properties.show(context, one.collection)
            report = hierarchy_properties.report_of(one.collection)
            self.report({"INFO"}, f"{one.collection.name}: {len(one.levels)} levels, {report['final']['vertices']:,} vertices")
        if errors:
            self.report({"ERROR"}, "\n".join(errors))
        return {"FINISHED"} if built else {"CANCELLED"}

    def _paths(self):
        names = [file.name for file in self.files if file.name]
        return [bpy.path.abspath(os.path.join(self.directory, name)) for name in names] or [bpy.path.abspath(self.filepath)]


class HYBRID_MESH_OT_export_hmesh(ExportHelper, NativeJobOperator):
    """Write the active hybrid mesh to a file"""

    bl_idname = "hybrid_mesh.export_hmesh"
    bl_label = "Export Hybrid Mesh"
    bl_options = {"PRESET"}

    filename_ext = hierarchy_files.EXTENSION
    filter_glob: StringProperty(default="*" + hierarchy_files.EXTENSION, options={"HIDDEN"})
    kind: EnumProperty(name="Format", description="What is written", items=FORMATS, default="CONTAINER")
    bound: EnumProperty(name="Bound", description="How much of the stream is written", items=BOUNDS, default="NONE")
    most_bytes: IntProperty(name="Bytes", description="Hard upper bound on the file's size", default=4000, min=1, max=_MOST, soft_max=1_000_000)
    error: FloatProperty(
        name="Error", description="The shortest stream with this L2 distance from the final mesh, a fraction of the diagonal, is written",
        default=1e-3, min=1e-7, max=0.5, soft_max=0.05, precision=6, step=0.001,
    )  # fmt: skip
    exact: BoolProperty(
        name="Keep Vertices", default=False,
        description="Leave all vertices where they are. Else they are moved to where fewer bytes come as close to the surface that the maps know of",
    )  # fmt: skip

    _browsed = False
    _edited = ()  # names of objects with what the file does not have

    @classmethod
    def poll(cls, context):
        if hierarchy_properties.hierarchy_of(objects.active(context)) is None:
            cls.poll_message_set("Make a hybrid mesh the active object: a level, the preview, or the object that was remeshed")
            return False
        return True

    def invoke(self, context, event):
        collection = hierarchy_properties.hierarchy_of(objects.active(context))
        folder = os.path.dirname(bpy.data.filepath)
        self.filepath = os.path.join(folder, bpy.path.clean_name(hierarchy_properties.name_of(collection)) + self.filename_ext)
        self._browsed = True
        return super().invoke(context, event)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "kind", expand=True)
        if self.kind == "STREAM":
            layout.prop(self, "bound")
            if self.bound == "BYTES":
                layout.prop(self, "most_bytes")
            if self.bound == "ERROR":
                layout.prop(self, "error")
            layout.prop(self, "exact")

    def execute(self, context):
        if self.kind == "STREAM":
            return self.run_modal(context) if self._browsed and not bpy.app.background else super().execute(context)
        collection, path = self._chosen(context)
        try:
            exporting.save_container(collection, path)
        except Exception as error:
            self.report({"ERROR"}, _line(error, path))
            return {"CANCELLED"}
        self._conclude_with(path)
        return {"FINISHED"}

    def prepare(self, context):
        collection, path = self._chosen(context)
        most_bytes, error = self.most_bytes if self.bound == "BYTES" else 0, self.error if self.bound == "ERROR" else 0.0
        return [exporting.stream_task(collection, path, most_bytes, error, self.exact)]

    def finish(self, context, results):
        self._conclude_with(bpy.path.abspath(self.filepath))

    def _chosen(self, context):
        collection = hierarchy_properties.hierarchy_of(objects.active(context))
        self._edited = exporting.not_carried(collection)
        return collection, bpy.path.abspath(self.filepath)

    def _conclude_with(self, path):
        for name in self._edited:
            self.report({"WARNING"}, f"{name} was edited since the levels were last updated; the file does not have that")
        self.report({"INFO"}, f"{readable(os.path.basename(path))}: {os.path.getsize(path):,} bytes{self._asked_for()}")

    def _asked_for(self):
        if self.kind == "CONTAINER" or self.bound == "NONE":
            return ""
        return f", no more than {self.most_bytes:,} asked for" if self.bound == "BYTES" else f", for an error of {self.error:.3g}"


def import_entry(menu, context):
    menu.layout.operator(HYBRID_MESH_OT_import_hmesh.bl_idname, text=LABEL)


def export_entry(menu, context):
    menu.layout.operator(HYBRID_MESH_OT_export_hmesh.bl_idname, text=LABEL)


# Which menus of Blender's have which entries.
MENUS = ((bpy.types.TOPBAR_MT_file_import, import_entry), (bpy.types.TOPBAR_MT_file_export, export_entry))


def _line(error, path):
    """One line for people that names the file; the console gets the rest of what was not foreseen."""
    if not isinstance(error, OSError) and not expected(error):
        traceback.print_exception(error)
    return readable(f"{os.path.basename(path)}: {explain(error, path)}")
