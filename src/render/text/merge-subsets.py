"""Joins font subsets: adds to a.ttf the glyphs of b.ttf, c.ttf and d.ttf whose characters it lacks (all 1000 units an em)."""
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont

base = TTFont("a.ttf")
characters = base.getBestCmap()
added = []
for path in ("b.ttf", "c.ttf", "d.ttf"):
    font = TTFont(path)
    glyphs = font.getGlyphSet()
    for code, name in sorted(font.getBestCmap().items()):
        if code in characters:
            continue
        recording = DecomposingRecordingPen(glyphs)
        glyphs[name].draw(recording)
        pen = TTGlyphPen(None)
        recording.replay(pen)
        new_name = f"uni{code:04X}.m"
        glyph = pen.glyph()
        base["glyf"][new_name] = glyph
        glyph.recalcBounds(base["glyf"])
        base["hmtx"][new_name] = (font["hmtx"][name][0], getattr(glyph, "xMin", 0))
        characters[code] = new_name
        added.append(code)
for table in base["cmap"].tables:
    if table.isUnicode():
        table.cmap.update({code: characters[code] for code in added})
base["post"].formatType = 3.0
base["post"].glyphOrder = None
for entry in base["name"].names:
    if entry.nameID in (1, 4):
        entry.string = "Noto Sans mechanim subset"
    if entry.nameID == 6:
        entry.string = "NotoSans-MechanimSubset"
base.save("NotoSans-subset.ttf")
