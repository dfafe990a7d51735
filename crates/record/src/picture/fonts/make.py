"""Makes the fonts beside this file from Debian's fonts-noto-core, with fontTools:

    python3 make.py /usr/share/fonts/truetype/noto .

What a report and its figures need stays: Latin, Greek, Cyrillic, punctuation, superscripts. Arrows
and signs that Noto Sans lacks come from Noto Sans Math and Noto Sans Symbols 2. Every glyph is
drawn by itself, without parts, hints or layout tables.
"""

import sys
from pathlib import Path

from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont

RANGES = [
    (0x20, 0x7E), (0xA0, 0x17F), (0x218, 0x21B), (0x2C6, 0x2DD), (0x370, 0x3FF), (0x400, 0x45F),
    (0x490, 0x491), (0x1E9E, 0x1E9E), (0x2007, 0x2007), (0x2009, 0x2009), (0x2010, 0x2015),
    (0x2018, 0x201E), (0x2020, 0x2022), (0x2026, 0x2026), (0x202F, 0x2030), (0x2032, 0x2033),
    (0x2039, 0x203A), (0x2044, 0x2044), (0x2070, 0x2094), (0x20AC, 0x20AC), (0x2116, 0x2116),
    (0x2122, 0x2122),
]
BORROWED = {
    "NotoSansMath-Regular.ttf": "←↑→↓↔≈−≠≤≥∞√∅",
    "NotoSansSymbols2-Regular.ttf": "●○■□▲▼✓",
}
TABLES = ["head", "hhea", "maxp", "OS/2", "hmtx", "cmap", "loca", "glyf", "name", "post"]
# Glyphs must be the same, whenever they are made: 2026-11-22, in seconds since 1904.
MADE = 3878150400


def drawn(font, name):
    """A glyph without parts."""
    pen = DecomposingRecordingPen(font.getGlyphSet())
    font.getGlyphSet()[name].draw(pen)
    glyph = TTGlyphPen(None)
    pen.replay(glyph)
    return glyph.glyph()


def cut(source, target, weight):
    font = TTFont(source / f"NotoSans-{weight}.ttf", recalcTimestamp=False)
    options = Options(layout_features=[], hinting=False, notdef_outline=True, name_IDs=[0, 1, 2, 3, 4, 5, 6, 13, 14])
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=[u for low, high in RANGES for u in range(low, high + 1)])
    subsetter.subset(font)
    for name in font.getGlyphOrder():
        font["glyf"][name] = drawn(font, name)
    for file, letters in BORROWED.items():
        lender = TTFont(source / file)
        assert lender["head"].unitsPerEm == font["head"].unitsPerEm
        for letter in letters:
            name = lender.getBestCmap()[ord(letter)]
            new = f"uni{ord(letter):04X}"
            glyph = drawn(lender, name)
            glyph.recalcBounds(lender["glyf"])
            # Adds the name to the order of glyphs, too.
            font["glyf"][new] = glyph
            font["hmtx"][new] = lender["hmtx"][name]
            for table in font["cmap"].tables:
                table.cmap[ord(letter)] = new
    for table in set(font.keys()) - set(TABLES) - {"GlyphOrder"}:
        del font[table]
    font["post"].formatType = 3.0
    font["head"].created = font["head"].modified = MADE
    font.save(target / f"NotoSans-{weight}.ttf")


for weight in ["Regular", "Bold"]:
    cut(Path(sys.argv[1]), Path(sys.argv[2]), weight)
