"""The table of the paper's claims, as data: claims.json. One row a claim, and for each code what was found.

The codes are the paper's MATLAB (ratios only), GNU Octave, C++ by the published forms ("plain" in files) and by the
fast forms ("optimised"), fast forms with plain Picard sweeps, and both of C++ with AVX2 kernels.
A claim about speed is judged by processes (verdicts.py); others by what the recorded studies found, with the rule that
stands at each row. Standard library only.
"""

import json
import math
import statistics
from collections import Counter
from typing import Dict, List, NamedTuple, Optional, Tuple

from lib.records.formats import (FAST, FORMULATIONS, PUBLISHED, an_object, any_text, checked, list_of, number, one_of,
                                 optional, read_json, require, text, whole)
from lib.records.integrators import GAUSS
from lib.judging.verdicts import FAILS, FASTER, FEWEST, HOLDS, MARGIN, SLOWER, TIE, UNDECIDED, fastest, ratio_of
from lib.pages.document import Column, Entry, Table
from lib.pages.numbers import MISSING, percentage, power, three_digits
from studies.claims.parallel_model import PROCESSORS, Rates, path_products, sweep_seconds, work_seconds
from studies.claims.schema import EQUAL, SWEEPS, THREAD_CODES, WHOLE, sample_runs, octave_run
from studies.tables.judge import CLAIMS, figures_of, judged, sizes
from studies.theorem.schema import AT_ROUNDING, FOOTNOTE, PARTITIONED

CODES = {"paper": "paper's MATLAB", "octave": "Octave", "plain": "published code", "optimised": "fast code",
         SWEEPS: "fast code, plain sweeps", "plain_avx2": "published code, AVX2",
         "optimised_avx2": "fast code, AVX2"}
# What the table of claims shows.
EXPLAINED = ("Time ratios: for (a) and (b) the fastest other row over the row that is said to be fastest, for (c)"
             " algebra over the fastest other; range over n, in brackets that of the 95 % intervals. Exponentials: the"
             " paper speaks of the methods of Bogfjellmo and Marthinsen; their ratio is theirs over Gauss, in published"
             " code at equal error. Ours are other methods; their ratio is Gauss over the exponential method at equal"
             " error. Parallel: the fastest other formulation over algebra, range over n and s. Order: of the cheapest"
             f" setting, undecided with fewer than {FEWEST} samples. Published code: C++ written as the paper's"
             " equations; fast code: a better solver of the same. Plain sweeps: Picard sweeps from a cold start on full"
             " matrices. The paper's column has ratios of its printed seconds only.")
SPLIT = "split"  # in place of a number of processors: all work split evenly
NOT_TESTED = "not tested"  # the paper speaks of methods that have no such code
RESULTS = (HOLDS, FAILS, TIE, UNDECIDED, NOT_TESTED)
FORMAT = "isosyrk claims 1"
AT_N = "n = "  # before n, where a finding is of one
# Pages, from results/.
OF_TABLES = ("recorded/tables/table1.md", "recorded/tables/table2.md", "recorded/claims/report.md")
OF_THEOREM, OF_ACCURACY, OF_CLAIMS, OF_TURBULENCE = ((f"recorded/{study}/report.md",) for study in
                                                     ("theorem", "accuracy", "claims", "turbulence"))


class Finding(NamedTuple):
    """What was found in one place: one block that was timed, or several that came out alike.

    The ratio of one block has its 95 % interval. Of several there is none, and low and high are the least and the
    largest ratio of all blocks there. The row on the order has orders in place of ratios: median, least, largest.
    """

    where: text  # such as "n = 17"
    result: optional(one_of(*RESULTS))  # None of what is no verdict: printed seconds, an order, or a model's ratio
    ratio: optional(number)
    low: optional(number)
    high: optional(number)
    count: whole(0)  # of blocks


class Row(NamedTuple):
    claim: str
    statement: str
    stages: Optional[int]
    evidence: Tuple[str, ...]  # pages, from results/
    findings: Dict[str, List[Finding]]  # by code
    has_orders: bool = False  # in place of ratios; not written to claims.json


