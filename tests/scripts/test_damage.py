"""What is wrong with a raw file of any study is told in one line, and nothing is made of it.

Each study has a small sound file, made up. Each kind of damage is done to each part of it, table and column; and each
study refuses tables that contradict each other. What is refused names the file and the part.
"""

import copy
import json
import os
import unittest

import claims_documents
import limits_documents
import practice_documents
import scaling_documents
import study_documents
import threads_documents
from programs import HAS_MODULE, RENDER, ROOT, FolderTest, run_script, text_of

from studies.accuracy.lines import read_accuracy
from studies.accuracy.schema import SCHEMA as ACCURACY
from studies.claims import schema as claims_files
from studies.fluid import schema as fluid_files
from studies.limits import schema as limits_files
from studies.longruns import schema as longruns_files
from studies.practice import schema as practice_files
from studies.scaling import schema as scaling_table
from studies.threads import schema as threads_table
from studies.claims.judge import read_claims_table
from lib.pages.figures import read_figures
from lib.records.formats import LATER_FIELDS, LISTED, listed, listed_integrators, study_of, write_study
from lib.programs.messages import UnusableFile
import test_longruns

if HAS_MODULE:
    from studies.theorem import schema as theorem_table
    from studies.turbulence import schema as turbulence_files
    import test_theorem
    import test_turbulence


def write_theorem(folder):
    path = os.path.join(folder, "raw.json")
    study = test_theorem.made_up(test_theorem.Report.ROWS)
    test_theorem.formats.write_study(path, theorem_table.SCHEMA, study.context, study.settings, study.tables)
    return path


def write_longruns(folder):
    points = [test_longruns.made_point(method, steps) for method in ("rk4", "group2") for steps in (500, 1000)]
    few = {"energy_errors": [1e-6] * 4, "energy_means": [1e-7] * 4, "spectrum_errors": [1e-14] * 4}
    runs = [test_longruns.made_long_run(method, **few) for method in ("rk4", "group2")]
    return test_longruns.write_longruns(folder, test_longruns.made_study(points, runs))


def write_fluid(folder):
    path = os.path.join(folder, "raw.json")
    state = {"energies": (0.5, 0.25), "vorticity": (0,) * (fluid_files.ROWS * fluid_files.COLUMNS)}
    write_study(path, fluid_files.SCHEMA, {"cpu": "made up"}, fluid_files.Settings(3, 0, 1.5), {
        "integrators": [listed("rk4")], "starts": [fluid_files.Start(**state)],
        "ends": [fluid_files.End("rk4", 0.5, 1e-8, 10.0, 80.0, 1e-3, 0.9, 0.1, **state)]})
    return path


def write_threads(folder):
    return threads_documents.write_threads(os.path.join(folder, "raw.json"), [
        threads_documents.run(), threads_documents.run(2)])


def write_scaling(folder):
    points = [scaling_documents.point(ablation=ablation) for ablation in ("published", "fast")]
    return scaling_documents.write_tables(
        os.path.join(folder, "raw.json"), points=points, memory=[scaling_table.Memory(17, 1e9)],
        rates=[scaling_table.Rate(17, "fast", [1e-7])],
        threads=[scaling_table.TwoThreads(50.0, 65, "rk4_frame", 0.1, 1e-13, [1.0, 2.0], [1.0, 1.0])])


# Of each study: what writes a sound file into a folder, its schema, what reads it, and what renders it.
STUDIES = {
    "accuracy": (lambda folder: study_documents.write_study(folder, study_documents.small_study()),
                 ACCURACY, read_accuracy, "accuracy"),
    "claims": (claims_documents.write_claims, claims_files.SCHEMA, claims_files.read_claims, "claims"),
    "fluid": (write_fluid, fluid_files.SCHEMA, fluid_files.read_fluid, "fluid"),
    "limits": (lambda folder: limits_documents.write(folder, limits_documents.limits_study()), limits_files.SCHEMA,
               limits_files.read_limits, "limits"),
    "longruns": (write_longruns, longruns_files.SCHEMA, longruns_files.read_longruns, "longruns"),
    "practice": (lambda folder: practice_documents.write_practice(os.path.join(folder, "raw.json")),
                 practice_files.SCHEMA, practice_files.read_practice, "practice"),
    "scaling": (write_scaling, scaling_table.SCHEMA, scaling_table.read_scaling, "scaling"),
    "threads": (write_threads, threads_table.SCHEMA, threads_table.read_threads, None)}
