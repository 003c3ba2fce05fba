"""What an edited file was made from is found whatever program saved it, and a job overrules it."""

import re
import shutil
import zipfile
from collections import Counter

import pytest
from tests.shared.edited import MODEL, edit, shift

import amprep
from amprep.errors import InputError
from amprep.job import load_job, override
from amprep.pipeline.replanning.course import NO_SUPPORTS
from amprep.threemf import read_build
from amprep.threemf.build.identifier import read_identifier

PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RELATIONS = "http://schemas.openxmlformats.org/package/2006/relationships"
TYPE = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def contents(path):
    with zipfile.ZipFile(path) as package:
        return {name: package.read(name) for name in package.namelist()}


def written(path, entries):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        for name, content in entries.items():
            package.writestr(name, content)
    return path


def rounded(source, target):
    """Write a file whose coordinates differ a little from those that it had, as another program may save it."""
    entries = contents(source)
    text = entries[MODEL].decode()
    text = re.sub(r'(?<= [xyz]=")[^"]+', lambda found: f"{float(found[0]) * 1.000001:.6f}", text)
    return written(target, entries | {MODEL: text.encode()})


def project(source, path, *, plates=1, moved=None):
    """Write a build file as OrcaSlicer saves it: without our record, each object in a model part of its own.

    Ids of objects repeat, names are in a configuration, and the frame of an object is not that of the build.
    """
    build, identifier = read_build(source), read_identifier(source)
    entries = {name: text for name, text in contents(source).items() if name != MODEL}
    objects, items, names, rels = "", "", "", ""
    for number, part in enumerate(build.parts):
        meshes = [(part.label, part.mesh)]
        meshes += [(body.name, body.mesh) for body in build.supports if number in body.parts]
        file, own = f"3D/Objects/object_{number}.model", 100 + number
        bodies = "".join(mesh_object(index, mesh) for index, (_, mesh) in enumerate(meshes, start=1))
        entries[file] = model(bodies, "")
        components = "".join(
            f'<component p:path="/{file}" objectid="{index}" transform="1 0 0 0 1 0 0 0 1 1 2 3"/>'
            for index in range(1, len(meshes) + 1)
        )
        objects += f'<object id="{own}" type="model"><components>{components}</components></object>'
        x = -1 + (moved or {}).get(number, 0.0)
        items += f'<item objectid="{own}" transform="1 0 0 0 1 0 0 0 1 {x} -2 -3"/>'
        roles = "".join(
            f'<part id="{index}" subtype="normal_part"><metadata key="name" value="{name}"/></part>'
            for index, (name, _) in enumerate(meshes, start=1)
        )
        title = f'<metadata key="name" value="{part.label} (job.build-1 {identifier})"/>'
        names += f'<object id="{own}">{title}{roles}</object>'
        rels += f'<Relationship Target="/{file}" Id="r{number}" Type="{TYPE}"/>'
    plate = '<plate><model_instance><metadata key="object_id" value="100"/></model_instance></plate>'
    entries[MODEL] = model(objects, items)
    entries["Metadata/model_settings.config"] = f"<config>{names}{plate * plates}</config>"
    entries["3D/_rels/3dmodel.model.rels"] = f'<Relationships xmlns="{RELATIONS}">{rels}</Relationships>'
    return written(path, entries)


def model(objects, items):
    return (
        f'<model xmlns="{CORE}" xmlns:p="{PRODUCTION}" unit="millimeter" requiredextensions="p">'
        f"<resources>{objects}</resources><build>{items}</build></model>"
    )


def mesh_object(number, mesh):
    vertices = "".join(f'<vertex x="{x:.7f}" y="{y:.7f}" z="{z:.7f}"/>' for x, y, z in mesh.vertices)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.triangles)
    return (
        f'<object id="{number}" type="model"><mesh><vertices>{vertices}</vertices>'
        f"<triangles>{triangles}</triangles></mesh></object>"
    )


def outcomes(record):
    return [(each.change, each.supports) for each in record.parts]


