"""The list of labels is read with checks of every column."""

import pytest

from amprep.errors import JobError
from amprep.job import load_job
from amprep.job.labels import LabelSettings, read_labels


def read(tmp_path, text):
    (tmp_path / "labels.csv").write_text(text, encoding="utf-8")
    return read_labels(tmp_path / "labels.csv")


def test_rows_become_labels_with_defaults(tmp_path):
    first, second = read(
        tmp_path,
        "part,text,copy,kind,face,x_mm,height_mm\nbracket,A-{copy},,,,,\nco*,B,2,raised,left,1.5,3\n",
    )
    assert first == LabelSettings(2, "bracket", "A-{copy}")
    assert second == LabelSettings(3, "co*", "B", 2, "raised", "left", (1.5, 0.0), 3.0)
    assert first.text_for("bracket", 2, 3) == "A-2"
    assert (second.is_for("cover", 2), second.is_for("cover", 1), second.is_for("bar", 2)) == (
        True,
        False,
        False,
    )


def test_semicolons_of_spreadsheets_are_read(tmp_path):
    assert read(tmp_path, "\ufeffpart;text\nbracket;7,5\n".replace(",", "."))[0].text == "7.5"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("part\nb\n", "columns part and text"),
        ("part,txt\nb,A\n", r"unknown column 'txt' \(did you mean 'text'\?\)"),
        ("part,text\nb,\n", "row 2: part and text must not be empty"),
        ("part,text\nb,A?\n", "row 2: the font has no '\\?'"),
        ("part,text\nb,SN-{number}\n", "row 2: unknown placeholder in 'SN-{number}'"),
        (f"part,text\nb,{'A' * 41}\n", "at most 40 characters, got 41"),
        ("part,text,copy\nb,A,0\n", "copy must be at least 1, got 0"),
        ("part,text,copy\nb,A,x\n", "copy: expected a whole number, got 'x'"),
        ("part,text,kind\nb,A,deep\n", "kind: expected engraved or raised, got 'deep'"),
        ("part,text,face\nb,A,up\n", "face: expected one of top, front, .*, got 'up'"),
        ("part,text,height_mm\nb,A,1\n", "height_mm must be between 2 and 100, got 1.0"),
        ("part,text,depth_mm\nb,A,nan\n", "depth_mm: expected a number, got 'nan'"),
        ("part,text\nb,A,B\n", "more columns than the heading"),
        ('part,text\nb,"A\n', "not a CSV file"),
        ("", "columns part and text, got none"),
        ("part,text,text\nb,A,B\n", "the heading has the column text 2 times"),
        ("part,text\n\n,\nb,A?\n", "row 4: the font has no"),
    ],
)
def test_mistakes_are_named_with_row_and_column(tmp_path, text, words):
    with pytest.raises(JobError, match=words):
        read(tmp_path, text)


def test_empty_rows_count_but_say_nothing(tmp_path):
    assert read(tmp_path, "\n;;\n\npart;text;\n\nb;A;\n;;\n") == (LabelSettings(6, "b", "A"),)


def test_a_job_names_its_list_relative_to_its_folder(tmp_path):
    (tmp_path / "job.toml").write_text('inputs = ["a.stl"]\nlabels = "l.csv"\n')
    with pytest.raises(JobError, match="labels: no file at"):
        load_job(tmp_path / "job.toml")
    (tmp_path / "l.csv").write_text("part,text\na,1\n")
    assert load_job(tmp_path / "job.toml").labels == tmp_path / "l.csv"