class Choice(NamedTuple):
    """A claim over what the paper left open: all samples of initial modes and both ħ, at one n and s."""

    claim: text
    stages: whole(1)
    n: whole(2)
    implementation: one_of(PUBLISHED, FAST)
    minimum: number  # ratio
    maximum: number
    results: an_object  # how often each came out


# ---- claims about the formulations' times


def speed_rows(runs):
    """Returns a Row for each claim and s; `runs` are Runs by code, that of the paper its printed seconds."""
    found = []
    for claim in CLAIMS:
        for stages in claim.stages:
            findings = {code: [finding(each, code) for n in sizes(run) for each in judged(run, n)
                               if (each.claim, each.stages) == (claim, stages)] for code, run in runs.items()}
            found.append(Row(f"({claim.label})", claim.statement, stages, OF_TABLES, findings))
    return found


def finding(each, code):
    """Returns a Judged as a Finding; printed seconds have no verdict."""
    ratio = each.ratio
    if code == "paper":
        return Finding(f"{AT_N}{each.n}", None, ratio.ratio, None, None, 1)
    has_interval = ratio.low > 0 and math.isfinite(ratio.high)
    return Finding(f"{AT_N}{each.n}", each.result, ratio.ratio, ratio.low if has_interval else None,
                   ratio.high if has_interval else None, 1)


def choices(study):
    """Returns the Choices of a study: whether a verdict depends on the initial modes or on ħ."""
    found = {}
    for (implementation, _, _), run in sample_runs(study).items():
        for n in sizes(run):
            for each in judged(run, n):
                found.setdefault((each.claim.label, each.stages, n, implementation), []).append(each)
    result = []
    for (label, stages, n, implementation), cases in sorted(found.items()):
        ratios = [each.ratio.ratio for each in cases]
        said = [each.result for each in cases]
        result.append(Choice(f"({label})", stages, n, implementation, min(ratios), max(ratios),
                             {each: said.count(each) for each in RESULTS if each in said}))
    return result


# ---- claims judged by recorded studies


# Gauss at 1e-13 against our exponential methods, as accuracy names the classes: at 1e-8, and at the tolerance at which
# their energy is bounded. The claim is that the exponential ones are slower.
EXPONENTIALS = {("gauss", "elp"): "at 1e-8, where their energy drifts",
                ("gauss", "elp_bounded"): "with bounded energy"}
EXPONENTIALS_SAID = {FASTER: HOLDS, SLOWER: FAILS, TIE: TIE, UNDECIDED: UNDECIDED}
NAMED = ("named_published", "gauss_published")  # the methods that the paper names, both in published form
NAMED_SAID = {SLOWER: HOLDS, FASTER: FAILS, TIE: TIE, UNDECIDED: UNDECIDED}


def counted(where, counts, minimum=None, maximum=None):
    """Returns a Finding for each result that came out; `counts` are by result, least and most ratios of them all.

    Blocks that could not be judged are counted under None.
    """
    return [Finding(where, result, None, minimum, maximum, counts[result]) for result in (*RESULTS, None)
            if counts.get(result)]


def theorem_row(theorem, study):
    """Holds where no difference of two formulations is above its bound; in Octave, for each pair, above EQUAL."""
    within, of = (sum(getattr(each, name) for each in theorem.coincidence) for name in ("within", "settings"))
    findings = {"plain": counted("seven scenes", {HOLDS: within, FAILS: of - within})}
    pairs = study.tables["octave_pairs"]
    if pairs:
        equal = sum(pair.difference <= EQUAL for pair in pairs)
        findings["octave"] = counted("pairs of rows of Table 1", {HOLDS: equal, FAILS: len(pairs) - equal})
    return Row("theorem", "the three formulations coincide", None, OF_THEOREM, findings)


