"""Report of `scaling`: a step's time against n, what bands and other parts gain, threads, and the repetitions."""

import math

from lib.records.formats import FAST, PUBLISHED
from lib.judging.verdicts import FEWEST, UNDECIDED, ratio_of, verdict
from lib.pages.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table
from lib.pages.numbers import MISSING, percentage, scientific, three_digits
from lib.pages.rendering import Rendering, beside
from studies.scaling.judge import figures
from studies.scaling.schema import (BANDS, ABLATIONS, cells, exponential, read_rough, read_scaling, ablations_of, slope,
                                    slope_ends)
from studies.tables.comparison import UNDECIDED_MARK, spread_text, time_with_spread
from studies.threads.report import thread_sections
from studies.threads.schema import read_threads

SINGLE = "¹"  # follows what was timed once
SINGLE_MEANS = f"{SINGLE}: timed once."


def scaling_sections(study, rough=None, threads=None):
    """Returns the report of a Scaling as a document.

    `rough` is None or the Scaling of the rough scene, `threads` None or the Threads of a raw file of its own.
    """
    return [
        Heading("What a step costs, and what each part of the fast forms gains", 1),
        Paragraph(f"Steps of the {study.settings.scene} scene from {starts_text(study)} on. A repetition repeats the"
                  " same steps from the same state. A fast form with a predictor runs for"
                  f" T = {study.settings.warmup:g} before them, untimed. Beyond n = 257 steps and this time fall as"
                  " 1/(n - 1), since longer steps fail. What it means is said in results/README.md."),
        *line_sections(study),
        *(rough_sections(rough) if rough else ()),
        *memory_sections(study),
        *band_sections(study),
        *gauss_sections(study),
        *exponential_sections(study),
        *(thread_sections(threads) if threads else two_thread_sections(study)),
        *all_sections(study),
        *trend_sections(study),
        conditions(study.context),
    ]


def starts_text(study):
    return " and ".join(f"t = {start:g}" for start in study.starts())


def lefts(*names):
    return tuple(Column(name, align="left") for name in names)


def columns_by_start(study, integrators=None):
    """Returns a column for each start and n, in groups by start, and the (start, n) of each."""
    places = [(start, n) for start in study.starts() for n in study.sizes(start, integrators)]
    return [Column(f"n = {n}", f"t = {start:g}") for start, n in places], places


# ---- the entries


def time_entry(point, unit=1.0):
    """Returns the text of a point's time in units a second, with its spread or the mark of a single timing."""
    if point is None or not point.seconds:
        return MISSING
    text = time_with_spread([unit * second for second in point.seconds])
    return text + SINGLE if point.is_single else text


def ratio_entry(study, start, n, name, ablation):
    """Returns the text of an ablation's time over the fast form's, with its spread or the mark of a single timing."""
    found = study.ratios(start, n, name, ablation)
    if not found:
        return MISSING
    text = time_with_spread(found)
    return text + SINGLE if len(found) == 1 else text


def gain_entry(study, start, n, ablation, names):
    found = study.gain(start, n, ablation, names)
    if found is None:
        return MISSING
    single = any(len(study.ratios(start, n, name, ablation)) == 1 for name in names)
    return three_digits(found) + (SINGLE if single else "")


def share_entry(study, point):
    share = study.share_of_products(point)
    return MISSING if share is None else percentage(share)


# ---- a step against n


def line_table(study):
    """Returns the table of what a step costs on each of the lines; None without any."""
    rows = []
    for start in study.starts():
        for name in study.lines:
            for ablation in (PUBLISHED, FAST):
                rows += [[f"{start:g}", name, ablation, str(point.n), time_entry(point, 1e3),
                          three_digits(point.sweeps), three_digits(point.equivalent_products),
                          share_entry(study, point)]
                         for point in study.line(start, name, ablation)]
    columns = (Column("t"), *lefts("integrator", "form"), Column("n"), Column("ms a step"), Column("sweeps"),
               Column("equivalent products"), Column("share of products"))
    return plain_table(columns, rows) if rows else None


