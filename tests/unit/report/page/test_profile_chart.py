"""The chart of the height profile."""

import re

import numpy as np
import pytest

from amprep.measures.height_profile import NO_PROFILE, HeightProfile
from amprep.report.page.profile_chart import HEIGHT, profile_chart
from amprep.report.record import BuildRecord


def test_the_chart_has_a_column_for_each_height_up_to_the_largest_area(make_build):
    profile = HeightProfile(2.0, 0.5, np.array([100.0, 200.0, 50.0]))
    html = profile_chart(1, BuildRecord(make_build(), profile=profile))
    tops = [float(value) for value in re.findall(r"V([\d.]+)H", html)]
    assert tops == pytest.approx([HEIGHT / 2, 0.0, HEIGHT * 0.75])
    labels = re.findall(r"<text [^>]*>([^<]*)</text>", html)
    assert labels == ["2.0", "2.8", "3.5", "height z, mm", "0", "1", "2", "area, cm²"]


def test_a_build_without_parts_has_no_chart(make_build):
    assert profile_chart(1, BuildRecord(make_build(), profile=NO_PROFILE)) == ""
