"""What the study `practice` recorded of a scene, in a line for who asks about it. Standard library only."""

import os

from lib.programs.places import ROOT
from lib.records.findings import FILE, read_findings
from studies.practice.judge import BEST, NOTHING, Findings, leading_results

RECORDED = os.path.join(ROOT, "results", "recorded", "practice", FILE)


def recorded_runs(scene, n, keep, path=None):
    """Returns a sentence on the cheapest recorded runs of a scene at n, or None if none was recorded at this n.

    They are the cheapest of those that keep a structure, `keep`, as KEPT names it.
    """
    group = BEST if keep == NOTHING else keep
    found = read_findings(path or RECORDED, "practice", Findings)
    told = [row for each, row in leading_results(found) if (each.scene, each.n, each.group) == (scene, n, group)]
    parts = [f"{row.integrator} (tolerance {row.tolerance:g}, h = {row.step:.3g}) an error of {row.error:.1e} for"
             f" {row.seconds:.2g} s a unit of time" for row in told]
    if not told:
        return None
    time = told[0].steps * told[0].step
    return f"the study practice recorded, at n = {n} to T = {time:.3g}: {', '.join(parts)}"
