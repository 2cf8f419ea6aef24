# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: one `main`, whether it is reached through Blender or through `python3 -m hybrid_mesh`."""

import json
import os
import signal
import sys
from dataclasses import replace

from . import farm, plans
from . import inputs as input_files
from .arguments import LATER_COMMANDS, PROGRAM, WrongArguments, parser
from .batch import Batch, BatchOptions, OutputError, counts
from .console import Console
from .native import NativeMissing, explain
from .process import Processes, WorkerFailed, bpy_available
from .settings import RemeshSettings, SettingsError

DONE, FAILED, WRONG_ARGUMENTS, INTERRUPTED = 0, 1, 2, 130


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
        arguments = parser().parse_args(_known(list(argv)))
        return COMMANDS[arguments.command](arguments)
    except (WrongArguments, SettingsError, input_files.InputsError, farm.FarmError) as error:
        _fail(str(error))
        return WRONG_ARGUMENTS
    except (NativeMissing, OutputError, WorkerFailed) as error:
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


def remesh_settings(options):
    """The RemeshSettings that options of the command `remesh` stand for; raises WrongArguments or SettingsError."""
    return _settings(parser().parse_args(["remesh", "none", "--output", "none", *options]))


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
    batch = Batch(options, Console(arguments.progress))
    if arguments.farm:
        items = batch.inputs(arguments.inputs)
        path = farm.write(options, items)
        _show(f"{path}: {len(items)} input{'s' if len(items) > 1 else ''}, none of them done; {PROGRAM} task {path} N does one, {PROGRAM} merge-reports {path} is for when all are")
        return DONE
    return FAILED if batch.run(arguments.inputs) else DONE


def task(arguments):
    batch = farm.read(arguments.batch)
    if arguments.threads is not None:
        batch.options.settings = replace(batch.options.settings, threads=arguments.threads).validate()
    farm.do_task(batch, arguments.number, Console(arguments.progress))
    return DONE


def merge_reports(arguments):
    batch = farm.read(arguments.batch)
    rows = farm.merge(batch, Console("none"))
    _show(counts(rows))
    return FAILED if any(row["status"] == "failed" for row in rows) else DONE


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
    if form not in input_files.MESH_FORMATS:
        raise WrongArguments(f"--output must be a file of a kind that is written ({', '.join(input_files.MESH_FORMATS)}), not {arguments.output!r}")
    job = {"kind": "decode", "path": arguments.file, "output": arguments.output, "bytes": arguments.bytes or 0, "level": arguments.level}

    def show(answer):
        _show(f"{arguments.output}: {answer['vertices']:,} vertices, {answer['faces']:,} faces")

    return _answer(job, arguments.timeout, f"{arguments.file}: ", show)


COMMANDS = {
    "remesh": remesh, "task": task, "merge-reports": merge_reports, "compare": compare, "info": info, "encode": encode, "decode": decode,
}  # fmt: skip


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
        raise WrongArguments(f"{argv[0]} comes with a later version; there are {', '.join(COMMANDS)}")
    return argv


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
