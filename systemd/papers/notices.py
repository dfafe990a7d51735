"""The licence texts of what is in the program, each once, with whose they are."""

import re
from html.parser import HTMLParser
from pathlib import Path

import debian
import linked

HEAD = Path(__file__).parent / "THIRD-PARTY.in"
# Files that say more than a licence: kept as they are.
AS_IT_IS = re.compile(r"(notice|copyright|license-third-party)", re.I)
# Some have the text without its title.
TITLE = re.compile(r"^\W*(the )?mit license( \(mit\))?", re.I)
RULE = "=" * 80


class Rust(HTMLParser):
    """Reads Rust's notices: for each crate of its library the texts."""

    def __init__(self):
        super().__init__()
        self.found, self.within, self.crate = [], None, None

    def handle_starttag(self, tag, _):
        if tag in ("h3", "summary", "pre"):
            self.within, self.said = tag, ""

    def handle_data(self, data):
        if self.within:
            self.said += data

    def handle_endtag(self, tag):
        if tag != self.within:
            return
        if tag == "h3":
            self.crate = re.sub(r"[^\w.+-]|-(?=\d+\.\d)", " ", self.said).strip()
        elif tag == "summary":
            self.file = self.said.strip()
        elif self.crate:
            self.found.append((f"{self.crate} (within Rust's library)", self.file, self.said))
        self.within = None


def sources(program):
    """Everything with a licence text: whose, the file's name, the text."""
    for crate in program.crates:
        for path in [*crate.licence_files(), *crate.foreign_files()]:
            yield crate.id, path.name, linked.read(path)
    reader = Rust()
    reader.feed(program.rust_notices)
    yield from reader.found


def parted(name, text):
    """The lines that say whose it is, and the text without them."""
    text = text.replace("\r", "").expandtabs(4)
    if AS_IT_IS.match(name) or "Free Software Foundation" in text:
        return [], text
    # Nobody is named in what the Apache License has after its end but an example, or who is named above.
    whose = [line.strip() for line in debian.claims(text)]
    if "END OF TERMS AND CONDITIONS" in text:
        text = text.split("END OF TERMS AND CONDITIONS")[0]
    lines = [line.rstrip() for line in text.splitlines() if line.strip() not in whose]
    while lines and not re.search(r"\w", lines[0]):
        del lines[0]
    return whose, "\n".join(lines).strip("\n")


def text(program):
    # By the words of the text, so that its line breaks part nobody.
    texts, owners = {}, {}
    for id, name, said in sources(program):
        # Of a choice between another licence and the GPL, gaiter takes the other.
        if not debian.is_taken(Path(name)) or "GNU GENERAL PUBLIC LICENSE\n" in said:
            continue
        whose, body = parted(name, said)
        words = re.sub(r"\W+", " ", TITLE.sub("", body)).strip().lower()
        texts.setdefault(words, body)
        line = f"  {id}: {'; '.join(whose)}" if whose else f"  {id}"
        if line not in owners.setdefault(words, []):
            owners[words].append(line)
    serialport = program.crate("serialport")
    head = {
        "program": program.package.name,
        "libusb": program.libusb_version,
        "serialport": serialport and serialport.version,
        "SQLite": program.sqlite_version,
        "libzstd": program.libzstd_version,
    }
    parts = [debian.filled(HEAD.read_text(encoding="utf-8"), head)]
    for crate in program.crates:
        parts[0] += f"{crate.id}: {crate.licence}\n  https://crates.io/crates/{crate.name}/{crate.version}\n"
    by_use = sorted(texts, key=lambda words: (-len(owners[words]), owners[words]))
    parts += ["\n".join(owners[words]) + "\n\n" + texts[words] + "\n" for words in by_use]
    return f"\n{RULE}\n\n".join(parts)
