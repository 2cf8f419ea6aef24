# SPDX-License-Identifier: GPL-3.0-or-later
"""The arguments of the command line: which commands there are, what each takes, and what is wrong with what was given."""

import argparse

from . import inputs as input_files
from .settings import COMPONENTS, EFFORTS, FACES, SYMMETRIES, SYMMETRY_SIDES, TOPOLOGIES
from .version import VERSION

LATER_COMMANDS = ("bench",)
PROGRAM = "hybrid-mesh"


class WrongArguments(ValueError):
    pass


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise WrongArguments(f"{message} ({self.prog} --help says more)")


def parser():
    """The parser; what it parses has the command's name as `command`."""
    made = _Parser(prog=PROGRAM, description="Multiresolution quad remeshing of scans.", allow_abbrev=False)
    made.add_argument("--version", action="version", version=f"{PROGRAM} {VERSION}")
    commands = made.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    for add in (_add_remesh, _add_task, _add_merge_reports, _add_compare, _add_info, _add_encode, _add_decode):
        add(commands)
    for name in LATER_COMMANDS:
        commands.add_parser(name, help="(comes with a later version)")
    return made


def _add_remesh(commands):
    command = commands.add_parser("remesh", help="a quad hierarchy of every input", allow_abbrev=False)
    command.set_defaults(command="remesh")
    command.add_argument("inputs", nargs="+", metavar="INPUT", help=f"{', '.join(input_files.MESH_EXTENSIONS)}; in Blender also {', '.join(input_files.SCENE_EXTENSIONS)} (each mesh object is an input); or a folder with such files")
    command.add_argument("--output", required=True, metavar="DIR", help="folder for NAME.hmesh, NAME.plan.json, NAME.report.json and summary.csv; of inputs of one name the second one, by path, is NAME-2")
    bounds = command.add_argument_group("bounds", "without any, the remesh has as many vertices as the input")
    bounds.add_argument("--vertices", type=_whole(1), metavar="N", help="hard upper bound on the final mesh's vertices")
    bounds.add_argument("--error", type=_positive, metavar="E", help="stop at this L2 distance, a fraction of the bounding-box diagonal")
    bounds.add_argument("--levels", type=_whole(0), metavar="N", help="exactly (with --adaptive: at most) so many regular levels")
    shape = command.add_argument_group("quads")
    shape.add_argument("--adaptive", action="store_true", help="smaller quads where the shape needs them; else one size everywhere")
    shape.add_argument("--faces", choices=FACES, default="quads", help="adaptive: pure quads (default), n-gons or triangles where sizes meet")
    shape.add_argument("--base-quads", type=_base, default="auto", metavar="auto|min|N", help="quads of the base domain (default auto: fits the budget)")
    shape.add_argument(
        "--topology", choices=TOPOLOGIES, default="auto",
        help="handles, tunnels and boundaries open on finer levels (late) or in the base; default auto: late with a minimal base",
    )  # fmt: skip
    shape.add_argument("--components", choices=COMPONENTS, default="apart", help="joined: one base for all, late topology parts them (default apart)")
    shape.add_argument(
        "--features", type=_features, default="auto", metavar="auto|DEG|none",
        help="sharp edges that are kept: auto, where flat or smooth faces meet at them (default); all from an angle in degrees on; or none",
    )
    shape.add_argument(
        "--density", type=_name, metavar="NAME",
        help="a property of a .ply's vertices ('color': the brightness of red, green and blue), or in Blender a vertex group, or an attribute of points, corners or faces, that "
        "says how small quads are: edges are 4^(1 - 2 v) times as long where its value is v, a quarter at 1, as without at 0.5, four times at 0; as many vertices "
        "in all; adaptive: errors count more where it is high",
    )  # fmt: skip
    shape.add_argument(
        "--symmetry", type=_symmetry, default="none", metavar="auto|x|y|z|none|NX,NY,NZ,D",
        help="a mesh that is its own mirror image: in the plane where x (y, z) is 0, in the plane with that normal and offset, or in one that is found (auto)",
    )  # fmt: skip
    shape.add_argument("--symmetry-side", choices=SYMMETRY_SIDES, default="positive", help="what is mirrored: the side that the normal points to (default), the other, or the average of both")
    shape.add_argument("--stretch", type=float, default=4.0, metavar="X", help="grow skin where the map is stretched more than this (default 4)")
    shape.add_argument("--plan", metavar="FILE.json", help="take base quads and irregular operations from a plan, as NAME.plan.json of another remesh")
    shape.add_argument("--semi-regular", action="store_true", help="no irregular operations")
    shape.add_argument("--seed", type=_whole(0), default=1, metavar="N", help="of what is arbitrary (default 1)")
    shape.add_argument("--effort", choices=EFFORTS, default="normal", help="what is tried where the first mesh is poor: nothing, other bases and smaller quads (default), or more of both")
    surface = command.add_argument_group("input surface")
    surface.add_argument("--drop-components", type=float, default=0.0, metavar="AREA", help="remove components below this fraction of the area")
    surface.add_argument(
        "--remove-noise", type=float, default=0.0, metavar="LENGTH", help="close handles with a loop shorter than this fraction of the diagonal for good"
    )
    surface.add_argument("--strict", action="store_true", help="refuse input that needs repair; a poor result has failed, though its files are written")
    written = command.add_argument_group("output")
    written.add_argument("--export", type=_exports, default=(), metavar="ply,obj,glb", help="write the final mesh in these formats; .glb has its attributes and the patches' UV map, in triangles")
    written.add_argument("--export-levels", type=_exports, default=(), metavar="ply,obj,glb", help="write every level too, as NAME.N0.ply, NAME.N1.ply, ...; glb: all as levels of detail in NAME.levels.glb")
    written.add_argument("--export-repaired", action="store_true", help="write the repaired input too")
    written.add_argument("--blend", action="store_true", help="write NAME.blend with the levels (in Blender)")
    running = command.add_argument_group("running")
    running.add_argument("--jobs", type=_whole(1), default=1, metavar="N", help="inputs at once, each in a process of its own (default 1)")
    running.add_argument("--threads", type=_whole(0), default=0, metavar="N", help="threads for each input (default 0: all cores)")
    running.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which an input has failed")
    _add_progress(running)
    running.add_argument("--resume", action="store_true", help="skip inputs that are done with the same settings and version")
    running.add_argument("--farm", action="store_true", help="do nothing yet: write DIR/batch.json, of which a render farm does each input as a task and then merges the reports")


