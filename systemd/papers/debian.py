"""Debian's copyright file, from copyright.in and the crates."""

import re
import tomllib
from pathlib import Path

import linked
from linked import Unclear

TEMPLATE = Path(__file__).parent / "copyright.in"

# A line that says whose work it is, and no sentence of a licence.
# matrixmultiply has one with a slip of the pen.
CLAIM = re.compile(r"^[\s*#/;>-]*(?:Portions )?Copy(?:right|irhgt)\s*(?:\([cC]\)|©|\[?\d|[A-Z])|^[\s*]*©")
# A further year and name below such a line.
MORE = re.compile(r"^\s+\d{4}[\d, -]* \w")
NO_CLAIM = re.compile(r"yyyy|\{year\}|holder|owner|notice|license|permission", re.I)


def claims(text):
    """The lines of a text that say whose work it is."""
    found, goes_on = [], False
    for line in text.splitlines():
        is_claim = CLAIM.match(line) or goes_on and MORE.match(line)
        goes_on = bool(is_claim and not NO_CLAIM.search(line))
        if goes_on:
            found.append(line)
    return found


def whose(line):
    """What such a line says without the word Copyright."""
    line = re.sub(r"^[\s*#/;>-]*(?:Copy\w+\s*)?(?:\([cC]\)|©)?\s*", "", line)
    line = re.sub(r"\s*All rights reserved\.?", "", line, flags=re.I)
    return re.sub(r"[\[\]]", "", line).strip(" *\t")


def holders(crate):
    files = filter(is_taken, crate.licence_files())
    found = {whose(line) for path in files for line in claims(linked.read(path))}
    # Some have a year and no name.
    named = {holder for holder in found if re.search(r"[^\W\d]{2}", holder)}
    return sorted(named) or crate.authors or [f"the authors of {crate.name}"]


def is_taken(path):
    """Whether a licence file is of a licence that gaiter takes, where it has the choice."""
    return not re.search(r"GPL|UNLICENSE|0BSD|BOOST|LLVM", path.name.upper())


def taken(licence, known):
    """The licences that gaiter takes of those a crate offers, as Debian writes them."""
    parts = licence.split(" AND ")
    if len(parts) > 1 and any(" OR " in part and part[0] != "(" for part in parts):
        raise Unclear(f"cannot tell what {licence!r} means")
    chosen = []
    for part in parts:
        offered = [one for one in part.strip("()").split(" OR ") if one in known]
        if not offered:
            raise Unclear(f"no part of copyright.in has the licence {part!r}")
        chosen.append(" or ".join(sorted(offered, reverse=True)))
    return ", and ".join(chosen)


def paragraph(files, holders, licence):
    return f"Files: {files}\nCopyright: {joined(holders)}\nLicense: {licence}\n"


def joined(lines):
    return "\n ".join(lines)


def indented(text):
    """A text as a field of Debian's has it."""
    return joined(line.rstrip().replace("\t", "    ") or "." for line in text.strip().splitlines())


def filled(template, parts):
    """A template with the parts of the program, without the paragraphs about those that it lacks."""
    place = re.compile(r"\{\{(.+?)\}\}")
    paragraphs = re.split(r"\n\n", template)
    there = [one for one in paragraphs if all(parts[name] is not None for name in place.findall(one))]
    return place.sub(lambda found: parts[found[1]], "\n\n".join(there))


def is_needed(paragraph, program, licences):
    """Whether a paragraph of Debian's is about a crate of the program, or a licence of one."""
    if crate := re.match(r"Files: vendor/(.+?)-\*/", paragraph):
        return program.crate(crate[1]) is not None
    if licence := re.match(r"License: (\S+)\n ", paragraph):
        return licence[1] in licences
    return True


def demo(program):
    """The scans that the station has within."""
    manifest = tomllib.loads((program.package.folder / "Cargo.toml").read_text())
    scans = [path.removeprefix("/") for path in manifest["package"]["include"] if path.startswith("/fixtures/")]
    return " ".join(scans) or None


def libusb_holders(program):
    """Of the files of libusb that are compiled on Linux."""
    if not program.libusb:
        return []
    source = program.libusb / "libusb"
    compiled = re.compile(r"libusb/[^/]*$|os/linux_|os/.*_posix")
    files = [path for path in source.rglob("*.[ch]") if compiled.search(str(path))]
    return sorted({whose(line) for path in files for line in claims(linked.read(path))})


def copyright_file(program):
    template = TEMPLATE.read_text(encoding="utf-8")
    known = set(re.findall(r"^License: (\S+)\n ", template, re.M))
    crates = []
    for crate in program.crates:
        files = f"vendor/{crate.name}-{crate.version}/*"
        crates.append(paragraph(files, holders(crate), taken(crate.licence, known)))
        for path in crate.foreign_files():
            place = f"vendor/{crate.name}-*/{path.parent.relative_to(crate.folder)}/*"
            if f"Files: {place}\n" not in template:
                raise Unclear(f"{crate.id} has {path.name} in a folder: copyright.in does not name {place}")
    fonts = program.root / "crates/record/src/picture/fonts"
    parts = {
        "crates": "\n".join(crates).rstrip(),
        "libusb": program.libusb_version,
        "libusb holders": joined(libusb_holders(program)),
        "SQLite": program.sqlite_version,
        "libzstd": program.libzstd_version,
        "Rust": program.rust,
        "demo": demo(program),
        "OFL": indented((fonts / "OFL.txt").read_text().split("\n\n", 1)[1]),
        "font holders": joined(whose(line) for line in claims((fonts / "OFL.txt").read_text())),
    }
    paragraphs = filled(template, parts).split("\n\n")
    files = [one for one in paragraphs if one.startswith("Files: ") and is_needed(one, program, ())]
    licences = set(re.findall(r"[\w.+-]+", " ".join(re.findall(r"^License: (.+)$", "\n".join(files), re.M))))
    return "\n\n".join(one for one in paragraphs if is_needed(one, program, licences))
