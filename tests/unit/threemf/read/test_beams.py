"""Beams of a 3MF file are read in millimetres with the nodes that they use, and a file without beams has none."""

import zipfile

import numpy as np
import pytest

from amprep.errors import InputError
from amprep.threemf.read import beams
from amprep.threemf.read.beams import read_beams

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
LATTICE = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
TYPES = (
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" '
    'Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
BEAMS = '<beam v1="1" v2="3"/><beam v1="3" v2="2" r1="0.5" r2="0.25"/>'


def write(path, beams_xml, unit="millimeter"):
    lattice = f'<b:beamlattice radius="1" minlength="0.001"><b:beams>{beams_xml}</b:beams></b:beamlattice>'
    points = [(9, 9, 9), (0, 0, 0), (0, 0, 2), (0, 0, 1)]
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in points)
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles/>{lattice if beams_xml else ''}</mesh>"
    model = (
        f'<model unit="{unit}" xmlns="{CORE}" xmlns:b="{LATTICE}" requiredextensions="b"><resources>'
        f'<object id="1" type="model">{mesh}</object></resources><build><item objectid="1"/></build></model>'
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", TYPES)
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr("3D/3dmodel.model", model.replace("<beam ", "<b:beam "))
    return path


@pytest.mark.parametrize(("unit", "scale"), [("millimeter", 1.0), ("inch", 25.4)])
def test_beams_are_read_in_millimetres_with_the_nodes_that_they_use(tmp_path, unit, scale):
    found = read_beams(write(tmp_path / "a.3mf", BEAMS, unit))
    assert found is not None
    nodes, struts, radii = found
    assert nodes == pytest.approx(np.array([[0, 0, 0], [0, 0, 2], [0, 0, 1]]) * scale)
    assert np.asarray(struts).tolist() == [[0, 2], [2, 1]]
    assert radii == pytest.approx(np.array([[1, 1], [0.5, 0.25]]) * scale)


def test_a_cell_of_too_many_beams_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(beams, "MOST_BEAMS", 1)
    with pytest.raises(InputError, match="expected at most 1 beams in a cell, found 2"):
        read_beams(write(tmp_path / "a.3mf", BEAMS))
