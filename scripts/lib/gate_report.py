"""What the regression gate says: as a document for readers, and as JSON for programs."""

from benchmark_json import one_line
from document import Column, Entry, Heading, Items, Paragraph, Table
from gate_layers import exit_code

FORMAT = "isosyrk check_regression 1"
SUMMARY = {0: "No regression.", 1: "Regression.", 3: "No regression found, but not every layer was judged."}


def as_document(layers, head, base):
    """Returns the report; `head` and `base` name what was compared."""
    summary = f"{SUMMARY[exit_code(layers)]} Head: {head}. Base of the times: {base}."
    parts = [Heading("Regression gate", 1), Paragraph(summary)]
    for layer in layers:
        parts += layer_parts(layer)
    return parts


def layer_parts(layer):
    parts = [Heading(f"{layer.name}: {layer.verdict()}")]
    if layer.not_judged:
        parts.append(Paragraph(f"{layer.name} not judged: {layer.not_judged}"))
    if layer.checks:
        parts.append(Paragraph(f"{len(layer.checks) - len(layer.failures())} of {len(layer.checks)} checks passed."))
    shown = layer.checks if layer.name == "timing" else layer.failures()
    if shown:
        columns = tuple(Column(name, align="left") for name in ("cell", "quantity", "found", "allowed"))
        rows = [[Entry(text, not check.passed) for text in (check.cell, check.quantity, check.found, check.allowed)]
                for check in shown]
        parts.append(Table(columns, [rows]))
    if layer.notes:
        parts.append(Items([("", one_line(note)) for note in layer.notes]))
    return parts


def as_json(layers, head, base, conditions):
    """Returns every check, as data."""
    return {"format": FORMAT, "exit_code": exit_code(layers), "head": head, "base": base, "conditions": conditions,
            "layers": [{"name": layer.name, "verdict": layer.verdict(), "not_judged": layer.not_judged,
                        "notes": layer.notes,
                        "checks": [{"cell": check.cell, "quantity": check.quantity, "found": check.found,
                                    "allowed": check.allowed, "passed": check.passed} for check in layer.checks]}
                       for layer in layers]}