def line_sections(study):
    table = line_table(study)
    if table is None:
        return []
    return [
        Heading("A step against n"),
        Paragraph("Methods in the co-rotating frame; Gauss methods and RK4 with h = 0.1 and the tolerance 1e-13,"
                  " exponential ones with h = 0.25 and 1e-8; for all of them h is a half of that at n = 513, a quarter"
                  " at n = 1025. Two steps were timed at these n."
                  " Medians ± half the interquartile range of interleaved repetitions."
                  f" {SINGLE_MEANS} Share of products: the time of the equivalent products by themselves over that of"
                  " the step."),
        table,
        *slope_sections(study),
    ]


def rough_sections(study):
    table = line_table(study)
    if table is None:
        return []
    return [Heading("A step against n, rough scene"),
            Paragraph(f"The same steps from {starts_text(study)} of the rough scene on, measured by themselves."
                      f" {SINGLE_MEANS}"),
            table, conditions(study.context)]


def slope_sections(study):
    rows = []
    for name in study.lines:
        for ablation in (PUBLISHED, FAST):
            for start in study.starts():
                ends = slope_ends(study.line(start, name, ablation))
                if ends:
                    rows.append([name, ablation, f"{start:g}", f"{ends[0].n} to {ends[1].n}",
                                 f"{slope(*ends):.2f}{SINGLE if any(each.is_single for each in ends) else ''}"])
    if not rows:
        return []
    return [Paragraph("The power of n with which the time of a step grows between two n. A product takes n³ operations,"
                      f" a sum n². {SINGLE}: one of the two was timed once."),
            plain_table((*lefts("integrator", "form"), Column("t"), Column("n"), Column("power")), rows)]


def memory_sections(study):
    if not study.memory:
        return []
    rows = [[str(row.n), f"{row.peak_bytes / 1e9:.2g}"] for row in study.memory]
    return [Paragraph("The most memory that the timing process had taken when it had timed an n first."),
            plain_table((Column("n"), Column("GB")), rows)]


def band_sections(study):
    names = [name for name in study.lines if name in study.integrators()]
    columns, places = columns_by_start(study)
    rows = [["cells of Table 1", *(gain_entry(study, *place, BANDS, cells()) for place in places)],
            *([name, *(ratio_entry(study, *place, name, BANDS) for place in places)] for name in names)]
    return [
        Heading("What bands buy"),
        Paragraph("Time with full products over time with products within bands. The first row is the geometric mean"
                  f" over the cells of Table 1. {SINGLE_MEANS}"),
        plain_table((*lefts("integrator"), *columns), rows),
    ]


# ---- ablation


def gauss_sections(study):
    names = [name for name in cells() if name in study.integrators()]
    if not names:
        return []
    columns, places = columns_by_start(study, names)
    ablations = [ablation for ablation in ablations_of(study.identities[names[0]]) if ablation != FAST]
    rows = [[ablation, *(gain_entry(study, *place, ablation, names) for place in places)] for ablation in ablations]
    return [
        Heading("Ablation of Gauss methods: what each part of the fast form gains"),
        Paragraph("Time over that of the fast form, geometric means over the cells of Table 1, not in the frame."
                  " Published: the published form. Without newton: plain Picard sweeps. Without predictor: a cold start"
                  " each step. Without bands: full products. Without any: split-complex storage, its products,"
                  " triangles and single precision of late terms are left. Below 1 a part does not pay in these"
                  f" steps. {SINGLE}: at least one of the cells was timed once."),
        plain_table((*lefts("form"), *columns), rows),
    ]


def exponential_sections(study):
    names = exponential(study)
    if not names:
        return []
    columns, places = columns_by_start(study, names)

    def row(name, ablation):
        return [Entry(each) for each in (name, ablation, *(ratio_entry(study, *place, name, ablation)
                                                           for place in places))]

    blocks = [[row(name, ablation) for ablation in ABLATIONS if ablation != FAST
               and any((*place, name, ablation) in study.points for place in places)] for name in names]
    return [
        Heading("Ablation of exponential methods"),
        Paragraph("Time over that of the fast form, h = 0.25, tolerance 1e-8, not in the frame. Without newton: plain"
                  " Picard sweeps. Without predictor: no start values from past steps. Without explicit start: none"
                  " from a step of an explicit Magnus method. Without either start: a cold start each step. Without"
                  " estimates: a correction is accepted by one more sweep, not by its estimated error. Without single"
                  " precision: late terms of series, start values and corrections in double precision. Without graded"
                  " series: each is summed to rounding, not to the accuracy that is wanted of it. Without bands: full"
                  f" products. Without any: of all that the method has. {SINGLE_MEANS}"),
        Table((*lefts("integrator", "form"), *columns), blocks),
    ]


