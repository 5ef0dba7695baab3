"""The list of studies. A study is a package here, and one record in STUDIES; reproduce, measure and render read them.

A package has the same few modules:

    schema   its raw file: settings and tables of columns and rows
    plan     what is tried, and how much of it
    run      main(arguments) measures and writes the raw file; time_block(block) is what a fresh process times
    judge    what the raw file shows, as findings (lib/records/findings.py), and figures for pages
    report   rendered(raw) returns the report, with its charts and figures
    charts   the charts, by matplotlib

A small one has its plan in run, or its judgements in schema. A package may see the rooms of lib/ and packages that
stand before it in PACKAGES. Standard library only: whoever asks for the list need not have what a study needs.
"""

import importlib.util
from typing import NamedTuple, Optional, Tuple


class Part(NamedTuple):
    """What is measured by itself, into a raw file of its own."""

    package: str  # of studies, whose run measures it
    file: str  # name of its raw file
    saying: str  # what is said while it is measured
    arguments: Tuple[str, ...] = ()
    quick_arguments: Optional[Tuple[str, ...]] = None  # with --quick, in place of `arguments`; None: the same
    build: str = ""  # "avx2": measured by programs without AVX-512, where the processor has it; else it is left out


class Study(NamedTuple):
    """A study, as `scripts/reproduce NAME` runs it."""

    name: str
    title: str  # what it measures
    minutes: float  # that it takes on two cores, and with --quick
    quick_minutes: float
    parts: Tuple[Part, ...]  # the first gives the raw file that the others stand beside
    package: str = ""  # whose report renders it, where it is not named as the study
    needs: str = "studies"  # packages besides those of the build, by a name in setup.sh: "", "studies", or "claims"
    shown: str = "report.md"  # which of its results is printed at the end
    rendered_by: Tuple[str, ...] = ()  # modules that its report needs; charts need matplotlib besides

    @property
    def home(self):
        """The package that renders it."""
        return self.package or self.name


def of_one_part(name, saying):
    """Returns the parts of a study that measures once, with no argument but --quick."""
    return (Part(name, "raw.json", saying),)


TABLE_SAYING = ", in fresh processes on one core"
ERRORS = ("--references", "results/recorded/references")
ROUGH = ("--scene", "rough", "--start", "5", "--integrator", "algebra1_frame", "group2_frame", "elp4_frame",
         "rk4_frame")

STUDIES = (
    Study("table1", "Table 1 of the paper by the published forms; the main job (the default)", 10, 2,
          (Part("tables", "raw.json", "Measuring Table 1" + TABLE_SAYING, ("table1", *ERRORS)),),
          "tables", "", "table.txt"),
    Study("table2", "the same cells by the fast forms, beside the published ones", 10, 3,
          (Part("tables", "raw.json", "Measuring Table 2 and, interleaved, Table 1" + TABLE_SAYING,
                ("table2", *ERRORS)),),
          "tables", "", "table.txt"),
    Study("limits", "up to which step each integrator works, and how it fails beyond", 90, 1,
          of_one_part("limits", "Looking for the longest steps that work")),
    Study("accuracy", "accuracy against cost of every integrator, and methods compared at equal error", 90, 4,
          of_one_part("accuracy", "Measuring accuracy against cost")),
    Study("longruns", "energy, spectrum and symplectic defect against cost, and runs to T = 1e4", 45, 0.5,
          of_one_part("longruns", "Watching long runs")),
    Study("scaling", "what a step costs against n, what parts of the fast forms and threads gain", 60, 2,
          (Part("scaling", "raw.json", "Timing a step against n, and without each part of the fast forms"),
           Part("scaling", "rough.json", "Timing a step in the rough scene", (*ROUGH, "--n", "257", "513"),
                (*ROUGH, "--n", "33")),
           Part("threads", "threads.json", "Timing a step by one thread and by several")),
          rendered_by=("scipy",)),
    Study("theorem", "the formulations on every algebra, their cost, and where the theorem ends", 10, 1,
          of_one_part("theorem", "Comparing the formulations on every algebra")),
    Study("turbulence", "what long turbulent runs average to, and at what cost", 100, 0.5,
          of_one_part("turbulence", "Running turbulence, and timing its steps")),
    Study("fluid", "what one turbulent flow looks like, and what methods lose of it", 1, 0.5,
          of_one_part("fluid", "Running one turbulent flow")),
    Study("practice", "what people run, the midpoint at h = ħ/4, against what reaches a tenth of its error for less;"
          " with QUFLOW=FOLDER, a checkout, also quflow's own step", 100, 2,
          of_one_part("practice", "Comparing what people run with what reaches its error for less")),
    Study("claims", "the paper's claims in GNU Octave, with AVX2 kernels, other initial data and two threads, in one"
          " table with what the other studies recorded", 50, 4,
          (Part("claims", "raw.json", "Measuring the paper's claims"),
           Part("tables", "avx2.json", "Measuring Tables 1 and 2 with AVX2 kernels" + TABLE_SAYING, ("table2",),
                ("table2", "--n", "17"), "avx2")),
          needs="claims"))
BY_NAME = {study.name: study for study in STUDIES}
# Every package, each after those that it may see: those of a study's further parts come before it. `references`
# computes the solutions that errors are measured against, and is no study.
PACKAGES = (*dict.fromkeys(package for study in STUDIES for package in (
    *(part.package for part in study.parts if part.package != study.home), study.home)), "references")


def modules_of(package):
    """Returns the modules that a package's report needs besides the standard library."""
    charts = ("matplotlib",) if module_exists(package, "charts") else ()
    return charts + next((study.rendered_by for study in STUDIES if package == study.home), ())


def module_exists(package, name):
    return importlib.util.find_spec(f"studies.{package}.{name}") is not None


def module(package, name):
    """Returns a module of a package of studies."""
    return importlib.import_module(f"studies.{package}.{name}")
