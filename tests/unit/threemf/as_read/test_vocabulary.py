"""What amprep never writes is named, in a model of any size."""

import pytest

from amprep.threemf.as_read.vocabulary import foreign_words

HEAD = (
    '<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
    'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" '
    'xmlns:s="http://slices" ><resources><object id="1" type="model"><mesh><vertices>'
)
VERTEX, TRIANGLE = '<vertex x="0" y="-1.5e-3" z="2"/>\n', '<triangle v1="0" v2="1" v3="2"/>\n'
TAIL = '</mesh></object></resources><build><item objectid="1" p:UUID="x"/></build></model>'


def model(vertices=VERTEX * 9, triangles=TRIANGLE * 9, head=HEAD, tail=TAIL):
    return f"{head}{vertices}</vertices><triangles>{triangles}</triangles>{tail}".encode()


def test_what_amprep_writes_is_not_foreign():
    coloured = '<triangle v1="0" v2="1" v3="2" pid="5" p1="0" p2="0" p3="0"/>'
    assert foreign_words(model(triangles=TRIANGLE * 9 + coloured)) == ()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (model(triangles=TRIANGLE * 9 + TRIANGLE.replace("/", ' s:paint="4"/')), "{http://slices}paint"),
        (model(head=HEAD.replace("<object ", '<object s:stack="1" ')), "{http://slices}stack of object"),
        (model(tail=TAIL.replace("<item ", '<item p:path="/x" ')), "the attribute p:path of item"),
        (model(tail="<s:cut/>" + TAIL), "the element {http://slices}cut"),
        (model(vertices=VERTEX * 9 + VERTEX.replace('"2"', '"0x2"')), "z='0x2' of vertex"),
        (model(head=HEAD.replace("millimeter", "Millimeter")), "unit='Millimeter' of model"),
    ],
)
def test_what_amprep_never_writes_is_named(text, words):
    (found,) = foreign_words(text)
    assert words in found


def test_it_is_found_beyond_the_first_piece_of_a_large_model():
    painted = TRIANGLE.replace("/", ' s:paint="4"/')
    (found,) = foreign_words(model(triangles=TRIANGLE * 60_000 + painted + TRIANGLE * 9))
    assert "paint" in found


def test_few_things_are_named_of_many():
    many = "".join(f"<s:a{number}/>" for number in range(100))
    assert len(foreign_words(model(tail=many + TAIL))) == 5


def test_a_model_that_is_not_well_formed_is_refused():
    with pytest.raises(ValueError, match="mismatched tag"):
        foreign_words(b"<model></x>")
