"""The history of a benchmark, each processor by itself."""

import shlex

from lib.records.history import GATE, NO, TABLE1
from report_page.charts import Axis, Chart, Column, Selector, as_plotly, options_of

LOOKS = {"clean": {"color": "#1f67ad", "marker": "o", "markersize": 4.5},
         "with changes": {"color": "#d8a03c", "marker": "D", "markersize": 4.5}}  # of the checkout
COMMANDS = {TABLE1: "reproduce table1", GATE: "check_regression"}


def history(lines):
    """Returns the Chart of the ratios of some Lines, in their order on each processor."""
    rows, counts = [], {}
    for line in sorted(lines, key=lambda line: line.date):
        counts[line.machine, line.program] = counts.get((line.machine, line.program), 0) + 1
        rows += [(line, counts[line.machine, line.program], entry) for entry in line.ratios]
    programs = options_of(line.program for line, *_ in rows)
    return Chart(
        "history", "Ratios of times, run by run, on one processor", Axis("run", "run", False, has_ticks=True),
        Axis("ratio", "ratio of times", False),
        {"what": Column("ratio of", [entry.what for *_, entry in rows]),
         "run": Column("run", [place for _, place, _ in rows]),
         "date": Column("date", [line.date for line, *_ in rows]),
         "commit": Column("commit", [line.commit for line, *_ in rows]),
         "ratio": Column("ratio", [entry.ratio for *_, entry in rows]),
         "low": Column("95 % from", [entry.low for *_, entry in rows]),
         "high": Column("to", [entry.high for *_, entry in rows]),
         "machine": Column("", [line.machine for line, *_ in rows]),
         "program": Column("", [line.program for line, *_ in rows]),
         "series": Column("", ["clean" if line.dirty == NO else "with changes" for line, *_ in rows])},
        (Selector("machine", "processor", options_of(line.machine for line, *_ in rows)),
         Selector("program", "program", programs),
         Selector("what", "ratio", options_of(entry.what for *_, entry in rows))),
        {name: as_plotly(look, joined=False) for name, look in LOOKS.items()},
        [f"git checkout {shlex.quote(line.commit)} && scripts/{COMMANDS[line.program]}" for line, *_ in rows],
        bars=("low", "high"),
        note="Each run compares times that it measured interleaved. Runs on other processors or with other kernels are"
             " not compared with these.")
