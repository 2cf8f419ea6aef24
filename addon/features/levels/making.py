# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common that make ordinary objects of hierarchies, or change these."""

import bpy

from ...bridge import view
from ...core.native import expected, explain
from . import made


class MakingOperator(bpy.types.Operator):
    """Base of operators that do something with each hybrid mesh chosen, by default, or with what was made of them.

    Subclasses have work(context, one), which returns something with an `obj` and a line() for people, and leaves nothing behind if it raises.
    """

    @classmethod
    def poll(cls, context):
        if not made.chosen_hierarchies(context):
            cls.poll_message_set("Select hybrid meshes: levels, previews, objects that were remeshed, or what was made of them")
            return False
        return True

    def chosen(self, context):
        """What work() is done with, one after the other."""
        return made.chosen_hierarchies(context)

    def work(self, context, one):
        raise NotImplementedError

    def execute(self, context):
        view.to_object_mode(context)  # What is edited in another mode is not in the mesh yet.
        done, errors = [], []
        with view.waiting(context):
            for one in self.chosen(context):
                try:
                    done.append(self.work(context, one))
                except Exception as error:
                    if not expected(error):
                        raise
                    errors.append(explain(error))
        if done:
            view.select_only(context, *(one.obj for one in done))
        for one in done:
            self.report({"INFO"}, one.line())
        if errors:
            self.report({"ERROR"}, "\n".join(errors))
        return {"FINISHED"} if done else {"CANCELLED"}
