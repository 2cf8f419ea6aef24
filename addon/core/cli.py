# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: one `main`, whether it is reached through Blender or through `python3 -m hybrid_mesh`."""

import argparse
import json
import os
import signal
import sys

from . import inputs as input_files
from . import plans
from .batch import Batch, BatchOptions, OutputError
from .native import NativeMissing, explain
from .process import Processes, WorkerFailed, bpy_available
from .settings import COMPONENTS, EFFORTS, FACES, SYMMETRIES, SYMMETRY_SIDES, TOPOLOGIES, RemeshSettings, SettingsError
from .version import VERSION

DONE, FAILED, WRONG_ARGUMENTS, INTERRUPTED = 0, 1, 2, 130
LATER_COMMANDS = ("bench",)
PROGRAM = "hybrid-mesh"


def main(argv=None):
    """Runs the command line and ends the process with its exit code."""
    sys.exit(run(arguments_of_process() if argv is None else argv))


def arguments_of_process():
    """This command line's part of sys.argv: in Blender what follows `--`."""
    bpy = sys.modules.get("bpy")
    if bpy and bpy.app.binary_path:
        return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    return sys.argv[1:]


def run(argv):
    """Does what the arguments say and returns the exit code: 0 done, 1 an input failed (strict: or is poor), 2 wrong arguments, 130 interrupted."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    _interruptible()
    try:
        arguments = _parser().parse_args(_known(list(argv)))
        return arguments.command(arguments)
    except (WrongArguments, SettingsError, input_files.InputsError) as error:
        _fail(str(error))
        return WRONG_ARGUMENTS
    except NativeMissing as error:
        _fail(str(error))
        return FAILED
    except KeyboardInterrupt:
        _fail("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output has gone; nothing more can be said there, also not at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return FAILED
    except SystemExit as end:  # argparse: --help and --version
        return end.code or DONE


class WrongArguments(ValueError):
    pass


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise WrongArguments(f"{message} ({self.prog} --help says more)")


def remesh_settings(options):
    """The RemeshSettings that options of the command `remesh` stand for; raises WrongArguments or SettingsError."""
    return _settings(_parser().parse_args(["remesh", "none", "--output", "none", *options]))


def _settings(arguments):
    return RemeshSettings(
        vertices=arguments.vertices or 0,
        error=arguments.error or 0.0,
        levels=-1 if arguments.levels is None else arguments.levels,
        refinement="adaptive" if arguments.adaptive else "uniform",
        faces=arguments.faces,
        base=arguments.base_quads,
        topology=arguments.topology,
        components=arguments.components,
        remove_noise=arguments.remove_noise,
        stretch_threshold=arguments.stretch,
        semi_regular=arguments.semi_regular,
        features=arguments.features,
        symmetry=arguments.symmetry,
        symmetry_side=arguments.symmetry_side,
        effort=arguments.effort,
        drop_components=arguments.drop_components,
        density=arguments.density or "",
        strict=arguments.strict,
        plan=_read_plan(arguments.plan) if arguments.plan else "",
        seed=arguments.seed,
        threads=arguments.threads,
    ).validate()


def remesh(arguments):
    settings = _settings(arguments)
    outputs = input_files.Outputs(exports=arguments.export, repaired=arguments.export_repaired, blend=arguments.blend, levels=arguments.export_levels)
    if not bpy_available():
        for path in arguments.inputs:
            if input_files.is_scene(path) and not os.path.isdir(path):
                raise WrongArguments(f"{path}: {input_files.needs_blender(path)}")
        if outputs.blend:
            raise WrongArguments("--blend needs Blender; this is Python without Blender")
    options = BatchOptions(arguments.output, settings, outputs, arguments.jobs, arguments.timeout, arguments.resume)
    batch = Batch(options, _show, _fail)
    try:
        return FAILED if batch.run(arguments.inputs) else DONE
    except OutputError as error:
        _fail(str(error))
        return FAILED


def _read_plan(path):
    """The text of a plan's file, which is looked at before anything starts."""
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        plans.parse(text)
    except (OSError, UnicodeDecodeError) as error:
        raise WrongArguments(f"{path}: {explain(error, path)}") from error
    except plans.PlanError as error:
        raise WrongArguments(f"{path}: {error}") from error
    return text


def compare(arguments):
    job = {"kind": "compare", "paths": [arguments.a, arguments.b], "samples": arguments.samples}
    return _answer(job, arguments.timeout, "", lambda answer: _print_json(answer["distance"]))


def info(arguments):
    job = {"kind": "info", "path": arguments.file, "check": arguments.check}

    def show(answer):
        problems = answer.get("problems", [])
        _print_json({**answer["info"], "problems": problems} if arguments.check else answer["info"])
        for problem in problems:
            _fail(f"{arguments.file}: {problem}")
        return FAILED if problems else DONE

    return _answer(job, arguments.timeout, f"{arguments.file}: ", show)


def encode(arguments):
    if arguments.exact and arguments.source:
        raise WrongArguments("--exact keeps the final mesh, --source fits it to the scan: one of them")
    job = {
        "kind": "encode", "path": arguments.file, "output": arguments.output, "bytes": arguments.bytes or 0, "error": arguments.error or 0.0,
        "exact": arguments.exact, "source": arguments.source,
    }  # fmt: skip
    return _answer(job, arguments.timeout, f"{arguments.file}: ", lambda answer: _show(f"{arguments.output}: {answer['bytes']:,} bytes"))


