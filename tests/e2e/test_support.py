"""`amprep support`: supports for a plate as it lies."""

import json

import pytest

from amprep.threemf import read_build

BOX = ((0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0), (0, 0, 4), (10, 0, 4), (10, 10, 4), (0, 10, 4))
CORNERS = (
    *((0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4)),
    *((1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7)),
)
OFFICE = "http://schemas.openxmlformats.org/package/2006"
FMT = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def plate_3mf(path, *positions, triangles="", unit="millimeter", config="", attributes="", blocker=None):
    """Write a 3MF of one box of 10 x 10 x 4 mm, once at each position; with vertices of `blocker` after its own."""
    import zipfile

    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in (*BOX, *(blocker or ())))
    rows = triangles or "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in CORNERS)
    items = "".join(
        f'<item objectid="1" transform="1 0 0 0 1 0 0 0 1 {x} {y} {z}"/>' for x, y, z in positions
    )
    model = (
        f'<model unit="{unit}" xmlns="{FMT}" {attributes}><resources><object id="1" type="model"><mesh><vertices>'
        f"{vertices}</vertices><triangles>{rows}</triangles></mesh></object></resources><build>{items}</build></model>"
    )
    relation = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "[Content_Types].xml",
            f'<Types xmlns="{OFFICE}/content-types"><Default Extension="rels" ContentType="application/vnd.'
            'openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.'
            'ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        )
        archive.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{OFFICE}/relationships"><Relationship Target="/3D/3dmodel.model" Id="r" '
            f'Type="{relation}"/></Relationships>',
        )
        archive.writestr("3D/3dmodel.model", model)
        if config:
            archive.writestr("Metadata/Slic3r_PE_model.config", config)
    return path


def test_parts_stay_where_the_build_items_put_them(amprep, tmp_path):
    file = plate_3mf(tmp_path / "plate.3mf", (20, 30, 6), (60.5, 30, 0))
    outcome = amprep("support", file, "-o", tmp_path / "out", "--json")
    assert outcome.code == 0
    (build,) = outcome.json["builds"]
    assert [part["low_mm"] for part in build["parts"]] == [[20, 30, 6], [60.5, 30, 0]]
    assert [body["parts"] for body in build["supports"]["bodies"]] == [["plate"]], (
        "the second lies on the plate"
    )
    assert build["supports"]["volume_mm3"] > 0
    assert outcome.json["stop_reason"] == "as it lies"
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    stem = "plate.supported"
    suffixes = ("3mf", "placements.csv", "png", "report.html", "report.json")
    assert names == [f"{stem}.{suffix}" for suffix in suffixes]
    assert amprep("verify", tmp_path / "out" / f"{stem}.3mf").code == 0


def test_positions_are_in_the_unit_of_the_file(amprep, tmp_path):
    file = plate_3mf(tmp_path / "plate.3mf", (2, 3, 0.5), unit="centimeter")
    outcome = amprep("support", file, "--cell", "prism", "--json", "--dry-run")
    (part,) = outcome.json["builds"][0]["parts"]
    assert (part["low_mm"], part["high_mm"]) == ([20, 30, 5], [120, 130, 45])


def test_a_mesh_lies_where_its_own_coordinates_say_or_in_the_middle(amprep, fixtures, tmp_path):
    outside = amprep("support", fixtures / "table.stl", "-o", tmp_path)
    assert outside.code == 2
    assert "--center" in outside.err
    assert not list(tmp_path.iterdir())
    options = ("--center", "--cell", "prism", "--json")
    outcome = amprep("support", fixtures / "table.stl", "-o", tmp_path, *options)
    assert outcome.code == 0
    (part,) = json.loads((tmp_path / "table.supported.report.json").read_text(encoding="utf-8"))["builds"][0][
        "parts"
    ]
    assert [low + high for low, high in zip(part["low_mm"][:2], part["high_mm"][:2], strict=True)] == [
        250,
        250,
    ]
    assert part["low_mm"][2] == 0


@pytest.mark.parametrize("position", [(-5, 20, 0), (20, 20, -2), (245, 20, 0)])
def test_parts_outside_the_build_volume_are_refused_by_name(amprep, tmp_path, position):
    outcome = amprep("support", plate_3mf(tmp_path / "plate.3mf", position), "--dry-run")
    assert outcome.code == 2
    assert "plate reaches from" in outcome.err


def test_a_part_outside_a_round_build_volume_is_refused_though_it_is_in_the_box_around_it(amprep, tmp_path):
    profile = tmp_path / "round.toml"
    profile.write_text('name = "round"\nshape = "cylinder"\nsize_mm = [50, 60]\n')
    file = plate_3mf(tmp_path / "plate.3mf", (1, 1, 0))
    outcome = amprep("support", file, "--printer", profile, "-o", tmp_path / "out")
    assert outcome.code == 2
    assert "reaches from (1, 1, 0)" in outcome.err
    assert "outside the build volume" in outcome.err