def footnote_rows(theorem):
    """Counts the blocks of scene, n, h and method in which the DIRK method is fastest on g.

    The paper says so of Euler–Zeitlin alone. What other scenes give stands in a row of its own.
    """
    found = []
    for claim, statement, scenes in (
            ("footnote", "isospectral DIRK methods are fastest on g", {"smooth": "su(n)"}),
            ("beyond the footnote", "the same of other equations, of which the paper does not speak",
             {"rigid_body": "so(n)", "spin_chain": "su(2)^N"})):
        findings = []
        for scene, algebra in scenes.items():
            findings += counted(algebra, Counter(each.result for each in theorem.claims
                                                 if (each.claim, each.scene) == (FOOTNOTE, scene)))
        found.append(Row(claim, statement, None, OF_THEOREM, {"plain": findings}))
    return found


def partitioned_rows(theorem):
    """Judges steps by Lobatto IIIA–IIIB on T*G: the spectrum, and whether a form on G is the same map."""
    pairs = [end for end in theorem.ends if end.changed == PARTITIONED]
    keeps = sum(end.casimir_error("cotangent") < AT_ROUNDING for end in pairs)
    differs = sum(end.difference("cotangent–group") > AT_ROUNDING for end in pairs)
    return [Row("remark", statement, None, OF_THEOREM,
                {"plain": counted("so(6), s = 2, 3", {HOLDS: held, FAILS: len(pairs) - held})})
            for statement, held in (("a partitioned pair on T*G keeps the spectrum", keeps),
                                    ("a partitioned pair on T*G is no form on G of either tableau", differs))]


def exponentials_rows(accuracy):
    """Returns the paper's sentence, and our exponential methods against Gauss, of which it does not speak.

    The paper's is on the methods of Bogfjellmo and Marthinsen, and is judged by published forms: it holds where their
    best is slower than the best Gauss method at equal error; the ratio is its time over that of the Gauss method.
    Ours are counted as slower than Gauss; the ratio is the time of Gauss over that of ours.
    """
    def compared(pair, said):
        found = [each for each in accuracy.comparisons if (each.first, each.second) == pair]
        ratios = [each.ratio for each in found]
        return counted("comparisons", Counter(said[each.verdict] for each in found), min(ratios, default=None),
                       max(ratios, default=None))

    return [Row("exponentials", "exponential maps make the methods of Bogfjellmo and Marthinsen inefficient", None,
                OF_ACCURACY, {"plain": compared(NAMED, NAMED_SAID),
                              "optimised": [Finding("no fast form", NOT_TESTED, None, None, None, 1)]}),
            *(Row("our exponentials", f"{tolerance}, they are slower than Gauss at 1e-13", None, OF_ACCURACY,
                  {"optimised": compared(pair, EXPONENTIALS_SAID)}) for pair, tolerance in EXPONENTIALS.items())]


HIGH_ORDER = "is high order needed"


def order_rows(turbulence):
    """Returns what turbulence says of order, n by n, from the cheapest faithful settings; `turbulence` may be None.

    The baseline (the isospectral midpoint at h = ħ/4) is a setting of order 2 like the others. There is no interval:
    the cost of a setting is one figure. No order is named where few samples decide.
    """
    orders, prices, winners = [], [], []
    for trust in sorted(turbulence.trust if turbulence else (), key=lambda each: each.n):
        n, best = trust.n, cheapest_settings(turbulence, trust.n)
        gauss = [each for each in best if each.family == GAUSS]
        if not trust.decides:
            nothing = Finding(f"at n = {n}", UNDECIDED, None, None, None, 1)
            orders += [nothing] if gauss else []
            winners += [nothing] if best else []
            continue
        orders += [order_finding(n, gauss, len(gauss))] if gauss else []
        winners += [order_finding(n, best, 1)] if best else []
        low, high = ([each.over_baseline for each in gauss if (each.order > 2) is is_high] for is_high in (False, True))
        if low and high:
            prices.append(Finding(f"{AT_N}{n}", None, min(low) / min(high), None, None, 1))
    rows = (("in turbulence, order of the cheapest faithful Gauss method", orders),
            ("in turbulence, time of order 2 over that of the cheapest higher order, Gauss methods", prices),
            ("in turbulence, order of the cheapest faithful method of any kind", winners))
    return [Row(HIGH_ORDER, statement, None, OF_TURBULENCE, {"optimised": findings}, findings is not prices)
            for statement, findings in rows if findings]


