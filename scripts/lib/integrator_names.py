"""What the names of integrators say: which are forms of one Gauss method, and how several are named in few words."""

import re

from benchmark_json import FORMULATIONS

# A row for each s, a column for each formulation.
TABLE1_CELLS = tuple(f"{formulation}{s}" for s in (1, 2, 3) for formulation in FORMULATIONS)


def others(names):
    """Returns the names beside those of Table 1."""
    return [name for name in names if name not in TABLE1_CELLS]


def gauss_stages(name):
    """Returns s of a formulation of the s-stage Gauss method, or None for any other integrator."""
    match = re.fullmatch(rf"(?:{'|'.join(FORMULATIONS)})([0-9]+)", name)
    return int(match[1]) if match else None


def relatives(names):
    """Returns groups of integrators with the same answer: the formulations of one Gauss method; others alone."""
    groups = {}
    for name in names:
        groups.setdefault(gauss_stages(name) or name, []).append(name)
    return list(groups.values())


def joined_relatives(names):
    stages = gauss_stages(names[0])
    if stages is None or len(names) == 1:
        return ", ".join(names)
    return f"{', '.join(name[:-len(str(stages))] for name in names)}, s = {stages}"


def joined(names):
    """Joins names, those that differ in a last digit as one: direct1–3."""
    runs = []
    for name in names:
        stem, number = re.fullmatch(r"(.*?)([0-9]*)", name).groups()
        if runs and runs[-1][0] == stem and number and runs[-1][2] and int(number) == int(runs[-1][2]) + 1:
            runs[-1][2] = number
        else:
            runs.append([stem, number, number])
    return ", ".join(f"{stem}{first}" + (f"–{last}" if last != first else "") for stem, first, last in runs)
