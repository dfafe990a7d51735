"""Source that goes with the program.

libusb is linked into it. By section 6a of its licence, the LGPL 2.1, whoever gets the program gets the
source of libusb, and what it takes to link the program with a changed one: the source of gaiter, which
systemd/package adds. The MPL 2.0 asks where the source is. So all of it is in the package, whose licences
then hold wherever it is passed on, without an address that must stay.
"""

import hashlib
import shutil
from pathlib import Path

from linked import Unclear

README = Path(__file__).parent / "source.in"


def goes_along(crate):
    return crate.name == "libusb1-sys" or "MPL-2.0" in crate.licence


def put(program, folder):
    folder.mkdir(exist_ok=True)
    for crate in filter(goes_along, program.crates):
        # Beside the folder where Cargo unpacked it.
        packed = f"{crate.name}-{crate.version}.crate"
        path = crate.folder.parents[2] / "cache" / crate.folder.parent.name / packed
        if not path.exists() or hashlib.sha256(path.read_bytes()).hexdigest() != crate.sha256:
            raise Unclear(f"{path} is not the crate of Cargo.lock")
        shutil.copy(path, folder)
    text = README.read_text().replace("{{gaiter}}", program.gaiter.version)
    (folder / "README").write_text(text.replace("{{libusb1-sys}}", program.crate("libusb1-sys").version))
