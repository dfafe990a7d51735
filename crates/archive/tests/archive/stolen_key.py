"""What the key of a station can do, tried by another client: `stolen_key.py ADDRESS BUCKET`.

The bucket is there; the owner's key is "key", that of two stations their names. It is set up as docs/archive.md says,
with the policies of systemd/archive. The first thing that does not hold ends it.
"""

import json
import pathlib
import sys

import boto3
from botocore import UNSIGNED
from botocore.config import Config
from botocore.exceptions import ClientError

ADDRESS, BUCKET = sys.argv[1:]
POLICIES = pathlib.Path(__file__).resolve().parents[4] / "systemd" / "archive"
STATION, OTHER = "booth-1", "booth-2"
PUBLIC = {"GrantRead": "uri=http://acs.amazonaws.com/groups/global/AllUsers"}


def client(key, service="s3"):
    known = {"aws_access_key_id": key, "aws_secret_access_key": "word"} if key else {}
    config = None if key else Config(signature_version=UNSIGNED)
    return boto3.client(service, endpoint_url=ADDRESS, region_name="us-east-1", config=config, **known)


def policy(name, **words):
    text = (POLICIES / name).read_text()
    for word, value in {"BUCKET": BUCKET, **words}.items():
        text = text.replace(word, value)
    return json.dumps(json.loads(text))


def status(call, **arguments):
    try:
        return call(**arguments)["ResponseMetadata"]["HTTPStatusCode"]
    except ClientError as error:
        return error.response["ResponseMetadata"]["HTTPStatusCode"]


def holds(expected, what, call, **arguments):
    got = status(call, **arguments)
    assert got in expected, f"{what}: {got}, not {expected}"
    print(f"{got} {what}")


owner, stolen, nobody = client("key"), client(STATION), client(None)

# As docs/archive.md says.
owner.put_bucket_versioning(Bucket=BUCKET, VersioningConfiguration={"Status": "Enabled"})
owner.put_public_access_block(
    Bucket=BUCKET,
    PublicAccessBlockConfiguration={
        "BlockPublicAcls": False,
        "IgnorePublicAcls": True,
        "BlockPublicPolicy": False,
        "RestrictPublicBuckets": False,
    },
)
owner.put_bucket_policy(Bucket=BUCKET, Policy=policy("bucket-policy.json", ARCHIVE="archive"))
for station in STATION, OTHER:
    document = policy("station-policy.json", STATION=station)
    client("key", "iam").put_user_policy(UserName=station, PolicyName="archive", PolicyDocument=document)

for key in "scan/aa/old", f"fleet/{OTHER}.json", f"inbox/{OTHER}/old", f"record/{OTHER}/old", "result/m/aa/old":
    owner.put_object(Bucket=BUCKET, Key=key, Body=b"old")
OWN = "scan/aa/new", f"record/{STATION}/x/r1", f"inbox/{STATION}/x", f"fleet/{STATION}.json"

# It adds, and it beats.
for key in *OWN, f"fleet/{STATION}.json":
    holds([200], f"put {key}", stolen.put_object, Bucket=BUCKET, Key=key, Body=b"new")
# Nowhere else.
for key in (
    f"fleet/{OTHER}.json",
    f"inbox/{OTHER}/old",
    f"inbox/{OTHER}/new",
    f"record/{OTHER}/old",
    "result/m/aa/old",
    "result/m/aa/new",
    f"announced/{STATION}/x",
    "new",
):
    holds([403], f"put {key}", stolen.put_object, Bucket=BUCKET, Key=key, Body=b"bad")
# It neither reads, not even what it has written, nor removes, nor lists, nor lets others do so.
for key in *OWN, "scan/aa/old", "scan/aa/none", f"inbox/{OTHER}/old", "result/m/aa/old":
    for call in stolen.get_object, stolen.head_object, stolen.delete_object, stolen.get_object_acl:
        holds([403], f"{call.__name__} {key}", call, Bucket=BUCKET, Key=key)
    holds([403], f"make public {key}", stolen.put_object_acl, Bucket=BUCKET, Key=key, ACL="public-read")
    source = {"Bucket": BUCKET, "Key": key}
    holds([403], f"copy {key}", stolen.copy_object, Bucket=BUCKET, Key="scan/aa/copy", CopySource=source)
for call in (
    stolen.list_objects,
    stolen.list_objects_v2,
    stolen.list_object_versions,
    stolen.list_multipart_uploads,
    stolen.get_bucket_acl,
    stolen.get_bucket_policy,
    stolen.delete_bucket,
    stolen.delete_bucket_policy,
):
    holds([403], call.__name__, call, Bucket=BUCKET)
suspended = {"Status": "Suspended"}
holds([403], "end versions", stolen.put_bucket_versioning, Bucket=BUCKET, VersioningConfiguration=suspended)
rule = {"ID": "all", "Prefix": "", "Status": "Enabled", "Expiration": {"Days": 1}}
rules = {"Rules": [rule]}
holds([403], "expire", stolen.put_bucket_lifecycle_configuration, Bucket=BUCKET, LifecycleConfiguration=rules)
holds([403], "own policy", client(STATION, "iam").delete_user_policy, UserName=STATION, PolicyName="archive")
# What it gives to all with the object is read neither by nobody nor by another station.
for key, given in ("scan/aa/public", {"ACL": "public-read"}), ("scan/aa/granted", PUBLIC):
    holds([200], f"put {key}", stolen.put_object, Bucket=BUCKET, Key=key, Body=b"new", **given)
    for who in nobody, client(OTHER):
        holds([403], f"read {key}", who.get_object, Bucket=BUCKET, Key=key)
# Where it overwrites a scan, the version before stays, and the archive reads both.
holds([200], "overwrite", stolen.put_object, Bucket=BUCKET, Key="scan/aa/old", Body=b"bad")
versions = owner.list_object_versions(Bucket=BUCKET, Prefix="scan/aa/old")["Versions"]
for version in versions:
    place = {"Bucket": BUCKET, "Key": "scan/aa/old", "VersionId": version["VersionId"]}
    holds([403], "remove a version", stolen.delete_object, **place)
    holds([403], "read a version", stolen.get_object, **place)
    version["bytes"] = owner.get_object(**place)["Body"].read()
assert sorted(version["bytes"] for version in versions) == [b"bad", b"old"], versions
# For the tests that come: as it was.
for version in owner.list_object_versions(Bucket=BUCKET)["Versions"]:
    owner.delete_object(Bucket=BUCKET, Key=version["Key"], VersionId=version["VersionId"])