def _add_task(commands):
    command = commands.add_parser("task", help="one input of a batch, as a render farm runs it", allow_abbrev=False)
    command.set_defaults(command="task")
    _add_batch(command)
    command.add_argument("number", type=_whole(1), metavar="N", help="which input, from 1; one that is done is left alone")
    command.add_argument("--threads", type=_whole(0), metavar="N", help="threads on this machine, if not those that the batch was made with")
    _add_progress(command)


def _add_merge_reports(commands):
    command = commands.add_parser("merge-reports", help="the summary of a batch whose tasks are done", allow_abbrev=False)
    command.set_defaults(command="merge-reports")
    _add_batch(command)


def _add_batch(command):
    command.add_argument("batch", metavar="BATCH.json", help="what remesh --farm has written; outputs go into its folder")


def _add_compare(commands):
    command = commands.add_parser("compare", help="distances between two meshes", allow_abbrev=False)
    command.set_defaults(command="compare")
    command.add_argument("a", metavar="A", help="the reference: distances are fractions of its bounding-box diagonal")
    command.add_argument("b", metavar="B", help="the other mesh, of any kind that can be read")
    command.add_argument("--samples", type=_whole(1), default=200000, metavar="N", help="a direction (default 200000)")
    _add_timeout(command)


def _add_info(commands):
    command = commands.add_parser("info", help="what a .hmesh holds", allow_abbrev=False)
    command.set_defaults(command="info")
    command.add_argument("file", metavar="FILE.hmesh", help="a hierarchy or a stream")
    command.add_argument("--check", action="store_true", help="verify invariants, topology and every stored map")
    _add_timeout(command)


