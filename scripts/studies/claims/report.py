"""The report and the figures of the study of the paper's claims."""

import os
from typing import Dict, NamedTuple, Optional

from lib.programs.messages import UnusableFile
from lib.records.findings import FILE, read_findings
from lib.records.formats import FORMULATIONS, Study, read_json
from lib.records.table_file import Run
from lib.judging.verdicts import ratio_of
from lib.pages.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table
from lib.pages.numbers import MISSING, percentage, scientific, three_digits
from lib.pages.rendering import Rendering, beside
from studies.accuracy import judge as accuracy
from studies.claims import judge
from studies.claims.judge import (CODES, EXPLAINED, SPLIT, checks, choices, competitive, figures, interpreted,
                                  model_ratios, product_shares, thread_blocks, thread_times)
from studies.claims.parallel_model import PROCESSORS, path_products
from studies.claims.schema import SWEEPS, octave_run, read_claims
from studies.tables.comparison import (Comparison, both_sides, ratio_text, ratios_section, read_published,
                                       time_with_interval, times_section, verdict_rules)
from studies.tables.paper import PUBLISHED, claims_section
from studies.tables.report import TABLES, runs_of
from studies.theorem import judge as theorem
from studies.turbulence import judge as turbulence

AVX2_KERNELS = ("Haswell", "Zen")  # of OpenBLAS
NO_AVX2 = "Tables 1 and 2 as they are recorded have AVX2 kernels."
NOT_MEASURED = "Not measured: the tables that are recorded have other kernels, and none with AVX2 kernels was given."


class Recorded(NamedTuple):
    """What the recorded studies found that claims are judged by."""

    theorem: theorem.Findings
    accuracy: accuracy.Findings
    turbulence: Optional[turbulence.Findings]  # which may not be recorded yet


class Evidence(NamedTuple):
    """What the claims are judged by."""

    study: Study
    runs: Dict[str, Run]  # of tables, by code; not Octave's
    published: Run  # the paper's seconds
    avx2: Optional[Dict[str, str]]  # the context of the tables with AVX2 kernels
    recorded: Recorded

    def rows(self):
        return judge.all_rows(self.study, {"paper": self.published, **self.runs}, self.recorded)

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
        Paragraph("Each claim against the codes it was looked at in. What it means is said in results/README.md."
                  f" {EXPLAINED}"),
        *processor_sections(evidence.processors()),
        judge.claims_table(evidence.rows()),
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
    names = {"claims": "Octave, samples and threads", "tables": "published and fast code", "avx2": "AVX2 tables"}
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
             three_digits(each.minimum), three_digits(each.maximum)] for each in choices(study)]
    if not rows:
        return []
    samples = len({cell.sample for cell in study.tables["samples"]})
    columns = (Column("claim", align="left"), Column("s"), Column("n"), Column("implementation", align="left"),
               Column("results", align="left"), Column("least ratio"), Column("largest ratio"))
    return [Heading("What the paper leaves open"),
            Paragraph(f"The claims with {samples} seeded samples of the initial modes up to l = 4, all of one variance,"
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
               Column("full products, fast"), *(Column(name, "share of products")
                                                for name in ("Octave", "published code", "fast code")))
    return [Heading("Why they differ"),
            Paragraph("A run of 50 steps. Sweeps and products are those of Octave and of published code, which are the"
                      " same up to rounding; full products are those of fast code. Share of products: what the products"
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
                      " phases (scripts/studies/claims/parallel_model.py). Within a phase tasks are independent."
                      " Algebra forms all products of a sweep in one phase, cotangent in two, of which one forms"
                      " triangles, group in three. A product and a pass take what they took in the same processes."
                      " Model over measured: the time by the model over that of plain sweeps. What it says of many"
                      " processors is no verdict: a ratio of two times of the model errs by as much as the largest"
                      " entry of this table over the least."),
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


CODES_OF = {"published": "plain", "fast": "optimised"}  # by implementation


def tables_of(path, suffix=""):
    """Returns the Runs in the raw file of a table, by code."""
    return {CODES_OF[each] + suffix: run for each, run in runs_of(path, tuple(TABLES)).items()}


def avx2_tables(path):
    """Returns the Runs with AVX2 kernels by code, and their context. Throws UnusableFile for other kernels."""
    runs = tables_of(path, "_avx2")
    context = runs["optimised_avx2"].context
    read_json(path, lambda _: require_avx2(context))
    return runs, context


def recorded_findings(folder):
    """Returns what the studies recorded in a folder found, as a Recorded. Throws UnusableFile."""
    def found_by(study, kind):
        return read_findings(os.path.join(folder, study, FILE), study, kind)

    has_turbulence = os.path.exists(os.path.join(folder, "turbulence", FILE))
    return Recorded(found_by("theorem", theorem.Findings), found_by("accuracy", accuracy.Findings),
                          found_by("turbulence", turbulence.Findings) if has_turbulence else None)


def rendered(raw, recorded):
    """Returns the Rendering of a raw file by the recorded studies, with Tables 1 and 2 by AVX2 kernels beside it."""
    path = beside(raw, "avx2.json")
    avx2, context = avx2_tables(path) if path else ({}, None)
    evidence = Evidence(read_claims(raw), {**tables_of(os.path.join(recorded, "tables", "raw.json")), **avx2},
                        read_published(PUBLISHED), context, recorded_findings(recorded))
    return Rendering(lambda _: sections(evidence), figures(evidence), files={
        "claims.json": judge.as_json(evidence.rows(), judge.choices(evidence.study), evidence.processors())})