def cheapest_settings(turbulence, n):
    """Returns the cheapest faithful setting of each method at an n, the baseline among them; none without a cost."""
    found = {}
    for each in turbulence.settings:
        if each.n == n and each.faithful and each.over_baseline:
            found[each.integrator] = min(found.get(each.integrator, each), each, key=lambda one: one.over_baseline)
    return list(found.values())


def order_finding(n, settings, count):
    """Returns the order of the cheapest of some settings as a Finding."""
    best = min(settings, key=lambda each: each.over_baseline)
    return Finding(f"at n = {n} ({best.integrator})", None, best.order, None, None, count)


def predictable_order_row(accuracy):
    """Says which order of Gauss methods is the cheapest, the median over the problems, and its range."""
    findings = [Finding(f"at {power(each.wanted)}", None, each.median, each.minimum, each.largest, each.problems)
                for each in accuracy.gauss_order]
    return Row(HIGH_ORDER, "while predictable, order of the cheapest Gauss method, median of the problems", None,
               OF_ACCURACY, {"optimised": findings}, has_orders=True)


# ---- threads


def thread_times(study, n, stages, code, threads):
    """Returns the seconds of the formulations by process."""
    return {cell.formulation: cell.seconds for cell in study.tables["threads"]
            if (cell.n, cell.stages, cell.code, cell.threads) == (n, stages, code, threads)}


def competitive(times):
    """Judges "algebra is competitive": it is faster than, or a tie with, the fastest other formulation.

    Returns the result and the Ratio of that one's time to algebra's.
    """
    others = {name: seconds for name, seconds in times.items() if name != "algebra"}
    best = others[fastest(others)]
    over = ratio_of(best, times["algebra"])
    if over.processes < FEWEST or over.low < 1 / MARGIN <= over.high:
        return UNDECIDED, over
    return HOLDS if over.low >= 1 / MARGIN else FAILS, over  # where it is faster or ties, which of both is no matter


def thread_blocks(study):
    """Returns (n, stages, code, threads) of the blocks in which all formulations were timed."""
    keys = dict.fromkeys((cell.n, cell.stages, cell.code, cell.threads) for cell in study.tables["threads"])
    return [key for key in keys if len(thread_times(study, *key)) == len(FORMULATIONS)]


def parallel_rows(study):
    """Says for each s how algebra compares on two threads; of many processors the model's ratio, without a verdict."""
    codes = {WHOLE: "optimised", SWEEPS: SWEEPS}
    measured, of_model = {}, modelled_findings(study)
    for n, stages, code, threads in thread_blocks(study):
        if threads > 1:
            result, ratio = competitive(thread_times(study, n, stages, code, threads))
            found = measured.setdefault(stages, {name: [] for name in codes.values()})
            found[codes[code]].append(Finding(f"{AT_N}{n}", result, ratio.ratio, ratio.low or None,
                                              ratio.high if math.isfinite(ratio.high) else None, 1))
    return [*(Row("parallel", "on two threads algebra is fastest or ties, our reading of “more competitive”", stages,
                  OF_CLAIMS, findings) for stages, findings in measured.items()),
            *(Row("parallel", f"on {PROCESSORS[-1]} processors, ratios of a model: no verdict", stages, OF_CLAIMS,
                  {SWEEPS: findings}) for stages, findings in of_model.items())]


def modelled_findings(study):
    """Returns the same ratio on as many processors as the model goes to, by s.

    There is no verdict. As recorded, a time of the model is 0.73 to 1.3 of the measured one on one and two threads, so
    that a ratio of two may err by a factor of 1.8. All its ratios are nearer to one than that.
    """
    found = {}
    for (n, stages), by_processors in model_ratios(study).items():
        ratios = by_processors[PROCESSORS[-1]]
        ratio = min(ratios[form] for form in FORMULATIONS if form != "algebra") / ratios["algebra"]
        found.setdefault(stages, []).append(Finding(f"{AT_N}{n}", None, ratio, None, None, 1))
    return found


