"""Source that goes with the program gaiter.

libusb is linked into it. By section 6a of its licence, the LGPL 2.1, whoever gets the program gets the
source of libusb, and what it takes to link the program with a changed one: the source of gaiter. The
MPL 2.0 asks where the source is. So all of it is in the package, whose licences then hold wherever it is
passed on, without an address that must stay.
"""

import gzip
import hashlib
import os
import shutil
import tarfile
import tomllib
from pathlib import Path

from linked import Unclear

README = Path(__file__).parent / "source.in"

# Without these Cargo does not read the workspace. The rest is what the published crate has.
WORKSPACE = ["/Cargo.toml", "/benches", "/crates", "/tests/rig", "/tests/support"]


def goes_along(crate):
    return crate.name == "libusb1-sys" or "MPL-2.0" in crate.licence


def files(root):
    """The files of the workspace that it takes to build the program, within the root."""
    include = tomllib.loads((root / "Cargo.toml").read_text())["package"]["include"]
    for pattern in include + WORKSPACE:
        for place in root.glob(pattern.removeprefix("/")):
            for path in [place, *place.rglob("*")]:
                within = path.relative_to(root)
                # They would not run without the fixtures, and fuzzing leaves builds and inputs behind.
                is_left_out = within.parts[0] == "crates" and within.parts[2:3] in [("tests",), ("fuzz",)]
                if path.is_file() and not is_left_out:
                    yield within


def pack(program, folder):
    """The source of gaiter, the same bytes for the same files."""
    name = f"gaiter-{program.package.version}"
    time = int(os.environ.get("SOURCE_DATE_EPOCH", "0"))

    def plain(entry):
        entry.mtime, entry.mode = time, 0o755 if entry.mode & 0o100 else 0o644
        entry.uid = entry.gid = 0
        entry.uname = entry.gname = "root"
        return entry

    with (
        open(folder / f"{name}.tar.gz", "wb") as file,
        gzip.GzipFile("", "wb", mtime=0, fileobj=file) as packed,
        tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive,
    ):
        for path in sorted(set(files(program.root))):
            archive.add(program.root / path, f"{name}/{path}", filter=plain)


def put(program, folder):
    along = list(filter(goes_along, program.crates))
    # gaiter-archive links nothing of that kind.
    if not along:
        return
    folder.mkdir(exist_ok=True)
    pack(program, folder)
    for crate in along:
        # Beside the folder where Cargo unpacked it.
        packed = f"{crate.name}-{crate.version}.crate"
        path = crate.folder.parents[2] / "cache" / crate.folder.parent.name / packed
        if not path.exists() or hashlib.sha256(path.read_bytes()).hexdigest() != crate.sha256:
            raise Unclear(f"{path} is not the crate of Cargo.lock")
        shutil.copy(path, folder)
    text = README.read_text().replace("{{gaiter}}", program.package.version)
    (folder / "README").write_text(text.replace("{{libusb1-sys}}", program.crate("libusb1-sys").version))