def test_a_quantity_is_left_out_with_a_note(amprep, tmp_path):
    file = plate_3mf(tmp_path / "plate.3mf", (20, 30, 0))
    outcome = amprep("support", f"{file}:3", "-o", tmp_path / "out", "--json", "--dry-run")
    assert outcome.code == 0
    assert len(outcome.json["builds"][0]["parts"]) == 1
    assert outcome.json["notes"] == [
        "plate: supported 1 times, once per build item; quantity = 3 only applies to packing"
    ]


def test_a_printer_whose_process_needs_no_supports_gets_some_when_asked(amprep, tmp_path):
    file = plate_3mf(tmp_path / "plate.3mf", (20, 30, 6))
    own = "printer={size_mm=[100.0,100.0,50.0],technology='polymer-powder-bed'}"
    outcome = amprep("support", file, "--set", own, "--json", "-o", tmp_path)
    assert outcome.code == 0
    assert read_build(tmp_path / "plate.supported.3mf").supports


def _overhang_area(outcome):
    return sum(entry["area_mm2"] for entry in outcome.json["builds"][0]["supports"]["overhangs"])


def _box(path, corner, size):
    import trimesh

    box = trimesh.creation.box(extents=size)
    box.apply_translation([c + s / 2 for c, s in zip(corner, size, strict=True)])
    box.export(path)


def test_a_job_blocks_part_of_a_face_by_a_mesh(amprep, tmp_path):
    _box(tmp_path / "slab.stl", (0, 0, 0), (40, 20, 3))
    _box(tmp_path / "keep-free.stl", (-1, -1, -1), (21, 22, 5))
    (tmp_path / "job.toml").write_text(
        "packing.lift_mm = 5\n[[part]]\nfile = 'slab.stl'\nblockers = ['keep-free.stl']\n", encoding="utf-8"
    )
    outcome = amprep("run", tmp_path / "job.toml", "-o", tmp_path / "out", "--json")
    assert outcome.code == 0
    (region,) = outcome.json["builds"][0]["supports"]["overhangs"]
    assert (region["name"], region["kind"], region["supported"]) == ("overhang 1 of slab", "flat", "fully")
    assert region["area_mm2"] == pytest.approx(400, rel=0.03)
    build = read_build(tmp_path / "out" / "job.build-1.3mf")
    part_lo, _ = build.parts[0].mesh.bounds
    assert build.supports[0].mesh.bounds[0][0] > part_lo[0] + 17, "nothing stands under the blocked half"
    assert amprep("verify", tmp_path / "out" / "job.build-1.3mf").code == 0
    (tmp_path / "job.toml").write_text(
        "[[part]]\nfile = 'slab.stl'\nenforcers = ['nowhere.stl']\n", encoding="utf-8"
    )
    wrong = amprep("run", tmp_path / "job.toml", "-o", tmp_path / "out")
    assert wrong.code == 2
    assert "nowhere.stl" in wrong.err


@pytest.mark.parametrize(("paint", "area"), [("", 100), ("8", 50), ("0802", 87.5)])
def test_painted_blockers_of_a_3mf_take_their_area_away(amprep, tmp_path, paint, area):
    """The underside is two triangles of 50 mm2."""
    rows = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in CORNERS)
    if paint:
        rows = rows.replace('v3="1"/>', f'v3="1" s:custom_supports="{paint}"/>', 1)
    names = 'xmlns:s="http://schemas.slic3r.org/3mf/2017/06"'
    file = plate_3mf(tmp_path / "plate.3mf", (20, 30, 6), triangles=rows, attributes=names)
    outcome = amprep("support", file, "--json", "-o", tmp_path)
    assert outcome.code == 0
    assert _overhang_area(outcome) == pytest.approx(area, abs=6)


def test_support_blocker_volumes_of_prusaslicer_are_no_parts(amprep, tmp_path):
    config = (
        '<config><object id="1"><volume firstid="0" lastid="11"><metadata type="volume" key="volume_type" '
        'value="ModelPart"/></volume><volume firstid="12" lastid="23"><metadata type="volume" key="volume_type" '
        'value="SupportBlocker"/></volume></object></config>'
    )
    rows = "".join(
        f'<triangle v1="{a + shift}" v2="{b + shift}" v3="{c + shift}"/>'
        for shift in (0, 8)
        for a, b, c in CORNERS
    )
    around = [[1.2 * x - 1, 1.2 * y - 1, z - 1] for x, y, z in BOX]
    file = plate_3mf(tmp_path / "plate.3mf", (20, 30, 6), triangles=rows, config=config, blocker=around)
    outcome = amprep("support", file, "--json", "-o", tmp_path)
    assert outcome.code == 0
    assert outcome.json["builds"][0]["supports"]["overhangs"] == []
    assert outcome.json["builds"][0]["parts"][0]["triangles"] == 12


