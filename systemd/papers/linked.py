"""What the program is made of: its crates, the C libraries within them, and Rust's own library."""

import json
import re
import subprocess
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

# Crates that compile C, and what of it copyright.in names.
COMPILES_C = {
    "libsqlite3-sys": "SQLite",
    "libusb1-sys": "libusb",
    "ring": "parts of BoringSSL",
    "zstd-sys": "libzstd",
}

# Where the texts of licences stand, in files of crates.
LICENCE_FILE = re.compile(r"(licen[sc]e|copying|notice|copyright|unlicense|ofl)", re.I)
# Folders of a crate that nobody links.
NOT_LINKED = {"tests", "benches", "examples", "fuzz"}


class Unclear(Exception):
    """Something that a person has to look at."""


@dataclass
class Crate:
    name: str
    version: str
    # As its Cargo.toml has it, with the words of SPDX.
    licence: str
    authors: list[str]
    repository: str | None
    folder: Path
    sha256: str | None
    # Names and versions of the crates that it uses.
    uses: set[str] = field(default_factory=set)

    @property
    def id(self):
        return f"{self.name} {self.version}"

    def licence_files(self):
        """The files at its root that tell its licence."""
        return sorted(path for path in self.folder.iterdir() if is_licence(path))

    def foreign_files(self):
        """Licence files of parts that it took from elsewhere."""
        for path in sorted(self.folder.rglob("*")):
            within = path.relative_to(self.folder).parts
            if len(within) > 1 and is_licence(path) and not NOT_LINKED & set(within):
                yield path


def is_licence(path):
    is_text = path.suffix.lower() in ("", ".md", ".txt") or path.name.upper().startswith("LICENSE")
    return bool(LICENCE_FILE.match(path.name)) and is_text and path.suffix != ".rs" and path.is_file()


@dataclass
class Program:
    root: Path
    # With the other crates of the workspace.
    package: Crate
    # Those of others.
    crates: list[Crate]
    rust: str
    target: str
    # Rust's copyright notices for its library, as HTML.
    rust_notices: str

    def crate(self, name):
        """The crate of this name, if it is linked."""
        return next((crate for crate in self.crates if crate.name == name), None)

    @property
    def libusb(self):
        crate = self.crate("libusb1-sys")
        return crate and crate.folder / "libusb"

    @property
    def libusb_version(self):
        if not self.libusb:
            return None
        text = (self.libusb / "libusb/version.h").read_text()
        numbers = [re.search(rf"LIBUSB_{part} (\d+)", text)[1] for part in ("MAJOR", "MINOR", "MICRO")]
        return ".".join(numbers)

    @property
    def libzstd_version(self):
        crate = self.crate("zstd-sys")
        return crate and crate.version.split("+zstd.")[1]

    @property
    def sqlite_version(self):
        crate = self.crate("libsqlite3-sys")
        if not crate:
            return None
        header = crate.folder / "sqlite3/sqlite3.h"
        return re.search(r'#define SQLITE_VERSION\s+"([\d.]+)"', header.read_text())[1]

    @property
    def fonts(self):
        return sorted((self.root / "crates/record/src/picture/fonts").glob("*.ttf"))


def read(path):
    return path.read_text(encoding="utf-8", errors="replace")


def run(root, *command):
    return subprocess.run(command, cwd=root, check=True, text=True, stdout=subprocess.PIPE).stdout


def program(root, name):
    rustc = run(root, "rustc", "-vV")
    target = re.search(r"^host: (.+)$", rustc, re.M)[1]
    of = ["--locked", "--offline"]
    told = run(root, "cargo", "metadata", *of, "--format-version", "1", "--filter-platform", target)
    packages = {f"{p['name']} {p['version']}": p for p in json.loads(told)["packages"]}
    lock = tomllib.loads((root / "Cargo.lock").read_text())["package"]
    sums = {f"{p['name']} {p['version']}": p.get("checksum") for p in lock}
    # Also the macros, which write a part of what is compiled, and what those use; no tests.
    of += ["--package", name, "--target", target]
    tree = run(root, "cargo", "tree", *of, "--edges", "normal", "--prefix", "depth")
    uses, above = {}, []
    for line in tree.splitlines():
        depth, *crate = re.match(r"(\d+)(\S+) v(\S+)", line).groups()
        crate = " ".join(crate)
        del above[int(depth):]
        if above:
            uses[above[-1]].add(crate)
        uses.setdefault(crate, set())
        above.append(crate)
    # The crates of the workspace are the program's own: what they use, it uses.
    package = next(id for id in uses if id.split()[0] == name)
    own = {id for id in uses if not packages[id]["source"]}
    uses[package] = set().union(*(uses[id] for id in own)) - own
    crates = [made(packages[id], sums[id], used) for id, used in sorted(uses.items()) if id not in own]
    for crate in crates:
        compiles = {d["name"] for d in packages[crate.id]["dependencies"] if d["kind"] == "build"}
        if compiles & {"cc", "cmake", "autotools"} and crate.name not in COMPILES_C:
            raise Unclear(f"{crate.id} may compile C: name what it brings in copyright.in and COMPILES_C")
    sysroot = Path(run(root, "rustc", "--print", "sysroot").strip())
    notices = sysroot / "share/doc/rust/COPYRIGHT-library.html"
    if not notices.exists():
        raise Unclear(f"{notices} is missing: rustup's toolchains have it")
    return Program(
        root=root,
        package=made(packages[package], None, uses[package]),
        crates=crates,
        rust=re.search(r"^release: (\S+)$", rustc, re.M)[1],
        target=target,
        rust_notices=notices.read_text(encoding="utf-8"),
    )


def made(package, sha256, uses):
    id = f"{package['name']} {package['version']}"
    if not package["license"]:
        raise Unclear(f"{id} names no licence")
    return Crate(
        name=package["name"],
        version=package["version"],
        licence=re.sub(r"\s*/\s*", " OR ", package["license"]),
        authors=package["authors"],
        repository=package["repository"],
        folder=Path(package["manifest_path"]).parent,
        sha256=sha256,
        uses=uses,
    )
