"""The paper's Table 1: its layout, its published seconds, its claims about who is faster, and what our tables share."""

import os

from benchmark_json import FORMULATIONS, read_run
from claims import Claim, claims_section, fastest, slower_than_all
from comparison import (Comparison, check_layout, conditions_section, counters_section, errors_section, percentage,
                        read_published, three_digits)

PUBLISHED = os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, os.pardir, "results", "paper",
                         "table1.csv")
STAGES = (1, 2, 3)
COUNTERS = ("sweeps_per_step", "products", "poisson_solves", "spectrum_error", "skew_defect", "energy_error",
            "h_norm_B", "product_share")
# Only a run that was given reference solutions has these.
OPTIONAL_COUNTERS = ("relative_error", "reference_uncertainty")
# Heading and how to write it, by counter.
COUNTER_COLUMNS = {
    "sweeps_per_step": ("sweeps/step", three_digits), "equivalent_products": ("full products", three_digits),
    "relative_error": ("error at T", three_digits), "spectrum_error": ("spectrum error", three_digits),
    "product_share": ("product share", percentage), "skew_defect": ("skew defect", three_digits),
    "energy_error": ("energy error", three_digits), "h_norm_B": ("h‖B‖", three_digits),
}

# The paper calls algebra "really poor" at 2.5 to 3.9 times the fastest row; twice is the mildest fair reading.
CLAIMS = (
    Claim("a", "at s = 1 algebra is fastest", (1,), fastest("algebra")),
    Claim("b", "at s ≥ 2 group is fastest", (2, 3), fastest("group")),
    Claim("c", "algebra is really poor for large n and s = 3 (at least twice the time of the fastest row)", (3,),
          slower_than_all("algebra"), factor=2),
)


def beside_the_paper(path, program, counters=COUNTERS, table=None):
    """Returns the Comparison of a table in the raw file of a program with the published seconds."""
    run = read_run(path, program, counters, OPTIONAL_COUNTERS, table)
    check_layout(path, run, FORMULATIONS, STAGES)
    return Comparison(run, read_published(PUBLISHED), FORMULATIONS, STAGES)


def closing_sections(comparison, counters):
    """Errors, these counters, the paper's claims, and the conditions of measurement."""
    columns = [(heading, counter, show) for counter, (heading, show) in COUNTER_COLUMNS.items() if counter in counters
               and (counter not in OPTIONAL_COUNTERS or comparison.has_counter(counter))]
    return [
        *errors_section(comparison, "Error at T = 5",
                        "Relative error of W(5) in the Frobenius norm against reference solutions, the largest of the"
                        " three formulations, which coincide: what the times above buy.", *OPTIONAL_COUNTERS),
        *counters_section(comparison, "What the time went into, and how good the answer is", columns),
        *claims_section(CLAIMS, comparison),
        *conditions_section(comparison.run.context),
    ]
