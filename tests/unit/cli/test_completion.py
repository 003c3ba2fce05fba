"""Shells complete names as amprep understands them."""

import pytest

from amprep.cli import completion
from amprep.printers.catalogue import find_printer


@pytest.mark.parametrize(
    ("complete", "begin", "expected"),
    [
        (completion.printers, "EOS M2", "eos-m290"),
        (completion.materials, "ti", "ti6al4v"),
        (completion.packers, "extreme", "extreme-points"),
        (completion.routers, "short", "shortest-paths"),
        (completion.cells, "x", "x-wall"),
    ],
)
def test_names_that_begin_so_are_offered(complete, begin, expected):
    assert expected in complete(begin)
    assert complete("no such name") == []


def test_what_is_offered_is_found():
    assert all(find_printer(name) for name in completion.printers("eos"))