def test_a_project_of_orcaslicer_is_recognised_by_its_triangles(made, plate, tmp_path):
    record = amprep.replan(
        project(plate, tmp_path / "a.3mf", moved={1: 100.0}),
        output=tmp_path,
        report=made / "job.report.json",
    )
    kept = ("none", "kept")
    assert outcomes(record) == [kept, ("moved", "taken along"), kept, ("none", "none needed")]
    assert amprep.verify(tmp_path / record.file).ok


def test_a_project_is_found_by_the_names_in_its_configuration(plate, tmp_path):
    shutil.copy(plate, tmp_path / "original.3mf")
    record = amprep.replan(project(plate, tmp_path / "a.3mf"), output=tmp_path / "out", dry_run=True)
    assert record.source == "made from original.3mf, by the identifier in names of objects"


def test_a_project_with_parts_on_two_plates_is_refused(made, plate, tmp_path):
    file = project(plate, tmp_path / "a.3mf", plates=2)
    with pytest.raises(InputError, match="parts on 2 plates; move all to one"):
        amprep.replan(file, output=tmp_path, report=made / "job.report.json")


def test_rounded_coordinates_are_those_of_the_build_beside_the_file(plate, tmp_path):
    """Without that build, parts are taken as they are, and supports are planned again."""
    file = rounded(plate, tmp_path / "a.3mf")
    alone = amprep.replan(file, output=tmp_path / "out")
    assert "rounded" in alone.source
    assert Counter(supports for _, supports in outcomes(alone)) == {"planned again": 3, "none needed": 1}
    assert alone.faults == 0
    shutil.copy(plate, tmp_path / "original.3mf")
    beside = amprep.replan(file, output=tmp_path / "out")
    assert Counter(supports for _, supports in outcomes(beside)) == {"kept": 3, "none needed": 1}
    assert amprep.diff(plate, tmp_path / "out" / beside.file).supports == ()


def test_a_part_that_was_cut_with_its_record_intact_is_refused(plate, tmp_path):
    entries = contents(plate)
    highest = max(re.findall(rb' z="([^"]+)"', entries[MODEL]), key=float)
    entries[MODEL] = entries[MODEL].replace(b' z="' + highest + b'"', b' z="7.5"')
    with pytest.raises(InputError, match=r"tee\S* has another shape than the build recorded: it was cut"):
        amprep.replan(written(tmp_path / "a.3mf", entries), output=tmp_path)


def test_a_job_with_the_same_settings_keeps_supports_and_with_others_keeps_none(made, plate, tmp_path):
    file = edit(plate, tmp_path / "a.3mf", {0: shift(y=120.0)})
    same = amprep.replan(file, output=tmp_path, job=made / "job.toml")
    assert outcomes(same)[:2] == [("moved", "taken along"), ("none", "kept")]
    changes = {"supports.least_wall_mm": 0.2}
    other = amprep.replan(file, output=tmp_path, job=override(load_job(made / "job.toml"), changes))
    assert {each.supports for each in other.parts[:3]} == {"planned again"}
    assert {each.reason for each in other.parts} == {"the job has another least_wall_mm"}
    assert read_build(tmp_path / other.file).settings.rules.least_wall_mm == 0.2
    assert amprep.verify(tmp_path / other.file).ok


def test_a_job_plans_supports_where_the_build_had_none(made, tmp_path):
    settings = {"printer": "EOS M290", "supports.enabled": False, "packing.strategy": "extreme-points"}
    amprep.run(made / "tee.stl", output=tmp_path, settings=settings)
    (file,) = tmp_path.glob("*.3mf")
    alone = amprep.replan(file, output=tmp_path / "out", dry_run=True)
    assert (outcomes(alone), alone.notes) == ([("none", "not planned")], (NO_SUPPORTS,))
    planned = amprep.replan(file, output=tmp_path / "out", job=made / "job.toml")
    assert outcomes(planned) == [("none", "planned again")]
    assert amprep.verify(tmp_path / "out" / planned.file).ok
