"""Tips are moved, made narrower or left out such that each is whole on the contact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection
from tests.shared.examples import examples

from amprep.geometry.connectors.fitting import ROOT, WHOLE, fit_tips, root_of, surfaces_of, unfitted

WIDE, NARROW, SIDE, COUNT = 0.5, 0.36, 0.8, 6


def corners():
    y, x = np.divmod(np.arange(COUNT * COUNT), COUNT)
    lo = np.column_stack([x, y]) * SIDE
    return lo, lo + SIDE


def band(middle, width, turn):
    """Return a level strip of contact as two triangles that face down, and as a region."""
    region = CrossSection.square((20.0, width), center=True).rotate(turn).translate(middle)
    a, b, c, d = (np.append(point, 5.0) for point in np.asarray(region.to_polygons()[0]))
    return np.array([[a, c, b], [a, d, c]]), region


def fitted(contact, region):
    """Return tips that were wanted at the centres of cells, and the cells in which they are."""
    lo, hi = corners()
    cells = [CrossSection.square((SIDE, SIDE)).translate(each.tolist()) ^ region for each in lo]
    area = np.array([each.area() for each in cells])
    own = np.flatnonzero(area > 1e-3 * SIDE**2)
    column = own // (2 * COUNT) * COUNT + own % COUNT // 2
    wanted = unfitted((lo + hi)[own] / 2.0, WIDE)
    whole = area[own] >= WHOLE * SIDE**2
    surface = surfaces_of(contact)
    return fit_tips(wanted, whole, (lo[own], hi[own]), column, contact, surface, NARROW), own, column


@given(st.tuples(st.floats(1.0, 4.0), st.floats(1.0, 4.0)), st.floats(0.45, 3.0), st.floats(0.0, 180.0))
@examples(30)
def test_every_tip_is_whole_on_a_contact_that_is_wide_enough(middle, width, turn):
    contact, region = band(middle, width, turn)
    tips, own, _ = fitted(contact, region)
    lo, hi = corners()
    for row in np.flatnonzero(tips.kept):
        at, half = tips.spot[row], tips.width[row] / 2.0
        assert (CrossSection.circle(half, 48).translate(at.tolist()) - region).area() < 1e-6
        if tips.inside[row]:
            assert (at - half >= lo[own[row]] - 1e-6).all()
            assert (at + half <= hi[own[row]] + 1e-6).all()
        rim = ROOT * SIDE
        low, high = root_of((at - half, at + half), lo[own[row]] + rim, hi[own[row]] - rim, tips.spread[row])
        root = CrossSection.square((high - low).tolist()).translate(low.tolist())
        assert tips.spread[row] == 0.0 or (root - region).area() < 1e-3


@given(st.floats(0.0, SIDE), st.floats(0.45, 3.0))
@examples(20)
def test_a_cell_keeps_its_tip_if_a_narrow_one_fits_into_it(start, width):
    """The band is parallel to the cells, so that what fits is known."""
    contact, region = band((2.4, start + width / 2.0), width, 0.0)
    tips, own, _ = fitted(contact, region)
    low, high = own // COUNT * SIDE, own // COUNT * SIDE + SIDE
    fits = np.minimum(high, start + width) - np.maximum(low, start) > NARROW + 0.03
    assert tips.kept[fits].all()
    covered = (low > start) & (high < start + width)
    assert (tips.width[covered] == WIDE).all()
    assert (tips.spread[covered] == 1.0).all()


def test_each_column_keeps_a_tip_even_if_none_fits():
    contact, region = band((2.4, 2.0), 0.1, 0.0)
    tips, _, column = fitted(contact, region)
    assert set(column[tips.kept].tolist()) == set(column.tolist())
    assert np.bincount(column[tips.kept]).max() == 1


def test_a_tip_between_two_columns_reaches_into_the_one_without_a_tip():
    """Two cells side by side, the contact mostly in one of them."""
    contact, region = band((0.0, 1.6 - 0.1), 0.45, 0.0)
    tips, own, _ = fitted(contact, region)
    above = own // COUNT == 2
    assert above.any()
    for row in np.flatnonzero(tips.kept & above):
        assert tips.spot[row, 1] + tips.width[row] / 2.0 > 1.6
        assert tips.spot[row, 1] + tips.width[row] / 2.0 == pytest.approx(1.725 - 0.01, abs=0.02)


def test_a_tip_between_two_surfaces_at_a_wall_is_below_one_of_them():
    """The wall is at x = 2.1; cells are covered, but by two surfaces."""
    low, left = band((0.1, 2.4), 4.8, 0.0)[0], 2.1
    low[..., 0] = np.where(low[..., 0] > 0.0, left, -8.0)
    high = low.copy()
    high[..., 0] = np.where(low[..., 0] == left, 12.0, left)
    high[..., 2] = 7.0
    contact = np.concatenate([low, high])
    lo, hi = corners()
    own = np.arange(len(lo))
    surface = surfaces_of(contact)
    assert len(set(surface.tolist())) == 2
    whole = (hi[:, 0] < left) | (lo[:, 0] > left)
    tips = fit_tips(unfitted((lo + hi) / 2.0, WIDE), whole, (lo, hi), own, contact, surface, NARROW)
    assert tips.kept.all()
    away = np.abs(tips.spot[:, 0] - left)
    assert (away >= tips.width / 2.0 - 1e-6).all()
    assert (tips.width[~whole] < WIDE).all()
