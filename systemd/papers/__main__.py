"""The papers of a package, into a folder: python3 -B systemd/papers PACKAGE FOLDER

PACKAGE is gaiter or gaiter-archive.

    copyright         every licence in the program, as Debian's copyright format 1.0 has it
    THIRD-PARTY.txt   the licence texts and copyright lines themselves
    PACKAGE.cdx.json  the parts of the program, as CycloneDX 1.5
    changelog         CHANGELOG.md, in Debian's form
    source/           what a licence wants to come with the program gaiter: the source of libusb, serialport and gaiter

They are made from what Cargo links, each time: no list of crates is kept anywhere. What needs a person
is an error: a licence that nobody has read, a C library or a foreign part that copyright.in does not name.
Needs the sources of the crates, which are there after a build, and no network.
"""

import sys
from pathlib import Path

import changelog
import debian
import linked
import notices
import sbom
import source

if len(sys.argv) != 3:
    sys.exit(__doc__)
root = Path(__file__).resolve().parents[2]
folder = Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)
try:
    program = linked.program(root, sys.argv[1])
    papers = {
        "copyright": debian.copyright_file(program),
        "THIRD-PARTY.txt": notices.text(program),
        f"{program.package.name}.cdx.json": sbom.text(program),
        "changelog": changelog.debian(program),
    }
    source.put(program, folder / "source")
except linked.Unclear as why:
    sys.exit(f"systemd/papers: {why}")
for name, text in papers.items():
    (folder / name).write_text(text, encoding="utf-8")