# ---- two threads, of older files


def two_thread_sections(study):
    if not study.threads:
        return []
    rows = []
    for row in study.threads:
        ratio = ratio_of(row.one, row.two)
        said = f" {UNDECIDED_MARK}" if verdict(ratio) == UNDECIDED else ""
        text = three_digits(ratio.ratio)
        if ratio.processes >= FEWEST and math.isfinite(ratio.high):
            text = spread_text(text, 100 * (ratio.high / ratio.ratio - 1))
        rows.append([row.integrator, str(row.n), f"{row.start:g}", three_digits(1e3 * min(row.one)),
                     three_digits(1e3 * min(row.two)), text + said, str(ratio.processes)])
    return [
        Heading("Two threads"),
        Paragraph("Time that passes for a step of the fast form on one thread, over that on two. Each process runs both"
                  " interleaved; the gain is the geometric mean over processes with its 95 % interval."
                  f" {UNDECIDED_MARK}: undecided whether there is a gain beyond 5 %. Milliseconds are the least of all"
                  " processes."),
        plain_table((*lefts("integrator"), Column("n"), Column("t"), Column("ms, one"), Column("ms, two"),
                     Column("gain"), Column("processes")), rows),
    ]


# ---- every integrator


def all_sections(study):
    ablations = (PUBLISHED, BANDS)
    columns = (Column("t"), Column("n"), *lefts("integrator"), Column("sweeps"), Column("equivalent products"),
               Column("share of products"), Column("ms a step"),
               *(Column(ablation, "time over that of the fast form") for ablation in ablations))

    def row(start, n, name):
        point = study.points.get((start, n, name, FAST))
        works = point is not None and point.seconds
        costs = ([three_digits(point.sweeps), three_digits(point.equivalent_products),
                          share_entry(study, point)]
                 if works else [MISSING] * 3)
        return [Entry(each) for each in (f"{start:g}", str(n), name, *costs, time_entry(point, 1e3),
                                         *(ratio_entry(study, start, n, name, ablation) for ablation in ablations))]

    blocks = [[row(start, n, name) for name in study.integrators() if any((start, n, name, ablation) in study.points
                                                                         for ablation in ABLATIONS)]
              for start in study.starts() for n in study.sizes(start)]
    return [
        Heading("Every integrator"),
        Paragraph("A step of the fast form. Medians ± half the interquartile range of interleaved repetitions; ratios"
                  f" are within the same round. {SINGLE_MEANS} {MISSING}: steps that fail, and forms that were not"
                  " timed."),
        Table(columns, blocks),
    ]


# ---- repetitions


def trend_sections(study):
    single = Paragraph(f"{len(study.singles())} of {len(study.points)} points were timed once, as a repetition would"
                       " take too long.")
    trend = study.trend()
    if trend is None:
        return [Heading("Repetitions"), single]
    columns = [Column(name) for name in ("points", "repetitions", "rank correlation", "probability", "change")]
    return [
        Heading("Repetitions"),
        single,
        Paragraph("Spearman's rank correlation of a time with the number of its repetition, the mean over the points"
                  " with all repetitions. Probability: the share of the orders of the rounds that would show at least"
                  " as much; a round times every point once, so that what slows all of it counts once. Change: the"
                  " later half of the rounds over the earlier."),
        plain_table(columns, [[str(trend.series), str(trend.rounds), f"{trend.correlation:.2f}",
                               scientific(trend.probability), f"{100 * trend.change:+.2f} %"]]),
    ]


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file, with those of the rough scene and of threads where they stand beside it."""
    rough, threads = beside(raw, "rough.json"), beside(raw, "threads.json")
    parts = read_scaling(raw), read_rough(rough) if rough else None, read_threads(threads) if threads else None
    return Rendering(lambda _: scaling_sections(*parts), figures(*parts))
