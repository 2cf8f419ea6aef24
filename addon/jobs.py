# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in native threads: one base operator, and the places where no thread may outlive Blender's data."""

import atexit
import time
import traceback

import bpy

from .bridge import view
from .bridge.names import readable
from .core import readout
from .core.native import NativeMissing, expected, explain, native
from .core.tasks import TaskRun

POLL_SECONDS = 0.1
# What may go on while a job runs: looking around. Everything else could change what the job's result is put beside.
_NAVIGATION = {
    "MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE",
    "MOUSESMARTZOOM", "NDOF_MOTION", "TIMER_REPORT", "TIMER_REGION", "WINDOW_DEACTIVATE",
}  # fmt: skip


class NativeJobOperator(bpy.types.Operator):
    """Base of operators with long native work.

    Subclasses have prepare(context) -> [Task], which may raise ValueError with a line for people, and finish(context, results), which
    puts all results into the scene at once; so that one that is cancelled has changed nothing. failed(context, task, error) may show
    where a task failed, beside the line that is reported. In a window it is modal and Esc ends it; from scripts and in the background it
    returns when the work is done.
    """

    _run = None
    _timer = None
    _shown = ""
    _began = 0.0

    def prepare(self, context):
        raise NotImplementedError

    def finish(self, context, results):
        raise NotImplementedError

    def failed(self, context, task, error):
        pass

    def execute(self, context):
        run = self._prepare(context)
        if run is None:
            return {"CANCELLED"}
        run.wait()
        return self._conclude(context, run)

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        return self.run_modal(context)

    def run_modal(self, context):
        """Starts the work and returns, as invoke() does."""
        if running():
            self.report({"WARNING"}, "Another job is running; Esc ends it")
            return {"CANCELLED"}
        run = self._prepare(context)
        if run is None:
            return {"CANCELLED"}
        self._run = run
        _runs.add(run)
        self._began = time.monotonic()
        context.window_manager.progress_begin(0, 100)
        self._timer = context.window_manager.event_timer_add(POLL_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        run.step()
        self._show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        run = self._run
        if run not in _runs:  # Ended from outside, by unregister for one.
            self._leave(context)
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS":
            self._leave(context)
            _let_end(run)
            self.report({"INFO"}, "Cancelled; nothing was changed")
            return {"CANCELLED"}
        if event.type == "TIMER":
            run.step()
            if run.done:
                self._leave(context)
                return self._conclude(context, run)
            self._show(context)
            return {"PASS_THROUGH"}
        return {"PASS_THROUGH"} if event.type in _NAVIGATION else {"RUNNING_MODAL"}

    def cancel(self, context):
        """Blender ends the operator: another file is loaded, or the window is closed."""
        if self._run is not None:
            self._run.cancel()
        self._leave(context, ending=True)

    def _prepare(self, context):
        try:
            native()
            return TaskRun(self.prepare(context))
        except Exception as error:
            self.report({"ERROR"}, _line_of(error))
        return None

    def _conclude(self, context, run):
        made = False
        errors = [f"{task.name}: {cause}" for task, cause in run.errors]
        for task, error in run.failures:
            self._attempt(errors, self.failed, context, task, error)
        if run.results:
            made = self._attempt(errors, self.finish, context, run.results)
        if not made and not errors:
            errors.append("There was nothing to do")
        if errors:
            self.report({"ERROR"}, readable("\n".join(errors)))
        return {"FINISHED"} if made else {"CANCELLED"}

    def _attempt(self, errors, function, *arguments):
        """Whether a function did all that it is to do; if not, what went wrong is added to the errors."""
        try:
            function(*arguments)
            return True
        except Exception as error:
            errors.append(_line_of(error))
            if not expected(error):
                # It may have left off anywhere, and an operator that is cancelled makes no undo step: what is there can be undone all the same.
                bpy.ops.ed.undo_push(message=f"{self.bl_label} (Incomplete)")
            return False

    def _show(self, context):
        global _progress
        progress = self._run.progress
        text = self._run.status
        if progress > 0:  # Not all work knows how far it is.
            left = readout.time_left(progress, time.monotonic() - self._began)
            text = "   ".join(filter(None, (text, f"{progress:.0%}", left)))
        if text != self._shown:  # Every change is a redraw.
            self._shown = text
            _progress = (progress, text)
            context.workspace.status_text_set(f"{text}   (Esc cancels)")
            context.window_manager.progress_update(round(100 * progress))  # at the pointer
            view.redraw(context)

    def _leave(self, context, ending=False):
        _runs.discard(self._run)
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            if not ending:  # What is in the window may be gone.
                context.window_manager.progress_end()
                view.redraw(context)
            self._timer = None
            if context.workspace:
                context.workspace.status_text_set(None)


def _line_of(error):
    """One line for people; the console gets the rest of what was not foreseen."""
    if not expected(error):
        traceback.print_exception(error)
    return explain(error)


_progress = (0.0, "")
_runs = set()
_ending = []  # cancelled ones whose native work has not yet looked up


def _let_end(run):
    """Cancels a run without waiting for its thread, which on a large surface may be at something that takes seconds."""
    run.cancel(wait=False)
    _ending.append(run)
    if not bpy.app.timers.is_registered(_let_go):
        bpy.app.timers.register(_let_go, first_interval=POLL_SECONDS)


def _let_go():
    """A timer: drops the runs that have ended."""
    for run in list(_ending):
        run.step()
        if run.done:
            _ending.remove(run)
    return POLL_SECONDS if _ending else None


def running():
    """Whether a modal job runs in a window."""
    return bool(_runs)


def progress():
    """(how far the work in a window is, from 0 to 1, what is said of it)."""
    return _progress


def end_all():
    """Cancels and joins every job. Nothing native runs when this returns, whatever it was doing."""
    for run in [*_runs, *_ending]:
        run.cancel()
    _runs.clear()
    _ending.clear()
    try:
        native().shutdown_jobs()
    except NativeMissing:
        pass


@bpy.app.handlers.persistent
def _before_load(*_):
    end_all()


def register():
    atexit.register(end_all)
    bpy.app.handlers.load_pre.append(_before_load)


def unregister():
    end_all()
    if bpy.app.timers.is_registered(_let_go):
        bpy.app.timers.unregister(_let_go)
    atexit.unregister(end_all)
    if _before_load in bpy.app.handlers.load_pre:
        bpy.app.handlers.load_pre.remove(_before_load)
