"""What a study found, as typed records: the file findings.json, which its renderer writes beside its report.

    {"format": "isosyrk findings 1", "study": "theorem",
     "tables": {name: {"columns": [...], "rows": [[...], ...]}}}

The judge of a study declares its tables once, as a NamedTuple `Findings` of lists of records whose annotations are
kinds (formats.py). Programs that build on a study read these records.
"""

import json
from typing import get_args

from lib.programs.messages import UnusableFile
from lib.records.formats import an_object, checked, columns_and_rows, compact, read_json, records, require, to_digits

FILE = "findings.json"
FORMAT = "isosyrk findings 1"
DIGITS = 6  # that are written: the last ones of a double depend on the machine


def record_classes(kind):
    """Returns the class of the records in each table of a class Findings, by the name of the table."""
    return {name: get_args(each)[0] for name, each in kind.__annotations__.items()}


def as_json(study, found):
    """Returns findings.json as bytes, a record a line, having read it back. `found` is a Findings.

    Throws UnusableFile for a record that is not of its kinds, and ValueError for a number that is not finite.
    """
    blocks = ",\n".join(f"{compact(name)}:{{{columns_and_rows(record, map(written, getattr(found, name)))}}}"
                        for name, record in record_classes(type(found)).items())
    whole_file = f'{{"format":{compact(FORMAT)},"study":{compact(study)},"tables":{{\n{blocks}\n}}}}\n'
    findings_of(json.loads(whole_file), study, type(found))
    return whole_file.encode("utf-8")


def written(value):
    """Returns a value of a record, or all of them, with the digits that are written."""
    if isinstance(value, (tuple, list)):
        return [written(each) for each in value]
    if not isinstance(value, float):
        return value
    shown = to_digits(value, DIGITS)
    return int(shown) if shown.is_integer() else shown  # 5, not 5.0


def read_findings(path, study, kind):
    """Returns the Findings of class `kind` in a file. Throws UnusableFile with one line that names the file."""
    return read_json(path, lambda document: findings_of(document, study, kind))


def findings_of(document, study, kind):
    what = f"file of findings of the study {study}"
    require(document, what, "format", FORMAT)
    require(document, what, "study", study)
    tables = checked(document, {"tables": an_object}, "it")["tables"]
    classes = record_classes(kind)
    if unknown := tables.keys() - classes.keys():
        raise UnusableFile(f"has a table of {min(unknown)}, which findings of the study {study} have not")
    found = checked(tables, dict.fromkeys(classes, an_object), "tables")
    return kind(**{name: records(found[name], record, name) for name, record in classes.items()})
