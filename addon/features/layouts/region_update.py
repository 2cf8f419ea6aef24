# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions that are laid out anew in the hierarchy that is at hand, at their own cost."""

import json
from dataclasses import dataclass
from typing import Any

from ...core import plans
from ...core import report as reports
from ...core.tasks import Task
from ..levels import kept
from ..levels import properties as hierarchy_properties


def prepare(collection, operation, plan):
    """An Update of a hierarchy by one more operation; None where it is not at hand, or the operation changes quads that another one of its level has put there: then its source is
    remeshed with the plan and the operation."""
    at_hand = kept.find(collection)
    if at_hand is not None and at_hand.edited:
        raise ValueError(f"{collection.name}: its levels were edited, and new quads would lie where the surface is: lay regions out before levels are edited")
    if at_hand is None or at_hand.source is None or not all("." in address for address in operation["quads"]):
        return None
    return Update(at_hand, at_hand.hierarchy.copy(), operation, plan, hierarchy_properties.report_of(collection))


@dataclass
class Update:
    kept: Any
    hierarchy: Any  # a copy, which the task changes
    operation: dict
    plan: str
    report: dict

    def task(self, name):
        return Task(name, lambda: self.hierarchy.start_repatch(json.dumps(self.operation)), (self.kept.source, self.kept.settings))

    def result(self, outcome):
        """What a remesh would give, from the outcome of the task."""
        made = self.hierarchy.operation(outcome["operation"])
        report = reports.repatched(self.report, made, outcome, self.kept.settings.vertices)
        return Updated(self.hierarchy, json.dumps(report), plans.with_operation(self.plan, self.operation), self.kept.repaired)


@dataclass
class Updated:
    """As a native Result."""

    hierarchy: Any
    report: str
    plan: str
    surface: Any

    def repaired(self):
        return self.surface
