"""CHANGELOG.md as Debian's changelog."""

import calendar
import os
import re
import textwrap
import tomllib
from email.utils import formatdate

from linked import Unclear

# "## Unreleased: 0.1.0", "## 0.1.0 - 2026-12-01"
HEADING = re.compile(r"## (?:Unreleased: )?(?P<version>\d[\w.]*)(?: - (?P<day>\d{4}-\d\d-\d\d))?$")


def maintainer(root):
    manifest = tomllib.loads((root / "Cargo.toml").read_text())
    return manifest["package"]["metadata"]["deb"]["maintainer"]


def when(day):
    """Noon of the day, or where it has none yet the time of the last commit."""
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", "0"))
    if day:
        seconds = calendar.timegm((*map(int, day.split("-")), 12, 0, 0))
    return formatdate(seconds).replace("-0000", "+0000")


def debian(program):
    text = (program.root / "CHANGELOG.md").read_text()
    entries = []
    for section in re.split(r"^(?=## )", text, flags=re.M)[1:]:
        heading = HEADING.match(section.splitlines()[0])
        if not heading:
            raise Unclear(f"CHANGELOG.md: {section.splitlines()[0]!r} has no version")
        changes = re.findall(r"^- (.+?)(?=\n- |\n\n|\n*\Z)", section, re.M | re.S)
        suite = "unstable" if heading["day"] else "UNRELEASED"
        lines = [f"{program.package.name} ({heading['version']}) {suite}; urgency=medium", ""]
        for change in changes:
            words = re.sub(r"[`*]|\]\([^)]*\)|\[", "", " ".join(change.split()))
            lines += textwrap.wrap(words, 78, initial_indent="  * ", subsequent_indent="    ")
        lines += ["", f" -- {maintainer(program.root)}  {when(heading['day'])}", ""]
        entries.append("\n".join(lines))
    if f"({program.package.version})" not in entries[0]:
        raise Unclear(f"CHANGELOG.md does not begin with {program.package.version}")
    return "\n".join(entries)
