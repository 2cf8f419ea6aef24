# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch for a render farm: a file that says what there is to do, tasks that do an input each on whatever machine, and the summary of what they did.

There is no scheduler here: the farm starts the tasks, starts one again whose worker has died, and starts the merge when all are done. So a task may be started any number of
times, also twice at once: it leaves a record when its outputs are complete, which a later start finds; outputs and record appear by renames, and are the same
whoever writes them.
"""

import json
import os
import uuid
from dataclasses import asdict, dataclass

from . import inputs as input_files
from . import settings as settings_module
from .batch import Batch, BatchOptions, OutputError
from .native import NativeMissing, explain, native
from .process import bpy_available
from .report import summary_row
from .version import VERSION
from .worker import write_text

FORMAT, FORMAT_VERSION = "hybrid-mesh batch", 1
FILE = "batch.json"
RECORDS = "batch.tasks"  # the folder of the tasks' records, beside it


class FarmError(ValueError):
    """A batch that cannot be worked on."""


@dataclass
class FarmBatch:
    id: str
    options: BatchOptions
    items: list

    def record(self, number):
        return os.path.join(self.options.folder, RECORDS, f"{number}.json")


def write(options, items):
    """Writes the file of a batch into the folder of its outputs and returns its path. Inputs are named from there, so that machines may have the folder at places of their own."""
    folder = os.path.realpath(options.folder)
    content = {
        "format": FORMAT, "format_version": FORMAT_VERSION, "version": VERSION, "id": uuid.uuid4().hex,
        "settings": options.settings.native(), "outputs": {name: value for name, value in asdict(options.outputs).items() if name != "report"},
        "timeout": options.timeout,
        "names": [item.name for item in items],
        "inputs": [{"path": item.path, "file": _from(folder, item.path), "object": item.object_name, "error": item.error} for item in items],
    }  # fmt: skip
    path = os.path.join(options.folder, FILE)
    try:
        os.makedirs(os.path.join(options.folder, RECORDS), exist_ok=True)
        _write_whole(path, content)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {explain(error, path)}") from error
    return path


def read(path):
    """The FarmBatch in a file; raises FarmError."""
    try:
        with open(path, encoding="utf-8", errors="surrogateescape") as file:
            content = json.load(file)
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            raise FarmError(f"{path}: is not the file of a batch, which remesh --farm writes")
        if (content["format_version"], content["version"]) != (FORMAT_VERSION, VERSION):
            raise FarmError(f"{path}: is of version {content['version']}, this is {VERSION}; all machines need the same, or the results would not be")
        folder = os.path.dirname(os.path.abspath(path))
        outputs = input_files.Outputs(**{name: tuple(value) if isinstance(value, list) else value for name, value in content["outputs"].items()})
        options = BatchOptions(folder, settings_module.from_mapping(content["settings"]), outputs, timeout=content["timeout"], resume=True)
        real = os.path.realpath(folder)
        items = []
        for name, entry in zip(content["names"], content["inputs"], strict=True):
            item = input_files.Input(os.path.join(real, *entry["file"].split("/")), name, entry["object"], error=entry["error"], shown=entry["path"])
            items.append(item)
        return FarmBatch(content["id"], options, items)
    except OSError as error:
        raise FarmError(f"{path}: {explain(error, path)}") from error
    except FarmError:
        raise
    except (ValueError, TypeError, KeyError) as error:
        raise FarmError(f"{path}: is no whole file of a batch ({explain(error)})") from error


def do_task(batch, number, console):
    """Does input `number`, from 1, unless that is done. Raises FarmError, OutputError, NativeMissing, and WorkerKilled where another try may do it.

    An input that cannot be remeshed is done, too: its record and its report say why, and the farm need not try it again.
    """
    if not 1 <= number <= len(batch.items):
        raise FarmError(f"there is no input {number} in a batch of {len(batch.items)}")
    item = batch.items[number - 1]
    if _row(batch, number):
        console.show(f"{item.label}: done before, skipped")
        return
    # A machine on which no input can be done must not take one for bad.
    native()
    if (batch.options.outputs.blend or input_files.is_scene(item.path)) and not item.error and not bpy_available():
        raise NativeMissing(f"{item.label}: input {number} needs Blender; this is Python without Blender")
    row = Batch(batch.options, console).run_one(item, f"task{number}")
    if row["status"] == "skipped":
        row["status"] = "done"  # by an earlier batch, or by a worker that died before it could leave its record
    try:
        os.makedirs(os.path.dirname(batch.record(number)), exist_ok=True)
        _write_whole(batch.record(number), {"batch": batch.id, "row": row})
    except OSError as error:
        raise OutputError(f"cannot write {batch.record(number)}: {explain(error)}") from error


def merge(batch, console):
    """Writes summary.csv of the tasks' records and returns its rows; each input that failed, or that no task has finished, is named on the console."""
    rows = []
    for number, item in enumerate(batch.items, 1):
        row = _row(batch, number) or summary_row(item.name, item.label, "failed", error="no task has finished it")
        if row["status"] == "failed":
            console.fail(f"{item.label}: {row['error']}")
        rows.append(row)
    Batch(batch.options, console).summarize(rows)
    return rows


def _row(batch, number):
    """What the record of a task says, or None; one of an earlier batch in the same folder says nothing."""
    try:
        with open(batch.record(number), encoding="utf-8", errors="surrogateescape") as file:
            record = json.load(file)
        return record["row"] if record["batch"] == batch.id else None
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _from(folder, path):
    """A path from a folder, with slashes; the whole path where there is no way, as from drive to drive."""
    # The link itself, not what it leads to, since its name says what kind of file it is.
    place = os.path.join(os.path.realpath(os.path.dirname(os.path.abspath(path))), os.path.basename(os.path.abspath(path)))
    try:
        return os.path.relpath(place, folder).replace(os.sep, "/")
    except ValueError:
        return place


def _write_whole(path, content):
    temporary = f"{path}.{uuid.uuid4().hex}"
    try:
        write_text(temporary, json.dumps(content, indent=1, ensure_ascii=False) + "\n")
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.unlink(temporary)
