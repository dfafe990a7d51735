"""Removes a person from the bucket of an archive, in all versions:

    python3 person.py archive.toml PSEUDONYM person.txt

person.txt is what person.sql has printed. The key in archive.toml must be that of the bucket's owner,
in a file. Prints what it removes. Needs python3-boto3; may be called again.
"""

import json
import pathlib
import sys
import tomllib

import boto3

config, pseudonym, lines = sys.argv[1:]
place = tomllib.loads(pathlib.Path(config).read_text())["objects"]
store = boto3.client(
    "s3",
    endpoint_url=place["address"],
    region_name=place.get("region", "us-east-1"),
    aws_access_key_id=place["key_id"],
    aws_secret_access_key=pathlib.Path(place["key"]).read_text().strip(),
    verify=place.get("authorities") or None,
)
BUCKET = {"Bucket": place["bucket"]}


def pages(prefix, **more):
    return store.get_paginator("list_object_versions").paginate(**BUCKET, Prefix=prefix, **more)


def folders(prefix):
    """What lies below a prefix: stations or methods."""
    return [found["Prefix"] for page in pages(prefix, Delimiter="/") for found in page.get("CommonPrefixes", [])]


def remove(prefix, is_meant=lambda version: True):
    for page in pages(prefix):
        # What only says that it was removed has no bytes to look at.
        for version in page.get("Versions", []) + page.get("DeleteMarkers", []):
            if is_meant(version):
                store.delete_object(**BUCKET, Key=version["Key"], VersionId=version["VersionId"])
                print(version["Key"])


def remove_said(prefix, record_folder):
    """Removes what names the person, and the records that belong to it."""

    def names_person(version):
        if "Size" not in version:
            return False
        body = store.get_object(**BUCKET, Key=version["Key"], VersionId=version["VersionId"])["Body"].read()
        if pseudonym.encode() not in body:
            return False
        if record := json.loads(body).get("record"):
            remove(f"{record_folder}{record}")
        return True

    remove(prefix, names_person)


for line in pathlib.Path(lines).read_text().split():
    match line.split("|"):
        case [scan]:
            for folder in ["scan/", *folders("result/")]:
                remove(f"{folder}{scan[:2]}/{scan}")
            for folder in folders("record/") + folders("announced/") + folders("inbox/"):
                remove(f"{folder}{scan}")
        case [station, scan, export]:
            for folder in f"announced/{station}/", f"inbox/{station}/":
                remove_said(f"{folder}{scan}", f"record/{station}/{scan}/")
                remove_said(f"{folder}{export}-withdrawn", "")