def rates_of(study, n):
    """Returns what a product and a pass take at n, as a Rates."""
    row = next(each for each in study.tables["rates"] if each.n == n)
    return Rates(statistics.geometric_mean(row.product_seconds), statistics.geometric_mean(row.pass_seconds))


def plain_sweeps(study, **wanted):
    """Returns the cells of fast forms with plain sweeps that have these values."""
    wanted["code"] = SWEEPS
    return [cell for cell in study.tables["threads"] if wanted.items() <= cell._asdict().items()]


def modelled(study, cell, processors, seconds=sweep_seconds):
    """Returns the seconds of a run by the model; the update of a step is counted as a sweep."""
    return (cell.sweeps + cell.steps) * seconds(cell.formulation, cell.stages, rates_of(study, cell.n), processors)


def model_ratios(study):
    """Returns the model's times over the least of them, {(n, s): {p: {formulation: ratio}}}, with SPLIT as a p."""
    found = {}
    for n, stages in dict.fromkeys((cell.n, cell.stages) for cell in plain_sweeps(study)):
        cells = {cell.formulation: cell for cell in plain_sweeps(study, n=n, stages=stages, threads=1)}
        if len(cells) < len(FORMULATIONS):
            continue
        times = {p: {form: modelled(study, cell, p) for form, cell in cells.items()} for p in PROCESSORS}
        times[SPLIT] = {form: modelled(study, cell, 1, work_seconds) for form, cell in cells.items()}
        found[n, stages] = {p: {form: each / min(by_form.values()) for form, each in by_form.items()}
                            for p, by_form in times.items()}
    return found


def all_rows(study, runs, recorded):
    """Returns the Rows, by what three studies found.

    `runs` are those of tables by code but Octave's; `recorded` has the Findings of theorem, accuracy and turbulence.
    """
    order = [code for code in CODES if code in {*runs, "octave"}]
    known = {**runs, **({"octave": octave_run(study)} if study.tables["octave"] else {})}
    return [theorem_row(recorded.theorem, study), *speed_rows({code: known[code] for code in order if code in known}),
            *footnote_rows(recorded.theorem), *partitioned_rows(recorded.theorem),
            *exponentials_rows(recorded.accuracy), *parallel_rows(study), *order_rows(recorded.turbulence),
            predictable_order_row(recorded.accuracy)]


# ---- claims.json


def as_json(rows, open_choices, processors):
    """Returns claims.json as bytes, a finding a line.

    `processors` says of each raw file, "claims", "tables" and "avx2", where it was measured: its conditions by name.
    """
    def row_text(row):
        codes = ",\n".join(f"  {json.dumps(code)}: [" + ",\n   ".join(json.dumps(each._asdict()) for each in found)
                           + "]" for code, found in row.findings.items() if found)
        head = ", ".join(f"{json.dumps(name)}: {json.dumps(getattr(row, name))}"
                         for name in ("claim", "statement", "stages", "evidence"))
        return f' {{{head}, "findings": {{\n{codes}}}}}'

    claims, of_choices = (",\n".join(each) for each in (map(row_text, rows),
                                                        (json.dumps(each._asdict()) for each in open_choices)))
    return (f'{{"format": {json.dumps(FORMAT)},\n"processors": {json.dumps(processors)},\n"claims": [\n{claims}\n],\n'
            f'"choices": [\n{of_choices}\n]}}\n').encode("utf-8")


def read_claims_table(path):
    """Returns the Rows and the Choices in claims.json. Throws UnusableFile with one line that names the file."""
    return read_json(path, claims_of)


def claims_of(document):
    require(document, "table of claims", "format", FORMAT)
    found = checked(document, {"claims": list_of(an_object), "choices": list_of(an_object), "processors": an_object},
                    "it")
    kinds = {"claim": text, "statement": any_text, "stages": optional(whole(1)), "evidence": list_of(text),
             "findings": an_object}
    rows = []
    for row in found["claims"]:
        values = checked(row, kinds, "a claim")
        findings = {code: [record(Finding, each) for each in checked(values["findings"], {code: list_of(an_object)},
                                                                     "a claim's findings")[code]]
                    for code in values["findings"] if code in CODES}
        rows.append(Row(**{**values, "findings": findings}))
    return rows, [record(Choice, each) for each in found["choices"]]


