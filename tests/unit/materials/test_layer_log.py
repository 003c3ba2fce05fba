"""Logs of builds are read from CSV files as spreadsheets and machines write them; wrong ones are refused by row."""

from pathlib import Path

import pytest

from amprep.errors import InputError
from amprep.materials import layer_log
from amprep.materials.layer_log import read_layer_log


def write(folder: Path, text: str) -> Path:
    path = folder / "log.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "text",
    [
        "layer,seconds,area\n1,10.5,200\n2,11,250\n",
        "\ufeffArea;Layer;Seconds;note\n200;1;10.5;x\n\n250;2;11;\n",
    ],
)
def test_columns_may_be_in_any_order_with_commas_or_semicolons(tmp_path: Path, text: str) -> None:
    seconds, area = read_layer_log(write(tmp_path, text))
    assert seconds.tolist() == [10.5, 11.0]
    assert area.tolist() == [200.0, 250.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected one column 'layer'"),
        ("layer,second,area\n", "expected one column 'seconds' in its first row .*'second'"),
        ("layer,seconds,area,area\n", "expected one column 'area'"),
        ("layer,seconds,area\n1,10,200\n\n2,-1,200\n", "row 4: expected numbers of at least 0"),
        ("layer,seconds,area\n1,nan,200\n", "row 2"),
        ("layer,seconds,area\n1,10\n", "row 2"),
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_layer_log(write(tmp_path, text))


def test_files_that_are_no_text_or_too_large_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "x.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not text in UTF-8"):
        read_layer_log(tmp_path / "x.csv")
    with pytest.raises(InputError, match="cannot be read"):
        read_layer_log(tmp_path / "missing.csv")
    monkeypatch.setattr(layer_log, "MOST_LAYERS", 1)
    with pytest.raises(InputError, match="more than 1 layers"):
        read_layer_log(write(tmp_path, "layer,seconds,area\n1,1,1\n2,2,2\n"))
    monkeypatch.setattr(layer_log, "LARGEST", 3)
    with pytest.raises(InputError, match="larger than"):
        read_layer_log(tmp_path / "log.csv")
