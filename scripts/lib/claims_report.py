"""The report and the figures of the study of the paper's claims."""

import statistics
from typing import Dict, NamedTuple, Optional

from lib import claims_table
from lib.claims import figures_of
from lib.claims_files import SWEEPS, THREAD_CODES, octave_run
from lib.claims_table import (CODES, SPLIT, choices, competitive, model_ratios, modelled, plain_sweeps, product_shares,
                              thread_blocks, thread_times)
from lib.comparison import (MISSING, Comparison, both_sides, percentage, ratio_text, ratios_section, three_digits,
                            time_with_interval, times_section, verdict_rules)
from lib.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table
from lib.formats import FORMULATIONS, Run, Study
from lib.messages import UnusableFile
from lib.numbers import scientific
from lib.paper_table import claims_section
from lib.parallel_model import PROCESSORS, path_products
from lib.verdicts import FEWEST, ratio_of

HALF = 0.5  # of the time of a cell; below, it is not products that are timed
AVX2_KERNELS = ("Haswell", "Zen")  # of OpenBLAS
NO_AVX2 = "Tables 1 and 2 as they are recorded have AVX2 kernels."
NOT_MEASURED = "Not measured: the tables that are recorded have other kernels, and none with AVX2 kernels was given."


class Evidence(NamedTuple):
    """What the claims are judged by."""

    study: Study
    runs: Dict[str, Run]  # of tables, by code; not Octave's
    published: Run  # the paper's seconds
    avx2: Optional[Dict[str, str]]  # the context of the tables with AVX2 kernels
    recorded: Dict[str, Dict[str, float]]  # figures of recorded studies: theorem, accuracy, turbulence if there is one

    def rows(self):
        return claims_table.all_rows(self.study, {"paper": self.published, **self.runs}, self.recorded)

    def processors(self):
        """Returns where each raw file was measured: its cpu and blas_kernels, by the name of the file."""
        contexts = {"claims": self.study.context, "tables": self.runs["optimised"].context, "avx2": self.avx2}
        return {name: {each: context.get(each, "not recorded") for each in ("cpu", "blas_kernels")}
                for name, context in contexts.items() if context is not None}


def has_avx2_kernels(context):
    """Tells whether a table was measured with AVX2 kernels, in OpenBLAS and in ours."""
    return context.get("blas_kernels") in AVX2_KERNELS and "avx512" not in context.get("products", "avx512").lower()


def require_avx2(context):
    """Throws UnusableFile unless a table was measured with AVX2 kernels."""
    if not has_avx2_kernels(context):
        raise UnusableFile(f"was not measured with AVX2 kernels (OpenBLAS: {context.get('blas_kernels')}; products:"
                           f" {context.get('products')})")


# ---- the document


def sections(evidence):
    study = evidence.study
    return [
        Heading("What became of the paper's claims", 1),
        Paragraph("Each claim against the codes it was looked at in. What it means is said in results/README.md. Time"
                  " ratios: for (a) and (b) the fastest other row over the row that is said to be fastest, for (c)"
                  " algebra over the fastest other; range over n, in brackets that of the 95 % intervals. Exponentials:"
                  " the paper speaks of the methods of Bogfjellmo and Marthinsen, which were not run. Ours are other"
                  " methods; their ratio is Gauss over the exponential method at equal error. Parallel: the fastest"
                  " other formulation over algebra, range over n and s. Order: of the cheapest setting, undecided with"
                  f" fewer than {FEWEST} draws. Fast forms, plain sweeps: Picard sweeps from a cold start on full"
                  " matrices. The paper's column has ratios of its printed seconds only."),
        *processor_sections(evidence.processors()),
        claims_table.claims_table(evidence.rows()),
        *(octave_sections(study, evidence.published) if study.tables["octave"] else []),
        *avx2_sections(evidence),
        *choice_sections(study),
        *(share_sections(evidence) if study.tables["octave"] else []),
        *(thread_sections(study) if thread_blocks(study) else []),
        conditions(study.context)]


def processor_sections(processors):
    """Says so where parts of the evidence are of different processors or kernels; AVX2 kernels are others by design."""
    claims, tables = processors["claims"], processors["tables"]
    same_cpu = all(each["cpu"] == tables["cpu"] for each in processors.values())
    if same_cpu and claims["blas_kernels"] == tables["blas_kernels"]:
        return []
    names = {"claims": "Octave, draws and threads", "tables": "plain and optimised C++", "avx2": "AVX2 tables"}
    places = "; ".join(f"{names[name]}: {each['cpu']}, OpenBLAS kernels {each['blas_kernels']}"
                       for name, each in processors.items())
    return [Paragraph(f"Columns of the table were not all measured on one processor with the same kernels. {places}.")]


