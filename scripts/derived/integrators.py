"""What each integrator of the module's list is, in results/recorded/integrators.json.

Recorded files that do not say so themselves are read with it. Needs the module isosyrk.
"""

import os

from lib.programs.output import keep
from lib.programs.places import ROOT
from lib.records.formats import LISTED, list_text
from lib.running import built


def update(check):
    """Writes the list; with `check` throws Stop, with status 1, where the file has another."""
    keep(check, LISTED, lambda _: list_text(built.entries(None, frames=True)),
         f"{os.path.relpath(LISTED, ROOT)} is not the list of the module; run scripts/update integrators")
