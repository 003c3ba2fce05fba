"""Write points as text, fast."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Int64s

if TYPE_CHECKING:
    from amprep.kernels.slicing.decimals import JoinedWords

_MOST_DIGITS = 22
"""Bytes of a number of 64 bits with sign and decimal point."""


def groups_text(
    heads: Int64s,
    head_words: Sequence[bytes],
    rows: Int64s,
    first: Int64s,
    row_words: Sequence[bytes],
    decimals: int,
) -> bytes:
    """Return groups of rows of numbers as text.

    Parameters
    ----------
    heads, head_words
        ``(g, h)`` whole numbers at the head of each group, and the h + 1 words around them, then the last word of a
        group.
    rows, first
        ``(n, k)`` numbers in units of the last decimal; group i has the rows from ``first[i]`` up to ``first[i + 1]``.
    row_words
        The k + 1 words around the numbers of a row.
    decimals
        Digits behind the decimal point of rows, at most 9.
    """
    from amprep.kernels.slicing.decimals import write_groups

    most = len(heads) * (_MOST_DIGITS * heads.shape[1] + sum(map(len, head_words)))
    most += len(rows) * (_MOST_DIGITS * rows.shape[1] + sum(map(len, row_words)))
    text = np.empty(most, np.uint8)
    size = write_groups(
        np.ascontiguousarray(heads, np.int64),
        _words(head_words),
        np.ascontiguousarray(rows, np.int64),
        np.ascontiguousarray(first, np.int64),
        _words(row_words),
        decimals,
        np.empty(32, np.uint8),
        text,
    )
    return text[:size].tobytes()


def rows_text(rows: Int64s, decimals: int, words: Sequence[bytes]) -> bytes:
    """Return rows of numbers ``(n, k)`` as text, with k + 1 words around the numbers of each; see `groups_text`."""
    return groups_text(
        np.empty((1, 0), np.int64), (b"", b""), rows, np.array([0, len(rows)]), words, decimals
    )


def _words(words: Sequence[bytes]) -> "JoinedWords":
    from amprep.kernels.slicing.decimals import JoinedWords

    first = np.zeros(len(words) + 1, np.int64)
    np.cumsum([len(word) for word in words], out=first[1:])
    return JoinedWords(np.array(bytearray(b"".join(words)), np.uint8), first)
