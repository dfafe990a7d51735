#!/usr/bin/env python3
"""The figures of a structured report as highdicom reads them, with its patient's id, as JSON.

    sr_figures.py FILE

A figure is named by side, letter and level, such as "right cB" for the circumference at B.
"""

import json
import sys

from highdicom.sr import CodedConcept, srread
from pydicom.sr.codedict import codes

LETTERS = {"74551000": "c", "121207": "l"}
SIDES = {"24028007": "right", "7771000": "left"}
LEVEL = CodedConcept("106233006", "SCT", "Topographical modifier")


def figures(report):
    for group in report.content.get_image_measurement_groups():
        (site,) = group.finding_sites
        side = SIDES[site.laterality.value]
        for measurement in group.get_measurements():
            assert measurement.unit == codes.UCUM.Centimeter, measurement.unit
            (number, *_) = measurement
            (level,) = [item.value for item in number.ContentSequence if item.name == LEVEL]
            value = number.MeasuredValueSequence[0].NumericValue
            yield f"{side} {LETTERS[measurement.name.value]}{level.value}", str(value)


def main():
    report = srread(sys.argv[1])
    all_of_it = {"patient": report.PatientID, "figures": dict(figures(report))}
    print(json.dumps(all_of_it))


main()
