# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch of inputs: each in a process of its own, outputs that appear complete or not at all, and a summary."""

import contextlib
import json
import os
import shutil
import tempfile
import threading
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from dataclasses import dataclass

from . import inputs as input_files
from . import report as reports
from .native import explain
from .process import Processes, WorkerFailed, WorkerKilled, bpy_available
from .settings import RemeshSettings
from .version import VERSION
from .worker import write_text


@dataclass
class BatchOptions:
    folder: str  # where the outputs go
    settings: RemeshSettings
    outputs: input_files.Outputs
    jobs: int = 1  # inputs at once
    timeout: float = 0  # seconds an input; 0 = none
    resume: bool = False  # leave out inputs that are done


class OutputError(OSError):
    """The output folder cannot be used; nothing has been started."""


def counts(rows):
    """The last line of a batch: nobody reads the lines of a hundred inputs."""
    count, poor = len(rows), sum(row["verdict"] == "poor" for row in rows)
    failed = sum(row["status"] == "failed" for row in rows)
    return f"{count} input{'s' if count > 1 else ''}: {count - failed} done, {failed} failed; {poor} poor result{'s' if poor != 1 else ''}"


class Batch:
    """What is done with inputs, of one run. console: a Console, which gets a line for every input that is done or failed."""

    def __init__(self, options, console):
        self.options = options
        self.console = console
        self.processes = Processes()
        self.rows = []
        self._staging = ""
        self._total = 1
        self._finished_count = 0
        self._counting = threading.Lock()

    def run(self, paths):
        """Does every input. Returns how many failed. Raises InputsError or OutputError before anything is started."""
        with self._outputs():
            failed = self._run_all(self._named(paths))
            try:
                self._write_summary(self.rows)
            except OSError as error:
                self.console.fail(f"cannot write {os.path.join(self.options.folder, 'summary.csv')}: {explain(error)}")
                failed += 1
            if len(self.rows) > 1 or self.rows[0]["verdict"] == "poor":
                self.console.show(counts(self.rows))
            return failed

    def inputs(self, paths):
        """The inputs that there are, none of them done. Raises InputsError or OutputError."""
        with self._outputs():
            return self._named(paths)

    def run_one(self, item, label):
        """Does one input, an object of a scene in Blender only, and returns its row for the summary. Raises OutputError, and WorkerKilled where another try may do it.

        label: a name for the place where its outputs wait until they are complete; what an earlier try has left there is removed.
        """
        with self._outputs(label):
            if not item.error and not item.arrays and input_files.is_scene(item.path):
                found = self._objects(item.path, 0)
                failed = [entry for entry in found if entry.error and not entry.object_name]
                same = [entry for entry in found if entry.object_name == item.object_name]
                item.arrays, item.error = (same[0].arrays, same[0].error) if same else ("", failed[0].error if failed else "is no longer in the file")
            return self._one(0, item, raises=WorkerKilled)

    @contextlib.contextmanager
    def _outputs(self, label=""):
        """The folder of the outputs, and one in it where they wait."""
        folder = self.options.folder
        new = not os.path.isdir(folder)
        try:
            os.makedirs(folder, exist_ok=True)
            if label:
                for name in os.listdir(folder):
                    if name.startswith(f".hybrid-mesh-{label}-"):
                        shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
            # Beside the outputs, so that a finished file is moved there by a rename within one file system.
            self._staging = tempfile.mkdtemp(prefix=f".hybrid-mesh-{label}{'-' if label else ''}", dir=folder)
        except OSError as error:
            raise OutputError(f"cannot write to {folder}: {error.strerror or error}") from error
        try:
            yield
        finally:
            self.processes.end()
            shutil.rmtree(self._staging, ignore_errors=True)
            if new and os.path.isdir(folder) and not os.listdir(folder):
                os.rmdir(folder)

    def _named(self, paths):
        items = self._expand(paths)
        for item in input_files.name_apart(items, self.options.outputs, self.options.folder):
            self.console.show(f"{item.label}: another input has this name, its outputs are called {item.name}")
        return items

    def _expand(self, paths):
        items = []
        for number, item in enumerate(input_files.expand(paths, self.options.folder, self.console.fail)):
            if item.error or not input_files.is_scene(item.path):
                items.append(item)
            elif bpy_available():
                items += self._objects(item.path, number)
            else:
                items.append(input_files.failed_input(item.path, input_files.needs_blender(item.path)))
        return items

    def _objects(self, path, number):
        folder = os.path.join(self._staging, f"objects{number}")
        try:
            os.mkdir(folder)
            job = {"kind": "extract", "path": path, "folder": folder, "density": self.options.settings.density}
            found = self.processes.run(job, self.options.timeout, needs_bpy=True)["objects"]
        except (WorkerFailed, OSError) as error:
            return [input_files.failed_input(path, explain(error, path))]
        if not found:
            return [input_files.failed_input(path, "holds no mesh object")]
        items = []
        for entry in found:
            item = input_files.object_input(path, entry["name"], entry.get("arrays", ""))
            item.error = entry.get("error", "")
            items.append(item)
        return items

    def _run_all(self, items):
        failed = 0
        rows = {}
        self._total = len(items)
        executor = ThreadPoolExecutor(max_workers=self.options.jobs)
        try:
            waiting = {executor.submit(self._one, number, item): number for number, item in enumerate(items)}
            pending = set(waiting)
            while pending:
                # In slices, so that Ctrl-C is noticed at once on every platform.
                done, pending = wait(pending, timeout=0.2, return_when=FIRST_COMPLETED)
                for future in done:
                    row = future.result()
                    rows[waiting[future]] = row
                    failed += row["status"] == "failed"
        except BaseException:
            self.processes.end()
            executor.shutdown(wait=False, cancel_futures=True)
            raise
        executor.shutdown()
        self.rows = [rows[number] for number in range(len(items))]
        return failed

    def _one(self, number, item, raises=()):
        """Does one input; every way of failing becomes a row and a line, but for exceptions that are to be raised."""
        try:
            status, report = self._do(number, item)
        except raises:
            raise
        except Exception as error:  # An input that fails, in whatever way, must not keep the others from being done.
            return self._failed(item, explain(error, item.path))
        finally:
            self._tell(item, 1, "")
        done = self._count()
        if status == "skipped":
            self.console.show(f"{done}{item.label}: done before, skipped")
        else:
            self.console.show(f"{done}{item.label}: {_figures(report)}")
        poor = [reports.reason_line(reason) for reason in reports.reasons(report)]
        for line in poor:
            self.console.fail(f"{item.label}: poor: {line}")
        for warning in report.get("warnings", []):
            self.console.fail(f"{item.label}: warning: {warning}")
        if poor and self.options.settings.strict:
            # Its files stay, so that one can look.
            return reports.summary_row(item.name, item.label, "failed", report, "; ".join(poor))
        return reports.summary_row(item.name, item.label, status, report)

    def _tell(self, item, fraction, stage):
        self.console.progress(f"{self._finished_count}/{self._total}", item.label, fraction, stage)

    def _count(self):
        """What stands before the line of an input that is finished: the how-manieth it is."""
        with self._counting:
            self._finished_count += 1
            return f"[{self._finished_count}/{self._total}] " if self._total > 1 else ""

    def _do(self, number, item):
        options = self.options
        if item.error:
            raise WorkerFailed(item.error)
        settings = options.settings.identity()
        fingerprint = reports.resume_hash(reports.file_chunks(item.arrays or item.path), settings, VERSION)
        if options.resume:
            report = self._finished(item, fingerprint)
            if report:
                return "skipped", report
        folder = os.path.join(self._staging, str(number))
        os.mkdir(folder)
        job = {
            "kind": "remesh", "path": item.path, "object": item.object_name, "arrays": item.arrays, "name": item.name, "folder": folder,
            "settings": options.settings.native(), "exports": list(options.outputs.exports), "repaired": options.outputs.repaired,
            "levels": list(options.outputs.levels), "hash": fingerprint,
        }  # fmt: skip
        report = self.processes.run(job, options.timeout, progress=lambda fraction, stage: self._tell(item, min(fraction, 0.999), stage))["report"]
        if options.outputs.blend:
            stem = os.path.join(folder, item.name)
            job = {
                "kind": "write_blend", "path": item.path, "hmesh": stem + ".hmesh", "report": stem + ".report.json", "name": item.name,
                "target": stem + ".blend",
            }  # fmt: skip
            self.processes.run(job, options.timeout, needs_bpy=True)
        for suffix in (*options.outputs.level_suffixes(len(report.get("levels", []))), *options.outputs.suffixes()):
            os.replace(os.path.join(folder, item.name + suffix), os.path.join(options.folder, item.name + suffix))
        shutil.rmtree(folder, ignore_errors=True)
        return "done", report

    def _finished(self, item, fingerprint):
        """The report of an earlier run of the same input, settings and version whose outputs all stand, or None."""
        for suffix in self.options.outputs.suffixes():
            if not os.path.isfile(os.path.join(self.options.folder, item.name + suffix)):
                return None
        try:
            with open(os.path.join(self.options.folder, item.name + ".report.json"), encoding="utf-8", errors="surrogateescape") as file:
                report = json.load(file)
        except (OSError, ValueError):
            return None
        if not isinstance(report, dict) or report.get("hash") != fingerprint or not reports.verdict(report):
            return None
        levels = self.options.outputs.level_suffixes(len(report.get("levels", [])))
        return report if all(os.path.isfile(os.path.join(self.options.folder, item.name + suffix)) for suffix in levels) else None

    def _failed(self, item, cause):
        if self.processes.ended:
            return reports.summary_row(item.name, item.label, "failed", error="interrupted")
        self._count()
        self.console.fail(f"{item.label}: {cause}")
        report = {"input": {"file": os.path.basename(item.path)}, "error": cause, "version": VERSION, "settings": self.options.settings.reported()}
        try:
            self._write_whole(item.name + ".report.json", reports.to_json(report))
        except OSError:
            pass  # The line on stderr has said it; a full disk takes no report of itself.
        return reports.summary_row(item.name, item.label, "failed", error=cause)

    def summarize(self, rows):
        """Writes the summary of inputs that were done elsewhere."""
        with self._outputs():
            self._write_summary(rows)

    def _write_summary(self, rows):
        self._write_whole("summary.csv", reports.summary_csv(rows))

    def _write_whole(self, name, text):
        temporary = os.path.join(self._staging, name)
        write_text(temporary, text)
        os.replace(temporary, os.path.join(self.options.folder, name))


def _figures(report):
    final = reports.quality(report)
    parts = [f"{final['vertices']:,} vertices"]
    parts.append(f"{final['quads']:,} quads")
    if final["l2"] is not None:
        parts.append(f"L2 {final['l2']:.2e}")
    if final["hausdorff"] is not None:
        parts.append(f"Hausdorff {final['hausdorff']:.2e}")
    parts.append(f"{report['seconds']['total']:.1f} s")
    return ", ".join(parts)