def decode(arguments):
    form = os.path.splitext(arguments.output)[1][1:].lower()
    if form not in input_files.EXPORT_FORMATS:
        raise WrongArguments(f"--output must be a file of a kind that is written ({', '.join(input_files.EXPORT_FORMATS)}), not {arguments.output!r}")
    job = {"kind": "decode", "path": arguments.file, "output": arguments.output, "bytes": arguments.bytes or 0, "level": arguments.level}

    def show(answer):
        _show(f"{arguments.output}: {answer['vertices']:,} vertices, {answer['faces']:,} faces")

    return _answer(job, arguments.timeout, f"{arguments.file}: ", show)


def _answer(job, timeout, label, show):
    processes = Processes()
    try:
        return show(processes.run(job, timeout)) or DONE
    except WorkerFailed as error:
        _fail(f"{label}{error}")
        return FAILED
    finally:
        processes.end()


def _known(argv):
    """The arguments, unless they ask for what this version does not have yet."""
    if argv and argv[0] in LATER_COMMANDS:
        raise WrongArguments(f"{argv[0]} comes with a later version; there are remesh, compare, info, encode and decode")
    return argv


def _parser():
    parser = _Parser(prog=PROGRAM, description="Multiresolution quad remeshing of scans.", allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {VERSION}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)

    command = commands.add_parser("remesh", help="a quad hierarchy of every input", allow_abbrev=False)
    command.set_defaults(command=remesh)
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
    written.add_argument("--export", type=_exports, default=(), metavar="ply,obj", help="write the final mesh in these formats")
    written.add_argument("--export-levels", type=_exports, default=(), metavar="ply,obj", help="write every level too, as NAME.N0.ply, NAME.N1.ply, ...")
    written.add_argument("--export-repaired", action="store_true", help="write the repaired input too")
    written.add_argument("--blend", action="store_true", help="write NAME.blend with the levels (in Blender)")
    running = command.add_argument_group("running")
    running.add_argument("--jobs", type=_whole(1), default=1, metavar="N", help="inputs at once, each in a process of its own (default 1)")
    running.add_argument("--threads", type=_whole(0), default=0, metavar="N", help="threads for each input (default 0: all cores)")
    running.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which an input has failed")
    running.add_argument("--resume", action="store_true", help="skip inputs that are done with the same settings and version")

    command = commands.add_parser("compare", help="distances between two meshes", allow_abbrev=False)
    command.set_defaults(command=compare)
    command.add_argument("a", metavar="A", help="the reference: distances are fractions of its bounding-box diagonal")
    command.add_argument("b", metavar="B")
    command.add_argument("--samples", type=_whole(1), default=200000, metavar="N", help="a direction (default 200000)")
    command.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which it has failed")

    command = commands.add_parser("info", help="what a .hmesh holds", allow_abbrev=False)
    command.set_defaults(command=info)
    command.add_argument("file", metavar="FILE.hmesh")
    command.add_argument("--check", action="store_true", help="verify invariants, topology and every stored map")
    command.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which it has failed")

    command = commands.add_parser("encode", help="a .hmesh as an embedded stream, a few hundred bytes and more", allow_abbrev=False)
    command.set_defaults(command=encode)
    command.add_argument("file", metavar="IN.hmesh")
    command.add_argument("output", metavar="OUT.hmesh", help="connectivity and positions of all levels; maps and settings are left out")
    bounds = command.add_mutually_exclusive_group()
    bounds.add_argument("--bytes", type=_whole(1), metavar="N", help="hard upper bound on the file's size")
    bounds.add_argument(
        "--error", type=_fraction, metavar="E",
        help="the shortest stream with this L2 distance from SCAN or, without --source, from the final mesh, a fraction of the bounding-box diagonal",
    )  # fmt: skip
    command.add_argument("--source", metavar="SCAN", help="the mesh that was remeshed: vertices are moved to where fewer bytes come as close to it (default: to what the maps know of it)")
    command.add_argument("--exact", action="store_true", help="leave all vertices where they are")
    command.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which it has failed")

    command = commands.add_parser("decode", help="a mesh of a .hmesh", allow_abbrev=False)
    command.set_defaults(command=decode)
    command.add_argument("file", metavar="IN.hmesh")
    command.add_argument("--output", required=True, metavar="FILE", help=f"the mesh: {', '.join('.' + form for form in input_files.EXPORT_FORMATS)}")
    command.add_argument("--bytes", type=_whole(1), metavar="N", help="read no more of a stream: a coarser version of all levels")
    command.add_argument("--level", type=_whole(0), metavar="J", help="this level, 0 being the base, instead of the final mesh")
    command.add_argument("--timeout", type=_positive, default=0, metavar="S", help="seconds after which it has failed")

    for name in LATER_COMMANDS:
        commands.add_parser(name, help="(comes with a later version)")
    return parser


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


def _print_json(values):
    _show(json.dumps(values, indent=1, ensure_ascii=False))


def _show(line):
    print(line, flush=True)


def _fail(line):
    print(f"{PROGRAM}: {line}", file=sys.stderr, flush=True)


def _interruptible():
    """Ctrl-C and a polite kill end the run at once; Blender replaces Python's own handler."""
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    except ValueError:
        pass  # Not in the main thread: whoever runs this handles signals.