if HAS_MODULE:
    STUDIES |= {
        "theorem": (write_theorem, theorem_table.SCHEMA, theorem_table.read_theorem, "theorem"),
        "turbulence": (lambda folder: test_turbulence.write_turbulence(os.path.join(folder, "raw.json")),
                       turbulence_files.SCHEMA, turbulence_files.read_turbulence, "turbulence")}


# ---- damage to any file

NO_KIND = {"of no": "kind"}


def without(parts, name):
    return {key: value for key, value in parts.items() if key != name}


def damaged_texts(sound):
    """Yields (text, words that a refusal must have) of files that are no JSON, or whose end is missing."""
    yield "", ("empty",)
    yield "\n", ("empty",)
    for end in (1, len(sound) // 2, len(sound) - 3):
        yield sound[:end], ("JSON",)
    yield "[" * 200000, ("JSON",)


def damaged_parts(document, schema):
    """Yields the same of whole parts: of other formats and studies, without a part, or with one that is no object."""
    for foreign in ([], 7, None, {}, "text"):
        yield json.dumps(foreign), (schema.study,)
    yield {**document, "format": "isosyrk study 0"}, ("format", "isosyrk study 0")
    other = "limits" if schema.study != "limits" else "scaling"
    yield {**document, "study": other}, ("study", other)
    for name in document:
        yield without(document, name), (name,)
    for name in ("context", "settings", "tables"):
        yield {**document, name: []}, (name,)
    for name in document["settings"]:
        yield {**document, "settings": {**document["settings"], name: NO_KIND}}, (name,)
        if name not in schema.settings._field_defaults:
            yield {**document, "settings": without(document["settings"], name)}, (name,)


def damaged_tables(document, schema):
    """Yields the same of each table: its columns, the lengths of its rows, and each column in a row."""
    for name, table in document["tables"].items():
        def changed(name=name, table=table, **changes):
            return {**document, "tables": {**document["tables"], name: {**table, **changes}}}

        if name not in schema.later:
            yield {**document, "tables": without(document["tables"], name)}, (name,)
        for wrong in ([], None, 7):
            yield {**document, "tables": {**document["tables"], name: wrong}}, (name,)
        columns, rows = table["columns"], table["rows"]
        for wrong in (None, [], columns[:-1], [*columns, "more"], [*columns[:-1], "other"], [*columns[:-1], columns[0]],
                      [*columns[:-1], 7], [*columns, columns[0]]):
            yield changed(columns=wrong), (name,)
        for more in ("more", columns[0]):  # in every row, too
            yield changed(columns=[*columns, more], rows=[[*row, row[0]] for row in rows]), (name, "columns")
        for wrong in (None, {}, [7], [*rows, []], [*rows, [1]], *([[rows[0][:-1]], [[*rows[0], 1]]] if rows else [])):
            yield changed(rows=wrong), (name,)
        for place, column in enumerate(columns if rows else ()):
            for value in (NO_KIND, *([float("nan"), float("inf"), -1e300, True] if is_number(rows[-1][place]) else ())):
                row = [*rows[-1][:place], value, *rows[-1][place + 1:]]
                yield changed(rows=[*rows[:-1], row]), (name, column)
            if isinstance(rows[-1][place], list) and rows[-1][place]:
                row = [*rows[-1][:place], [*rows[-1][place][:-1], NO_KIND], *rows[-1][place + 1:]]
                yield changed(rows=[*rows[:-1], row]), (name, column)
        if rows:
            yield changed(rows=[*rows, rows[0]]), (name, "twice")


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


class DamageTest(FolderTest):
    def assert_unusable(self, read, contents, *words):
        path = self.write("damaged.json", contents if isinstance(contents, (str, bytes)) else json.dumps(contents))
        with self.assertRaises(UnusableFile) as caught:
            read(path)
        self.assert_one_line(f"{caught.exception}\n", "damaged.json", *words)


class Matrix(DamageTest):
    def test_every_damage_to_every_file_is_told_in_one_line(self):
        for study, (write, schema, read, _) in STUDIES.items():
            path = write(self.folder)
            text = text_of(path)
            document, count = json.loads(text), 0
            read(path)  # the control: it is sound
            self.assertEqual(set(schema.tables) - set(document["tables"]), set(schema.later) - set(document["tables"]))
            for contents, words in (*damaged_texts(text), *damaged_parts(document, schema),
                                    *damaged_tables(document, schema)):
                count += 1
                with self.subTest(study=study, words=words, contents=str(contents)[:100]):
                    self.assert_unusable(read, contents, *words)
            self.assert_unusable(read, b"\xff\xfe", "UTF-8")
            self.assertGreater(count, 60, study)

    def test_files_under_earlier_names_of_tables_and_columns_are_read_alike_but_not_under_both(self):
        for study, (write, schema, read, _) in STUDIES.items():
            document = json.loads(text_of(write(self.folder)))
            now = study_of(document, schema).tables
            earlier = {new: old for old, new in schema.renamed.items()}
            for name, table in document["tables"].items():
                if not {name, *table["columns"]} & {*earlier}:
                    continue
                columns = [earlier.get(column, column) for column in table["columns"]]
                tables = {**without(document["tables"], name), earlier.get(name, name): {**table, "columns": columns}}
                with self.subTest(study=study, table=name):
                    self.assertEqual(study_of({**document, "tables": tables}, schema).tables, now)
                    with self.assertRaises(UnusableFile):  # the control: not by chance
                        study_of({**document, "tables": tables}, schema._replace(renamed={}))
                    if name in earlier:
                        both = {**document["tables"], earlier[name]: table}
                        self.assert_unusable(read, {**document, "tables": both}, "earlier name")

    def test_a_missing_file_and_a_folder(self):
        for study, (_, _, read, _) in STUDIES.items():
            for path in (self.path("none.json"), self.folder):
                with self.subTest(study=study), self.assertRaises(UnusableFile) as caught:
                    read(path)
                self.assert_one_line(f"{caught.exception}\n", path, "cannot be read")

    def test_what_renders_ends_with_2_and_writes_nothing(self):
        for study, (write, _, _, rendering) in STUDIES.items():
            if not rendering:
                continue
            document = json.loads(text_of(write(self.folder)))
            path = self.write("damaged.json", json.dumps(without(document, "settings")))
            with self.subTest(study=study):
                self.assert_refused(run_script(RENDER, rendering, path, "--out", self.path("out")),
                                    "damaged.json", "settings")
                self.assertFalse(os.path.exists(self.path("out")))


class OtherFiles(DamageTest):
    def test_figures_claims_and_the_list_of_integrators(self):
        figures = json.dumps({"a": 1.5, "b": 7})
        claims = text_of(ROOT, "results", "recorded", "claims", "claims.json")
        for read, sound, damaged in (
                (read_figures, figures, (("[]", "figures"), ('{"a": "1"}', "a"), ('{"a": NaN}', "a"))),
                (read_claims_table, claims, (('{"format": "x"}', "format"),
                                             ('{"format": "isosyrk claims 1"}', "claims"),
                                             (claims.replace('"claims": [', '"claims": [7, ', 1), "claims"),
                                             (claims.replace('"result"', '"verdict"', 1), "result")))):
            read(self.write("sound.json", sound))
            for contents, *words in (*damaged, ("", "empty"), (sound[:-3], "JSON"), (b"\xff", "UTF-8")):
                with self.subTest(read=read.__name__, words=words):
                    self.assert_unusable(read, contents, *words)
        self.assertIn("group2", listed_integrators())
        self.assertEqual([row[0] for row in json.loads(text_of(LISTED))["rows"]], list(listed_integrators()))

    def test_integrators_of_an_older_file_are_those_of_the_recorded_list(self):
        write, schema, read, _ = STUDIES["accuracy"]
        sound = json.loads(text_of(write(self.folder)))
        table = sound["tables"]["integrators"]
        kept = [place for place, column in enumerate(table["columns"]) if column not in LATER_FIELDS]

        def older(rows, places):
            found = {"columns": [table["columns"][place] for place in places],
                     "rows": [[row[place] for place in places] for row in rows]}
            return {**sound, "tables": {**sound["tables"], "integrators": found}}

        expected = study_of(sound, schema).tables["integrators"]
        self.assertEqual(study_of(older(table["rows"], kept), schema).tables["integrators"], expected)
        unknown = [["euler", *row[1:]] for row in table["rows"]]
        self.assert_unusable(read, older(unknown, kept), "euler", "integrators.json")
        # Some of the later fields are those of no file.
        for left_out in LATER_FIELDS:
            places = [place for place, column in enumerate(table["columns"]) if column != left_out]
            self.assert_unusable(read, older(table["rows"], places), "integrators", "columns", left_out)
        # A file without the table: those of its rows.
        document = json.loads(text_of(write_scaling(self.folder)))
        del document["tables"]["integrators"]
        self.assertEqual(study_of(document, scaling_table.SCHEMA).tables["integrators"],
                         [listed("group2"), listed("rk4_frame")])


# ---- tables that contradict each other


class Tables:
    """The tables of a document, to be changed."""

    def __init__(self, document):
        self.document = copy.deepcopy(document)

    def rows(self, name):
        """Returns the rows of a table as dicts."""
        table = self.document["tables"][name]
        return [dict(zip(table["columns"], row)) for row in table["rows"]]

    def put(self, name, rows):
        table = self.document["tables"][name]
        table["rows"] = [[row[column] for column in table["columns"]] for row in rows]
        return self.document


def keep(name, holds):
    """Returns a change that leaves only the rows of a table that hold."""
    return lambda tables: tables.put(name, [row for row in tables.rows(name) if holds(row)])


def none(name):
    return keep(name, lambda row: False)


def change(name, holds=lambda row: True, **values):
    """Returns a change of the first row that holds; a value may be a function of what was there."""
    def changed(tables):
        rows = tables.rows(name)
        row = next(filter(holds, rows))
        row.update({column: value(row[column]) if callable(value) else value for column, value in values.items()})
        return tables.put(name, rows)
    return changed


def change_all(name, **values):
    def changed(tables):
        return tables.put(name, [{**row, **{column: value(row) for column, value in values.items()}}
                                 for row in tables.rows(name)])
    return changed


def is_of(**values):
    return lambda row: values.items() <= row.items()


CONTRADICTIONS = {
    "accuracy": (
        *((none(table), "no references or no integrators") for table in ("references", "integrators")),
        (keep("lines", lambda row: row["integrator"] != "rk4"), "runs of rk4"),
        (keep("integrators", lambda row: row["name"] != "rk4"), "runs of rk4"),
        (change("runs", n=33), "n = 33"), (change("runs", scene="calm"), "calm"),
        (change("comparisons", candidate="euler"), "candidate"), (change("lines", end="tired"), "end"),
        (change("runs", is_of(status="converged"), cpu_seconds=[0.0]), "cpu_seconds")),
    "claims": (
        (none("rates"), "rates has no n = 65"), (keep("octave_products", is_of(n=17)), "n = 33"),
        (keep("threads", lambda row: row["threads"] > 1), "no single thread"),
        (change("threads", seconds=lambda found: found[:2]), "unequally many"),
        (change("octave", seconds=[]), "one time or more")),
    "fluid": (
        (none("starts"), "not one row"), (none("integrators"), "has no rk4"),
        (change("ends", energies=[0.5]), "energies of another n"), (change("ends", vorticity=[0]), "vorticity")),
    "limits": (
        (none("limits"), "no limits"), (change("limits", grid="++?"), "unknown outcomes"),
        (keep("states", is_of(state=0)), "a state that it does not list"),
        (keep("integrators", is_of(name="rk4")), "limits of"),
        (keep("limits", is_of(integrator="rk4")), "survived steps without critical ones")),
    "longruns": (
        (none("points"), "no runs"), (change("points", n=65), "without its plan"),
        (change("long_runs", n=17), "more than one n"), (change("long_runs", integrator="rk5_frame"), "its integrator"),
        (change("points", integrator="rk5_frame"), "its integrator")),
    "practice": (
        (none("problems"), "no problems"), (change("problems", n=65), "without the problem"),
        (keep("integrators", lambda row: row["name"] != "elp4_frame"), "runs of elp4_frame"),
        (keep("runs", lambda row: row["role"] != "practice"), "not one run of the practice"),
        (change("runs", is_of(role="quflow"), role="practice"), "not one run of the practice"),
        (change("runs", is_of(wanted="tenth"), wanted="same"), "has a run twice"),
        (change("runs", error=None), "with steps and without errors"),
        (change("runs", steps=None), "with steps and without errors"),
        (change("runs", cpu_seconds=[1.0]), "not timed by the same processes"),
        (change_all("runs", cpu_seconds=lambda row: []), "not timed by the same processes"),
        (change("runs", is_of(steps=None), cpu_seconds=[1.0] * 6), "not timed by the same processes"),
        (change("threads", seconds=[1.0]), "not of the same processes as one thread"),
        (keep("threads", is_of(threads=2)), "not of the same processes as one thread")),
    "scaling": (
        (none("points"), "no points"), (change("points", seconds=[]), "sweeps and no time"),
        (change("points", sweeps=None), "times and no sweeps"), (none("integrators"), "without its integrator"),
        (change("threads", one=[]), "not of the same processes"),
        (change("threads", one=[1.0]), "not of the same processes")),
    "threads": (
        (change("runs", threads=2), "twice"), (change("runs", threads=4), "none by one thread"),
        (change("runs", is_of(threads=2), integrator="rk8_frame"), "rk8_frame without its integrator"),
        (change("runs", is_of(threads=2), seconds=[0.1]), "not of the same processes"),
        (change("runs", is_of(threads=2), same=[True]), "not of the same processes"),
        (change("runs", serial=lambda found: [1.5] * len(found)), "serial"),
        (change("runs", same=lambda found: [1] * len(found)), "same"),
        (change("runs", seconds=lambda found: [0.0] * len(found)), "seconds"),
        (change_all("runs", **{name: lambda row: [] for name in threads_table.BY_PROCESS}), "same processes")),
    "theorem": (
        (none("ends"), "no rows of ends"), (none("coincidence"), "no rows of coincidence"),
        (change("cost", seconds=[]), "with sweeps and no time"), (change("cost", sweeps=None), "times and no sweeps"),
        (change("cost", seconds=lambda found: found[:-1]), "not timed by the same processes")),
    "turbulence": (
        (none("runs"), "no runs"), (none("sizes"), "runs at n = 33"),
        (keep("runs", lambda row: row["integrator"] != "rk8"), "not every reference run"),
        (keep("integrators", lambda row: row["name"] != "rk4"), "does not list the integrator rk4"),
        (keep("integrators", lambda row: row["name"] != "rk8"), "does not list the integrator rk8"),
        (keep("runs", lambda row: (row["role"], row["sample"]) != ("method", 1)), "not every sample of elp4"),
        (keep("runs", lambda row: (row["role"], row["sample"], row["ensemble"]) != ("reference", 0, 0)),
         "not every reference run at n = 33"),
        (keep("runs", lambda row: (row["role"], row["sample"], row["ensemble"]) != ("far", 0, 0)),
         "not every far run at n = 33"),
        (change("runs", is_of(role="far"), status="unstable"), "not every far run at n = 33"),
        (change("runs", bands=None), "a run at n = 33 without its averages"),
        (change("runs", bands=[[1.0] * 4] * 4), "a run at n = 33 without its averages"),
        (change("runs", energy=None), "a run at n = 33 without its averages"),
        (change("costs", seconds=[1e-5]), "numbers of processes"))}


class Contradictions(DamageTest):
    def test_tables_that_do_not_belong_together_are_told(self):
        for study, (write, _, read, _) in STUDIES.items():
            document = json.loads(text_of(write(self.folder)))
            read(self.write("damaged.json", json.dumps(Tables(document).document)))  # the control
            for changed, *words in CONTRADICTIONS[study]:
                with self.subTest(study=study, words=words):
                    self.assert_unusable(read, changed(Tables(document)), *words)

    def test_a_rough_scene_is_that_of_its_file(self):
        smooth = scaling_documents.write_tables(self.path("smooth.json"), points=[scaling_documents.point()])
        rough = scaling_documents.write_tables(self.path("rough.json"), "rough", points=[scaling_documents.point()])
        scaling_table.read_rough(rough)
        with self.assertRaisesRegex(UnusableFile, "smooth scene, not of the rough one"):
            scaling_table.read_rough(smooth)


if __name__ == "__main__":
    unittest.main()
