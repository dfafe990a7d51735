"""The parts of the program as a bill of materials: CycloneDX 1.5, JSON."""

import hashlib
import json
import os
import uuid
from datetime import datetime, timezone


def text(program):
    rust = other("std", program.rust, "pkg:github/rust-lang/rust@", {"expression": "MIT OR Apache-2.0"})
    fonts = [font(path) for path in program.fonts]
    package = component(program.package) | {"type": "application"}
    # With the crates that have them within.
    within = []
    if crate := program.crate("libusb1-sys"):
        lgpl = licence("LGPL-2.1-or-later")
        within.append((crate, other("libusb", program.libusb_version, "pkg:github/libusb/libusb@v", lgpl)))
    if crate := program.crate("libsqlite3-sys"):
        blessing = licence("blessing")
        within.append((crate, other("sqlite", program.sqlite_version, "pkg:generic/sqlite@", blessing)))
    if crate := program.crate("zstd-sys"):
        bsd = licence("BSD-3-Clause")
        within.append((crate, other("libzstd", program.libzstd_version, "pkg:github/facebook/zstd@v", bsd)))
    others = [rust, *(one for _, one in within), *fonts]
    uses = {purl(crate.id): {purl(id) for id in crate.uses} for crate in [program.package, *program.crates]}
    uses |= {one["bom-ref"]: set() for one in others}
    uses[package["bom-ref"]] |= {one["bom-ref"] for one in [rust, *fonts]}
    for crate, one in within:
        uses[purl(crate.id)].add(one["bom-ref"])
    metadata = {"component": package}
    if "SOURCE_DATE_EPOCH" in os.environ:
        made = datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), timezone.utc)
        metadata["timestamp"] = made.strftime("%Y-%m-%dT%H:%M:%SZ")
    bom = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": metadata,
        "components": [component(crate) for crate in program.crates] + others,
        "dependencies": [{"ref": ref, "dependsOn": sorted(uses[ref])} for ref in sorted(uses)],
    }
    # The same parts have the same number.
    bom["serialNumber"] = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(bom, sort_keys=True)).urn
    return json.dumps(bom, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def purl(id):
    name, version = id.split()
    return f"pkg:cargo/{name}@{version.replace('+', '%2B')}"


def component(crate):
    made = part("library", crate.name, crate.version, purl(crate.id), {"expression": crate.licence})
    if crate.sha256:
        made["hashes"] = [{"alg": "SHA-256", "content": crate.sha256}]
    if crate.repository:
        made["externalReferences"] = [{"type": "vcs", "url": crate.repository}]
    return made


def other(name, version, place, licence):
    return part("library", name, version, place + version, licence)


def font(path):
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    made = part("file", path.name, sha256[:8], f"pkg:generic/{path.name}@{sha256[:8]}", licence("OFL-1.1"))
    return made | {"hashes": [{"alg": "SHA-256", "content": sha256}]}


def licence(spdx):
    return {"license": {"id": spdx}}


def part(kind, name, version, place, licence):
    return {
        "type": kind,
        "name": name,
        "version": version,
        "purl": place,
        "bom-ref": place,
        "licenses": [licence],
    }