def octave_sections(study, published):
    comparison = Comparison(octave_run(study), published)
    worst = max(cell.difference for cell in study.tables["octave"])
    apart = max((pair.difference for pair in study.tables["octave_pairs"]), default=0.0)
    heading, *rest = claims_section(comparison)
    return [
        *times_section(comparison, "GNU Octave", "CPU seconds of the 50-step run (T = 5, h = 0.1) by plain GNU Octave"
                       f" {study.settings.octave}, benchmarks/octave, beside the paper's MATLAB. One thread, OpenBLAS"
                       f" kernels {study.settings.octave_kernels}. Answers differ from those in C++ by at most"
                       f" {scientific(worst)} in an entry, those of two formulations in Octave by at most"
                       f" {scientific(apart)}.{interpreted(study)}"),
        *ratios_section(comparison),
        Heading("Claims in GNU Octave"), *rest]


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


def avx2_sections(evidence):
    if evidence.avx2 is None:
        recorded = has_avx2_kernels(evidence.runs["optimised"].context)
        return [Heading("AVX2 kernels"), Paragraph(NO_AVX2 if recorded else NOT_MEASURED)]
    found = [Heading("AVX2 kernels"),
             Paragraph(f"Tables 1 and 2 again, built for x86-64-v3, OpenBLAS with the kernels"
                       f" {evidence.avx2['blas_kernels']}, products: {evidence.avx2['products']}.")]
    for code in ("plain_avx2", "optimised_avx2"):
        comparison = Comparison(evidence.runs[code], evidence.published)
        _, _, _, table = claims_section(comparison)
        found += [Heading(CODES[code], 3), both_sides(comparison, lambda times, name: time_with_interval(times[name])),
                  table]
    return found


def choice_sections(study):
    rows = [[each.claim, str(each.stages), str(each.n), each.implementation,
             ", ".join(f"{result} {count}" for result, count in each.results.items()),
             three_digits(each.least), three_digits(each.most)] for each in choices(study)]
    if not rows:
        return []
    draws = len({cell.draw for cell in study.tables["draws"]})
    columns = (Column("claim", align="left"), Column("s"), Column("n"), Column("implementation", align="left"),
               Column("results", align="left"), Column("least ratio"), Column("largest ratio"))
    return [Heading("What the paper leaves open"),
            Paragraph(f"The claims with {draws} seeded draws of the initial modes up to l = 4, all of one variance,"
                      " each with both ħ: how often each result came out, and the range of the ratio."),
            plain_table(columns, rows)]


def share_sections(evidence):
    """Shows why codes differ: sweeps, products, and the share of the time that the products take."""
    shares, blocks = product_shares(evidence.study), []
    for cell in evidence.study.tables["octave"]:
        key = (cell.formulation, cell.n, cell.stages)
        plain, optimised = (evidence.runs[code].cell(*key) for code in ("plain", "optimised"))
        equivalent = optimised.counters.get("equivalent_products") if optimised else None
        blocks.append([str(cell.n), str(cell.stages), cell.formulation, three_digits(cell.sweeps),
                       three_digits(cell.products), three_digits(equivalent) if equivalent else MISSING,
                       percentage(shares[key]), *map(share_text, (plain, optimised))])
    columns = (Column("n"), Column("s"), Column("formulation", align="left"), Column("sweeps"), Column("products"),
               Column("full products, optimised"), *(Column(name, "share of products")
                                                     for name in ("Octave", "plain C++", "optimised C++")))
    return [Heading("Why they differ"),
            Paragraph("A run of 50 steps. Sweeps and products are those of Octave and of plain C++, which are the same"
                      " up to rounding; full products are those of optimised C++. Share of products: what the products"
                      " take at the rate measured in the same process, over the whole time. The rest goes to Poisson"
                      " solves, sums over stages and norms, all O(n²), and in Octave to interpretation. Above 100 %"
                      " products of an adjoint took less than a plain one."),
            plain_table(columns, blocks)]


def share_text(cell):
    """Writes the share of products in the time of a cell of a table, which may be missing or have failed."""
    share = cell and cell.counters.get("product_share")
    return MISSING if share is None else percentage(share)


# ---- threads


def thread_sections(study):
    return [Heading("Threads"),
            Paragraph("Time that passes in the first steps of the smooth scene by the fast forms. Plain sweeps: Picard"
                      " sweeps from a cold start on full matrices, as the paper's iteration; whole: with predictor,"
                      " Newton corrections and bands. Competitive, as we read it: algebra is faster than the fastest"
                      " other formulation at as many threads, or a tie; the ratio is that one's time over algebra's."
                      " Speed-up: one thread over two. " + verdict_rules()),
            threads_table(study),
            Heading("A model of more processors"),
            Paragraph("A sweep as tasks that are whole matrices: products, Poisson solves and linear combinations, in"
                      " phases (scripts/lib/parallel_model.py). Within a phase tasks are independent. Algebra forms all"
                      " products of a sweep in one phase, cotangent in two, of which one forms triangles, group in"
                      " three. A product and a pass take what they took in the same processes. Model over measured:"
                      " the time by the model over that of plain sweeps. What it says of many processors is no verdict:"
                      " a ratio of two times of the model errs by as much as the largest entry of this table over the"
                      " least."),
            check_table(study),
            Paragraph("The model's time of a run on p processors, relative to that of the fastest formulation there;"
                      " which of two is faster is not told where they differ by less than the model's error. Path:"
                      " full products on the critical path of a sweep. Split: if the work of each formulation were"
                      " split evenly, at any p."),
            model_table(study)]


