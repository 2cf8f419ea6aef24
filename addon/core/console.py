# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line says: results on stdout, problems on stderr, and how far the inputs are, in the way that whoever reads it takes."""

import os
import sys
import threading

from .arguments import PROGRAM

STEP = 0.1  # of an input, between two lines of its progress


class Console:
    """Lines for people and for the program that runs this one; safe to use from several threads.

    progress: "auto", a line that is overwritten while stderr is a terminal; "lines", a line a tenth of an input; "openjd", the marked lines that Open Job
    Description reads a task's progress from; "none".
    """

    def __init__(self, progress="auto", out=None, err=None):
        self._out, self._err = out or sys.stdout, err or sys.stderr
        if progress == "auto":
            progress = "overwritten" if self._err.isatty() else "none"
        self._tell = {"overwritten": self._overwrite, "lines": self._line, "openjd": self._openjd, "none": lambda *_: None}[progress]
        self._lock = threading.Lock()
        self._running = {}  # label: fraction, of inputs that are being worked on
        self._length = 0  # of the line that is overwritten

    def show(self, line):
        self._say(self._out, line)

    def fail(self, line):
        self._say(self._err, f"{PROGRAM}: {line}")

    def progress(self, counted, label, fraction, stage):
        """counted: "3/14", how many inputs are done; label, fraction, stage: of one that is being worked on. A fraction of 1 ends it."""
        with self._lock:
            before = self._running.get(label, -1.0)
            self._running[label] = fraction
            self._tell(counted, label, before, fraction, stage)
            if fraction >= 1:
                del self._running[label]

    def _overwrite(self, counted, label, before, fraction, stage):
        told = ", ".join(f"{name} {100 * done:.0f} %" for name, done in self._running.items() if done < 1)
        only = f" ({stage})" if len(self._running) == 1 and stage else ""
        self._replace(f"{counted} done; {told}{only}" if told else "")

    def _line(self, counted, label, before, fraction, stage):
        if fraction < 1 and int(fraction / STEP) > int(before / STEP):
            print(f"{label}: {100 * fraction:.0f} %{', ' + stage if stage else ''}", file=self._out, flush=True)

    def _openjd(self, counted, label, before, fraction, stage):
        print(f"openjd_progress: {100 * fraction:.1f}", file=self._out, flush=True)
        if stage:
            print(f"openjd_status: {stage}", file=self._out, flush=True)

    def _say(self, stream, line):
        with self._lock:
            self._replace("")
            print(line, file=stream, flush=True)

    def _replace(self, line):
        if not line and not self._length:
            return
        try:
            columns = os.get_terminal_size(self._err.fileno()).columns
        except (OSError, ValueError):
            columns = 0
        line = line[: (columns or 80) - 1]  # a terminal that does not know how wide it is has 0 columns
        self._err.write("\r" + line.ljust(self._length) + ("" if line else "\r"))
        self._err.flush()
        self._length = len(line)
