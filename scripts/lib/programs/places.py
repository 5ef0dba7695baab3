"""Where things of the project lie."""

import os

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__)))))
RECORDED = os.path.join(ROOT, "results", "recorded")
REFERENCES = os.path.join(RECORDED, "references")  # solutions that errors are measured against
SETUP = os.path.join(ROOT, "scripts", "lib", "setup.sh")
BUILD = os.environ.get("ISOSYRK_BUILD") or os.path.join(ROOT, "build")
MODULE = os.path.join(BUILD, "python")  # the folder of the package isosyrk