def record(kind, values):
    return kind(**checked(values, kind.__annotations__, kind.__name__.lower()))


# ---- as a table


# What stands in one column of the table: codes, and how all but the first are named there.
COLUMNS = {"paper": {}, "octave": {}, "plain": {"plain_avx2": "AVX2"},
           "optimised": {SWEEPS: "plain sweeps", "optimised_avx2": "AVX2"}}


def claims_table(rows):
    """Returns the table of Rows, a column for each code and its variants; the last column names the pages."""
    codes = [code for code, variants in COLUMNS.items()
             if any(row.findings.get(each) for row in rows for each in (code, *variants))]
    columns = (Column("claim", align="left"), *(Column(CODES[code], align="left") for code in codes),
               Column("evidence", align="left"))
    return Table(columns, [[[Entry(statement_text(row)), *(Entry(column_text(row, code)) for code in codes),
                             Entry(", ".join(row.evidence))] for row in rows]])


def statement_text(row):
    of_stages = f", s = {row.stages}" if row.stages else ""
    return f"{row.claim}{of_stages}: {row.statement}"


def column_text(row, code):
    """Writes what was found by a code and, named, by its variants."""
    names = {code: "", **{each: f"{name}: " for each, name in COLUMNS[code].items()}}
    return "; ".join(name + cell_text(row.findings[each], row.has_orders) for each, name in names.items()
                     if row.findings.get(each)) or MISSING


def cell_text(findings, has_orders=False):
    """Writes what was found: results, the range of ratios, and in brackets that of intervals; or orders."""
    if all(each.result == NOT_TESTED for each in findings):
        return NOT_TESTED
    if has_orders:
        return ", ".join(f"{each.result or format(each.ratio, 'g')} {each.where}" for each in findings)
    if any(each.ratio is None for each in findings):
        return counts_text(findings)
    results = results_text(findings)
    ratios = range_text([each.ratio for each in findings])
    intervals = [each for each in findings if each.low is not None and each.high is not None]
    ends = (f" [{three_digits(min(each.low for each in intervals))},"
            f" {three_digits(max(each.high for each in intervals))}]" if intervals else "")
    return f"{results} {ratios}{ends}".strip()


def results_text(findings):
    """Writes the result that all have, or else each result with the n where it came out."""
    places = {}
    for each in findings:
        if each.result:
            places.setdefault(each.result, []).append(each.where)
    if len(places) < 2:
        return "".join(places)
    return ", ".join(f"{result} ({AT_N}{', '.join(each.removeprefix(AT_N) for each in where)})"
                     for result, where in places.items())


def counts_text(findings):
    """Writes counts of results by place, and the range of ratios where there is one."""
    places = {}
    for each in findings:
        places.setdefault(each.where, []).append(each)
    parts = []
    for place, found in places.items():
        of = sum(each.count for each in found)
        said = ", ".join(f"{each.result or 'not judged'} {each.count}" for each in found)
        ends = f": {range_text([found[0].low, found[0].high])}" if found[0].low is not None else ""
        parts.append(f"{said} of {of} ({place}){ends}")
    return "; ".join(parts)


def range_text(values):
    ends = dict.fromkeys(three_digits(each) for each in (min(values), max(values)))
    return "–".join(ends)


def product_shares(study):
    """Returns the share of products in the time of each of Octave's cells, by (formulation, n, stages)."""
    products = {each.n: each.seconds for each in study.tables["octave_products"]}
    return {(cell.formulation, cell.n, cell.stages): statistics.geometric_mean(
        cell.products * product / seconds for product, seconds in zip(products[cell.n], cell.seconds))
        for cell in study.tables["octave"]}