def test_every_overhang_is_listed_with_its_size_place_and_fate(amprep, fixtures, tmp_path):
    """A cone on its tip beside a prism on its edge: one tip with its height, one edge with its length."""
    import trimesh

    cone = trimesh.creation.cone(radius=3, height=12, sections=32)
    cone.apply_transform(trimesh.transformations.rotation_matrix(3.141592653589793, (1, 0, 0)))
    cone.apply_translation((30, 30, 20))
    cone.export(tmp_path / "cone.stl")
    outcome = amprep(
        "support", tmp_path / "cone.stl", "--json", "-o", tmp_path, "--set", "supports.pitch_mm=1"
    )
    (tip,) = outcome.json["builds"][0]["supports"]["overhangs"]
    assert (tip["name"], tip["kind"], tip["supported"]) == ("overhang 1 of cone", "tip", "fully")
    assert tip["height_mm"] == pytest.approx(8.0, abs=1e-4)
    assert tip["position_mm"] == pytest.approx([30, 30, 8], abs=1e-4)
    assert (tip["area_mm2"], tip["length_mm"]) == (None, None)
    assert "overhang 1 of cone" in (tmp_path / "cone.supported.report.html").read_text(encoding="utf-8")

    outcome = amprep("run", fixtures / "knife-edge.stl", "--json", "--dry-run", "--set", "packing.lift_mm=5")
    edges = [each for each in outcome.json["builds"][0]["supports"]["overhangs"] if each["kind"] == "edge"]
    assert edges
    assert all(
        each["length_mm"] > 0 and each["connected_squares"] == each["demand_squares"] > 0 for each in edges
    )


def test_a_lack_of_room_is_answered_by_the_advice_of_a_finer_grid(amprep, tmp_path):
    """Two slabs a millimetre apart: no cube of 2 mm between them is white."""
    _box(tmp_path / "slabs.stl", (0, 0, 0), (20, 20, 5))
    import trimesh

    upper = trimesh.creation.box(extents=(20, 20, 5))
    upper.apply_translation((10, 10, 8.5))
    both = trimesh.util.concatenate([trimesh.load_mesh(tmp_path / "slabs.stl"), upper])
    both.export(tmp_path / "slabs.stl")
    outcome = amprep("run", tmp_path / "slabs.stl", "--json", "--dry-run", "--set", "supports.pitch_mm=2")
    assert outcome.code == 1
    (region,) = outcome.json["builds"][0]["supports"]["unsupported"]
    assert region["reason"] == "no free voxel below"
    assert any("--set supports.pitch_mm=1" in words for words in outcome.json["warnings"])


def test_what_has_no_way_is_answered_by_the_advice_of_standing_on_the_part(amprep, tmp_path):
    """A ball with a ball-shaped hole: nothing leads out of it."""
    import trimesh

    hole = trimesh.creation.icosphere(2, 6.0)
    hole.invert()
    trimesh.util.concatenate([trimesh.creation.icosphere(2, 9.0), hole]).export(tmp_path / "hollow.stl")
    command = ("support", tmp_path / "hollow.stl", "--center", "--json", "--dry-run")
    outcome = amprep(*command)
    (advice,) = [words for words in outcome.json["warnings"] if "no path to the build plate" in words]
    assert "1 region has" in advice
    assert "--set supports.grounding=anywhere" in advice
    inside = amprep(*command, "--grounding", "anywhere")
    assert not any("no path to the build plate" in words for words in inside.json["warnings"])
    assert "on parts, as supports.grounding allows" in inside.json["builds"][0]["supports"]["notes"][0]


def test_supports_are_planned_whatever_the_job_says_and_a_limit_of_time_is_listed(amprep, tmp_path):
    _box(tmp_path / "box.stl", (0, 0, 10), (20, 20, 5))
    command = ("support", tmp_path / "box.stl", "--json", "--dry-run", "--set", "supports.enabled=false")
    outcome = amprep(*command)
    assert outcome.code == 0
    assert outcome.json["builds"][0]["supports"]["demand_squares"] > 0
    assert any(
        words.startswith("'amprep support' ignores supports.enabled = false")
        for words in outcome.json["notes"]
    )
    late = amprep(*command, "--time-limit", "0.000001")
    assert late.code == 1
    supports = late.json["builds"][0]["supports"]
    assert {each["reason"] for each in supports["unconnected_squares"]} == {"time limit"}
    assert any("allow a longer time limit" in words for words in late.json["warnings"])


def test_no_grid_is_so_coarse_that_anything_counts_as_held(amprep, tmp_path):
    _box(tmp_path / "box.stl", (0, 0, 30), (60, 60, 5))
    outcome = amprep(
        "support", tmp_path / "box.stl", "--json", "--set", "supports.pitch_mm=20", "-o", tmp_path
    )
    assert outcome.code == 0
    assert amprep("verify", tmp_path / "box.supported.3mf").code == 0