def threads_table(study):
    rows = []
    for n, stages, code, threads in thread_blocks(study):
        times = thread_times(study, n, stages, code, threads)
        single = thread_times(study, n, stages, code, 1)
        result, ratio = competitive(times)
        rows.append([str(n), str(stages), {SWEEPS: "plain sweeps"}.get(code, code), str(threads),
                     *(three_digits(ratio_of(times[form], [1.0] * len(times[form])).ratio) for form in FORMULATIONS),
                     *(three_digits(ratio_of(single[form], times[form]).ratio) if threads > 1 else MISSING
                       for form in FORMULATIONS), result, ratio_text(ratio)])
    columns = (Column("n"), Column("s"), Column("code", align="left"), Column("threads"),
               *(Column(form, group) for group in ("seconds", "speed-up") for form in FORMULATIONS),
               Column("competitive", align="left"), Column("ratio"))
    return plain_table(columns, rows)


def checks(study):
    """Returns the model's time over the measured one, by (n, s, formulation, threads)."""
    return {(cell.n, cell.stages, cell.formulation, cell.threads):
            modelled(study, cell, cell.threads) / statistics.geometric_mean(cell.seconds)
            for cell in plain_sweeps(study)}


def check_table(study):
    found = checks(study)
    threads = sorted({key[3] for key in found})
    rows = [[str(n), str(stages), form, *(three_digits(found[n, stages, form, each]) for each in threads)]
            for n, stages, form in dict.fromkeys(key[:3] for key in found)]
    return plain_table((Column("n"), Column("s"), Column("formulation", align="left"),
                        *(Column(f"{each} thread{'s' * (each > 1)}", "model over measured") for each in threads)), rows)


def model_table(study):
    blocks = []
    for (n, stages), found in model_ratios(study).items():
        blocks.append([[Entry(text, marked) for text, marked in (
            (str(n), False), (str(stages), False), (form, False), (f"{path_products(form, stages):g}", False),
            *((three_digits(found[p][form]), found[p][form] == 1) for p in (*PROCESSORS, SPLIT)))]
            for form in FORMULATIONS])
    return Table((Column("n"), Column("s"), Column("formulation", align="left"), Column("path"),
                  *(Column(f"p = {p}") for p in PROCESSORS), Column("split")), blocks)


# ---- figures


def figures(evidence):
    """Returns the figures that results/README.md may quote, by key.

    octave.difference from C++, octave.apart of two formulations in Octave; octave.s3.algebra_over_group.n129 and so on,
    also of plain_avx2 and optimised_avx2; share.CODE.s3.group.n129, and share.CODE.n129.least and .most;
    open.a.s1.fast.n17.least, .most and .holds; threads.CODE.n65.s3.t2.others_over_algebra and .FORM.speedup;
    model.n65.s3.p64.FORM, and model.check.least and .most.
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
              for which, of in (("least", min), ("most", max))}
    for each in choices(study):
        key = f"open.{each.claim.strip('()')}.s{each.stages}.{each.implementation}.n{each.n}"
        found |= {f"{key}.least": each.least, f"{key}.most": each.most, f"{key}.of": sum(each.results.values()),
                  **{f"{key}.{result}": count for result, count in each.results.items()}}
    return {**found, **thread_figures(study)}


def thread_figures(study):
    found = {}
    for n, stages, code, threads in thread_blocks(study):
        times, single = (thread_times(study, n, stages, code, each) for each in (threads, 1))
        key = f"threads.{code}.n{n}.s{stages}.t{threads}"
        found[f"{key}.others_over_algebra"] = competitive(times)[1].ratio
        if threads > 1:
            found |= {f"{key}.{form}.speedup": ratio_of(single[form], times[form]).ratio for form in FORMULATIONS}
    for code in THREAD_CODES:
        ratios = [value for key, value in found.items() if key.startswith(f"threads.{code}.")
                  and key.endswith(".t2.others_over_algebra")]
        if ratios:
            found |= {f"threads.{code}.t2.others_over_algebra.least": min(ratios),
                      f"threads.{code}.t2.others_over_algebra.most": max(ratios)}
    if thread_blocks(study):
        checked = checks(study).values()
        found |= {"model.check.least": min(checked), "model.check.most": max(checked)}
        found |= {f"model.n{n}.s{stages}.{p if p == SPLIT else f'p{p}'}.{form}": ratio
                  for (n, stages), by_p in model_ratios(study).items() for p, by_form in by_p.items()
                  for form, ratio in by_form.items()}
        found |= {f"model.path.s{stages}.{form}": path_products(form, stages)
                  for stages in sorted({cell.stages for cell in study.tables["threads"]}) for form in FORMULATIONS}
    return found
