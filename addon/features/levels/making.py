# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators that make ordinary objects of hierarchies have in common."""

import bpy

from ...bridge import view
from ...core.native import expected, explain
from . import made


class MakingOperator(bpy.types.Operator):
    """Base of operators that make an object of each hybrid mesh chosen.

    Subclasses have work(context, collection), which returns something with an `obj` and a line() for people, and leaves nothing behind if it raises.
    """

    @classmethod
    def poll(cls, context):
        if not made.chosen_hierarchies(context):
            cls.poll_message_set("Select hybrid meshes: levels, previews, objects that were remeshed, or what was made of them")
            return False
        return True

    def work(self, context, collection):
        raise NotImplementedError

    def execute(self, context):
        view.to_object_mode(context)  # What is edited in another mode is not in the mesh yet.
        done, errors = [], []
        with view.waiting(context):
            for collection in made.chosen_hierarchies(context):
                try:
                    done.append(self.work(context, collection))
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