def figures(evidence):
    """Returns the figures that results/README.md may quote, by key.

    octave.difference from C++, octave.apart of two formulations in Octave; octave.s3.algebra_over_group.n129 and so on,
    also of plain_avx2 and optimised_avx2; share.CODE.s3.group.n129, and share.CODE.n129.min and .max;
    open.a.s1.fast.n17.min, .max and .holds; threads.CODE.n65.s3.t2.others_over_algebra and .FORM.speedup;
    model.n65.s3.p64.FORM, and model.check.min and .max.
    """
    study = evidence.study
    found = {name: max(row.difference for row in rows) for name, rows in
             (("octave.difference", study.tables["octave"]), ("octave.apart", study.tables["octave_pairs"])) if rows}
    runs = {"octave": octave_run(study), **{code: evidence.runs[code] for code in ("plain_avx2", "optimised_avx2")
                                            if code in evidence.runs}}
    for code, run in runs.items():
        found |= figures_of(code, run)
    found |= {f"octave.seconds.s{cell.stages}.{cell.formulation}.n{cell.n}": statistics.geometric_mean(cell.seconds)
              for cell in study.tables["octave"]}
    found |= {f"share.octave.s{stages}.{form}.n{n}": share for (form, n, stages), share
              in product_shares(study).items()}
    found |= {f"share.octave.n{n}.{which}": of(shares) for n, shares in shares_by_size(study).items()
              for which, of in (("min", min), ("max", max))}
    for each in choices(study):
        key = f"open.{each.claim.strip('()')}.s{each.stages}.{each.implementation}.n{each.n}"
        found |= {f"{key}.min": each.minimum, f"{key}.max": each.maximum, f"{key}.of": sum(each.results.values()),
                  **{f"{key}.{result}": count for result, count in each.results.items()}}
    return {**found, **thread_figures(study)}


def interpreted(study):
    """Says at which n Octave's times are those of its interpreter: products take less than half the time there."""
    shares = shares_by_size(study)
    sizes = [n for n, found in shares.items() if max(found) < HALF]
    if not sizes:
        return ""
    ranges = ", ".join(f"{percentage(min(shares[n]))} to {percentage(max(shares[n]))} at n = {n}" for n in sizes)
    return f" Share of products in the time: {ranges}. These cells time an interpreter more than formulations."


def shares_by_size(study):
    """Returns the shares of products in the times of Octave's cells, by n."""
    found = {}
    for (_, n, _), share in product_shares(study).items():
        found.setdefault(n, []).append(share)
    return found


def checks(study):
    """Returns the model's time over the measured one, by (n, s, formulation, threads)."""
    return {(cell.n, cell.stages, cell.formulation, cell.threads):
            modelled(study, cell, cell.threads) / statistics.geometric_mean(cell.seconds)
            for cell in plain_sweeps(study)}


def thread_figures(study):
    found, over_algebra = {}, {}
    for n, stages, code, threads in thread_blocks(study):
        times, single = (thread_times(study, n, stages, code, each) for each in (threads, 1))
        key, ratio = f"threads.{code}.n{n}.s{stages}.t{threads}", competitive(times)[1].ratio
        found[f"{key}.others_over_algebra"] = ratio
        over_algebra.setdefault((code, threads), []).append(ratio)
        if threads > 1:
            found |= {f"{key}.{form}.speedup": ratio_of(single[form], times[form]).ratio for form in FORMULATIONS}
    for code in THREAD_CODES:
        if ratios := over_algebra.get((code, 2)):
            found |= {f"threads.{code}.t2.others_over_algebra.min": min(ratios),
                      f"threads.{code}.t2.others_over_algebra.max": max(ratios)}
    if thread_blocks(study):
        checked = checks(study).values()
        found |= {"model.check.min": min(checked), "model.check.max": max(checked)}
        found |= {f"model.n{n}.s{stages}.{p if p == SPLIT else f'p{p}'}.{form}": ratio
                  for (n, stages), by_p in model_ratios(study).items() for p, by_form in by_p.items()
                  for form, ratio in by_form.items()}
        found |= {f"model.path.s{stages}.{form}": path_products(form, stages)
                  for stages in sorted({cell.stages for cell in study.tables["threads"]}) for form in FORMULATIONS}
    return found


HALF = 0.5  # of the time of a cell; below, it is not products that are timed
