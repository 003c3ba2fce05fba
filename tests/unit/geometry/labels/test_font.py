"""The font of strokes."""

import numpy as np
import pytest

from amprep.geometry.labels.font import ADVANCE, HEIGHT, WIDTH, strokes_of, unknown_in

ALL = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_/.:+#"


@pytest.mark.parametrize("glyph", ALL)
def test_every_glyph_has_strokes_within_its_box(glyph):
    ends = strokes_of(glyph).ends
    assert len(ends)
    assert ends.min() >= 0.0
    assert ends[..., 0].max() <= WIDTH
    assert ends[..., 1].max() <= HEIGHT


def test_no_two_glyphs_look_alike():
    def picture(glyph):
        """The points of all strokes, a quarter of a unit apart."""
        spaced = np.linspace(0.0, 1.0, 25)[:, None]
        points = [a + spaced * (b - a) for a, b in strokes_of(glyph).ends]
        return frozenset(map(tuple, np.round(np.concatenate(points) * 2.0).astype(int).tolist()))

    pictures = {glyph: picture(glyph) for glyph in ALL}
    assert len(set(pictures.values())) == len(ALL)


def test_glyphs_stand_beside_each_other_and_a_space_is_as_wide():
    text = strokes_of("I I")
    assert text.width == 2 * ADVANCE + WIDTH
    assert np.array_equal(strokes_of("i").ends + (2 * ADVANCE, 0.0), text.ends[len(text.ends) // 2 :])


def test_other_characters_are_named():
    assert unknown_in("Aé-é?") == "é?"
