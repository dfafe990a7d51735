"""The papers of the package, into a folder: python3 -B systemd/papers FOLDER

    copyright         every licence in the program, as Debian's copyright format 1.0 has it
    THIRD-PARTY.txt   the licence texts and copyright lines themselves
    gaiter.cdx.json   the parts of the program, as CycloneDX 1.5
    changelog         CHANGELOG.md, in Debian's form
    source/           what a licence wants to come with the program: the source of libusb, serialport and gaiter

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

if len(sys.argv) != 2:
    sys.exit(__doc__)
root = Path(__file__).resolve().parents[2]
folder = Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
try:
    program = linked.program(root)
    papers = {
        "copyright": debian.copyright_file(program),
        "THIRD-PARTY.txt": notices.text(program),
        "gaiter.cdx.json": sbom.text(program),
        "changelog": changelog.debian(program),
    }
    source.put(program, folder / "source")
except linked.Unclear as why:
    sys.exit(f"systemd/papers: {why}")
for name, text in papers.items():
    (folder / name).write_text(text, encoding="utf-8")
