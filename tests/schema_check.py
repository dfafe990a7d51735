"""Holds records to crates/record/schemas/record.schema.json, and damaged ones against it.

    pip install jsonschema
    python3 tests/schema_check.py crates/record/schemas/record.schema.json RECORD.json...

What must hold: every record is valid, with and without a patient and a time, and as one of a lone leg; none is with a value of
another kind anywhere, nor without one of its own parts or one of a leg's. Exit code 1 if it does not.
"""

import copy
import json
import sys
from pathlib import Path

from jsonschema import Draft202012Validator

# Nothing in a record is a list of lists.
DAMAGE = [[]]

# The first rows of a list stand for all.
ROWS = 2

PATIENT = {"id": "4711", "sources": [{"kind": "reader"}]}
ACQUIRED = {"at": "1970-01-01T00:00:00Z", "from": "press"}


def places(value, path=()):
    """The path of every value in a record, itself first."""
    yield path
    if isinstance(value, dict):
        for name, field in value.items():
            yield from places(field, (*path, name))
    elif isinstance(value, list):
        for at, item in enumerate(value[:ROWS]):
            yield from places(item, (*path, at))


def damaged(record, path):
    """The record with something else at a place."""
    if not path:
        return DAMAGE
    changed = copy.deepcopy(record)
    within = changed
    for step in path[:-1]:
        within = within[step]
    within[path[-1]] = DAMAGE
    return changed


def short(record):
    """The record with no more rows than are damaged, because a copy of each is made."""
    if isinstance(record, dict):
        return {name: short(field) for name, field in record.items()}
    return [short(item) for item in record[: ROWS + 1]] if isinstance(record, list) else record


def main(schema, paths):
    validator = Draft202012Validator(json.loads(Path(schema).read_text()))
    wrong, count = [], 0
    for path in paths:
        record = json.loads(Path(path).read_text())
        body = record["body"] | {"stature_mm": None, "crotch_height_mm": None}
        lone = {"body": body, "legs": record["legs"][:1], "differences": None}
        known = {"patient": PATIENT, "acquired": ACQUIRED, "station": "booth-1"}
        for other in ({}, known, lone):
            faults = validator.iter_errors(record | other)
            wrong += [f"{path}: {fault.json_path}: {fault.message:.200}" for fault in faults]
        few = short(record)
        for place in places(few):
            count += 1
            if validator.is_valid(damaged(few, place)):
                wrong.append(f"{path}: valid with {DAMAGE} at {place}")
        for part in record:
            if validator.is_valid({name: field for name, field in record.items() if name != part}):
                wrong.append(f"{path}: valid without {part}")
        for part in record["legs"][0]:
            without = copy.deepcopy(record)
            del without["legs"][0][part]
            if validator.is_valid(without):
                wrong.append(f"{path}: valid without legs/0/{part}")
    print(f"{len(paths)} records, {count} damaged places, {len(wrong)} wrong", *wrong, sep="\n")
    return 1 if wrong or count < 500 else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
