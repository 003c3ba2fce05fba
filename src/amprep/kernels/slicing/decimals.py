"""Write groups of rows of numbers as text."""

from typing import NamedTuple

from amprep.arrays import Bytes, Int64s
from amprep.kernels.helper import kernel, uncounted

_MINUS, _POINT, _ZERO = 45, 46, 48


class JoinedWords(NamedTuple):
    """Words in ASCII, one behind the other, and the first byte of each with the end of the last."""

    text: Bytes
    first: Int64s


@uncounted
def _put_word(words: JoinedWords, which: int, text: Bytes, size: int) -> int:
    """Write a word and return the new length of the text."""
    for at in range(words.first[which], words.first[which + 1]):
        text[size] = words.text[at]
        size += 1
    return size


@uncounted
def _put_number(value: int, decimals: int, digits: Bytes, text: Bytes, size: int) -> int:
    """Write a number in units of the last decimal and return the new length of the text."""
    if value < 0:
        text[size] = _MINUS
        size += 1
        value = -value
    count = 0
    while value > 0 or count <= decimals:
        digits[count] = _ZERO + value % 10
        value //= 10
        count += 1
    while count > 0:
        if count == decimals:
            text[size] = _POINT
            size += 1
        count -= 1
        text[size] = digits[count]
        size += 1
    return size


@kernel
def write_groups(
    heads: Int64s,
    head_words: JoinedWords,
    rows: Int64s,
    first: Int64s,
    row_words: JoinedWords,
    decimals: int,
    digits: Bytes,
    text: Bytes,
) -> int:
    """Write each group as its head, its rows and a last word, and return the length of the text.

    Parameters
    ----------
    heads, head_words
        ``(g, h)`` whole numbers at the head of each group, and the h + 1 words around them, then the last word.
    rows, first
        ``(n, k)`` numbers in units of the last decimal; group i has the rows from ``first[i]`` up to ``first[i + 1]``.
    row_words
        The k + 1 words around the numbers of a row.
    decimals
        Digits behind the decimal point of rows.
    digits
        ``(32,)`` work array.
    text
        Filled; 22 bytes for each number and all words are enough.
    """
    size = 0
    for group in range(len(heads)):
        for h in range(heads.shape[1]):
            size = _put_word(head_words, h, text, size)
            size = _put_number(heads[group, h], 0, digits, text, size)
        size = _put_word(head_words, heads.shape[1], text, size)
        for i in range(first[group], first[group + 1]):
            for k in range(rows.shape[1]):
                size = _put_word(row_words, k, text, size)
                size = _put_number(rows[i, k], decimals, digits, text, size)
            size = _put_word(row_words, rows.shape[1], text, size)
        size = _put_word(head_words, heads.shape[1] + 1, text, size)
    return size
