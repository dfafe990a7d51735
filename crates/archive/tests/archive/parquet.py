"""Prints each row of an export as a line of JSON: the columns of the view visit_level, then the month of its folder."""

import json
import sys

import pyarrow.dataset

COLUMNS = [
    "station", "scan", "first_seen", "patient", "method", "outcome", "stature_mm", "crotch_height_mm",
    "side", "level", "height_mm", "girth_mm", "girth_sd_mm", "month",
]

table = pyarrow.dataset.dataset(sys.argv[1], partitioning="hive").to_table()
assert sorted(table.column_names) == sorted(COLUMNS), table.column_names
for row in table.to_pylist():
    row["first_seen"] = int(row["first_seen"].timestamp())
    print(json.dumps([row[column] for column in COLUMNS]))
