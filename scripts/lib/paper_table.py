"""The paper's Table 1: its layout, its published seconds, and its claims about who is faster."""

import os

from benchmark_json import FORMULATIONS
from claims import Claim, fastest, slower_by
from comparison import Comparison, check_layout, read_published

PUBLISHED = os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, os.pardir, "results", "paper",
                         "table1.csv")
STAGES = (1, 2, 3)

# The paper calls algebra "really poor" at 2.5 to 3.9 times the fastest row; twice is the mildest fair reading.
CLAIMS = (
    Claim("a", "at s = 1 algebra is fastest", (1,), fastest("algebra")),
    Claim("b", "at s ≥ 2 group is fastest", (2, 3), fastest("group")),
    Claim("c", "algebra is really poor for large n and s = 3 (at least twice the time of the fastest row)", (3,),
          slower_by(2, "algebra")),
)


def beside_the_paper(path, run):
    """Returns the Comparison of a run, read from `path`, with the published seconds."""
    check_layout(path, run, FORMULATIONS, STAGES)
    return Comparison(run, read_published(PUBLISHED), FORMULATIONS, STAGES)