def _add_encode(commands):
    command = commands.add_parser("encode", help="a .hmesh as an embedded stream, a few hundred bytes and more", allow_abbrev=False)
    command.set_defaults(command="encode")
    command.add_argument("file", metavar="IN.hmesh", help="a hierarchy, or where it is read a stream")
    command.add_argument("output", metavar="OUT.hmesh", help="connectivity and positions of all levels; maps and settings are left out")
    bounds = command.add_mutually_exclusive_group()
    bounds.add_argument("--bytes", type=_whole(1), metavar="N", help="hard upper bound on the file's size")
    bounds.add_argument(
        "--error", type=_fraction, metavar="E",
        help="the shortest stream with this L2 distance from SCAN or, without --source, from the final mesh, a fraction of the bounding-box diagonal",
    )  # fmt: skip
    command.add_argument("--source", metavar="SCAN", help="the mesh that was remeshed: vertices are moved to where fewer bytes come as close to it (default: to what the maps know of it)")
    command.add_argument("--exact", action="store_true", help="leave all vertices where they are")
    _add_timeout(command)


def _add_decode(commands):
    command = commands.add_parser("decode", help="a mesh of a .hmesh", allow_abbrev=False)
    command.set_defaults(command="decode")
    command.add_argument("file", metavar="IN.hmesh", help="a hierarchy, or where it is read a stream")
    command.add_argument("--output", required=True, metavar="FILE", help=f"the mesh: {', '.join('.' + form for form in input_files.MESH_FORMATS)}")
    command.add_argument("--bytes", type=_whole(1), metavar="N", help="read no more of a stream: a coarser version of all levels")
    command.add_argument("--level", type=_whole(0), metavar="J", help="this level, 0 being the base, instead of the final mesh")
    _add_timeout(command)


def _add_timeout(command):
    command.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which it has failed")


def _add_progress(command):
    command.add_argument(
        "--progress", choices=("auto", "lines", "openjd", "none"), default="auto",
        help="how far inputs are: auto, in one line as long as stderr is a terminal (default); lines, one a tenth of an input; openjd, as Open Job Description reads it; none",
    )  # fmt: skip


def _whole(least):
    def parse(text):
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if value < least:
            raise argparse.ArgumentTypeError(f"must be a whole number of at least {least}, not {text!r}")
        return value

    return parse


def _positive(text):
    try:
        value = float(text)
    except ValueError:
        value = 0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"must be a number above 0, not {text!r}")
    return value


def _fraction(text):
    value = _positive(text)
    if value >= 1:
        raise argparse.ArgumentTypeError(f"must be a fraction below 1, not {text!r}")
    return value


def _name(text):
    if not text:
        raise argparse.ArgumentTypeError("must be the name of an attribute")
    return text


def _features(text):
    if text in ("auto", "none"):
        return text
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be auto, none or an angle in degrees, not {text!r}") from None


def _symmetry(text):
    if text in SYMMETRIES:
        return text
    try:
        numbers = tuple(float(number) for number in text.split(","))
        if len(numbers) == 4:
            return numbers
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"must be {', '.join(SYMMETRIES)} or a plane NX,NY,NZ,OFFSET, not {text!r}")


def _base(text):
    return text if text in ("auto", "min") else _whole_or_word(text)


def _whole_or_word(text):
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be auto, min or a whole number, not {text!r}") from None


def _exports(text):
    formats = tuple(dict.fromkeys(text.lower().split(",")))
    for form in formats:
        if form not in input_files.EXPORT_FORMATS:
            raise argparse.ArgumentTypeError(f"knows {', '.join(input_files.EXPORT_FORMATS)}, not {form!r}")
    return formats
