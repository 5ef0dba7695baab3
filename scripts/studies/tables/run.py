"""Measures Table 1 or Table 2 in fresh processes until the verdicts are decided.

Standard library only. Exit status 3: a run did not converge, and its cell says so in the raw file.
"""

import json
import os
import shutil

from lib.programs.command_line import OneLineParser
from lib.programs.output import make_folder, replace_file
from lib.programs.places import BUILD
from studies.tables.processes import Plan, measure

SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
MIN_TIME, QUICK_MIN_TIME = 0.1, 0.05  # seconds that a repetition fills with runs
ARGUMENTS = {"table1": (), "table2": ("--published",)}
TABLES = {"table1": ("table1",), "table2": ("table2", "table1")}


def main(arguments):
    parser = OneLineParser(prog="measure tables", description=__doc__.splitlines()[0], allow_abbrev=False)
    parser.add_argument("table", choices=tuple(TABLES))
    parser.add_argument("--references", metavar="DIR", help="recorded reference solutions, for errors")
    parser.add_argument("--quick", action="store_true", help="n = 17 and 33 only")
    parser.add_argument("--n", metavar="N", type=int, choices=SIZES, nargs="+", action="extend",
                        help="only these of its matrix sizes")
    parser.add_argument("--out", metavar="FILE", required=True,
                        help="the raw file; a folder beside it keeps what ended processes gave until all is done")
    options = parser.parse_args(arguments)
    kept = f"{options.out}.processes"
    make_folder("--out", kept)
    references = ("--references", options.references) if options.references else ()
    # By its place in the project, where that is the working folder: the raw file names it.
    plan = Plan(os.path.join(os.path.relpath(BUILD), "benchmarks", options.table), TABLES[options.table],
                sizes_of(options), (*ARGUMENTS[options.table], *references),
                QUICK_MIN_TIME if options.quick else MIN_TIME, kept)
    document, status = measure(plan)
    rows = ",\n".join(json.dumps(row, separators=(",", ":")) for row in document["benchmarks"])
    text = f'{{"context": {json.dumps(document["context"], indent=1)},\n"benchmarks": [\n{rows}\n]}}\n'
    replace_file(options.out, text.encode("utf-8"))
    shutil.rmtree(kept)
    return status


def sizes_of(options):
    sizes = QUICK_SIZES if options.quick else SIZES
    return tuple(n for n in SIZES if n in options.n) if options.n else sizes
