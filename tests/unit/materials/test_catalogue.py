"""Materials are found by name among the built-in profiles and those of the project and the user."""

import pytest
from tests.shared.profiles import Places, assert_refused

from amprep.errors import JobError
from amprep.materials.catalogue import DEFAULT_MATERIALS, densities_of, find_material, list_materials
from amprep.profiles import user_folder


@pytest.fixture
def places(tmp_path):
    return Places("material", tmp_path)


def limits(profile):
    return profile.ledge_mm, profile.bridge_mm, profile.bore_mm


def test_the_profiles_of_metal_differ_by_their_limits():
    expected = {"metal": (1, 2, 8), "metal-tolerant": (2, 4, 10), "metal-cautious": (0.5, 2, 6)}
    assert {name: limits(find_material(name)) for name in expected} == expected


def test_every_technology_has_a_default_that_exists():
    assert all(find_material(name).name == name for name in DEFAULT_MATERIALS.values())


@pytest.mark.parametrize("name", ["ti6al4v", "Ti-6Al-4V", "TI 6AL 4V", "Ti64", "tc4"])
def test_case_spaces_dashes_and_the_choice_of_a_name_do_not_matter(name):
    assert find_material(name).name == "Ti6Al4V"


def test_a_profile_takes_what_it_does_not_state_from_the_one_it_is_based_on(places):
    folder, _ = places
    (folder / "materials" / "mine.toml").write_text('based_on = "AlSi10Mg"\nledge_mm = 1.5\nleg_ratio = 8')
    mine, alloy = find_material("mine", *places), find_material("AlSi10Mg", *places)
    assert limits(mine) == (1.5, 2.0, 8.0)
    assert (mine.density_g_cm3, mine.leg_ratio) == (alloy.density_g_cm3, 8.0)
    assert (mine.name, mine.based_on, mine.aliases) == ("mine", "AlSi10Mg", ())


def test_a_profile_of_the_project_hides_and_may_extend_the_built_in_one_of_its_name(places):
    folder, env = places
    (folder / "materials" / "metal.toml").write_text('based_on = "metal"\nbore_mm = 5')
    assert limits(find_material("metal", folder, env)) == (1, 2, 5)
    assert limits(find_material("AlSi10Mg", folder, env)) == (1, 2, 5), "built-in alloys follow"
    assert limits(find_material("metal", None, env)) == (1, 2, 8)
    (user_folder(env, "materials") / "metal.toml").write_text("name = 'METAL'\nbore_mm = 7")
    assert find_material("metal", None, env).bore_mm == 7


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('based_on = "broken"', "based_on: no material is called 'broken'"),
        ("based_on = 3", "based_on: expected a text"),
        ("ledge_mm = -1", "ledge_mm must be .*, got -1"),
        ("ledge = 1", r"unknown key 'ledge' \(did you mean 'ledge_mm'\?\)"),
        ("density_g_cm3 = 0", "density_g_cm3 must be above 0"),
        ("[", "not a TOML file"),
    ],
)
def test_an_invalid_profile_is_refused_by_name_and_gives_a_warning_in_the_list(places, text, message):
    assert_refused(places, find_material, list_materials, text, message)
    assert find_material("metal", *places).name == "metal"


def test_profiles_that_are_based_on_each_other_are_refused(places):
    folder, env = places
    (folder / "materials" / "a.toml").write_text('based_on = "b"')
    (folder / "materials" / "b.toml").write_text('based_on = "a"')
    with pytest.raises(JobError, match="no material is called 'a'"):
        find_material("a", folder, env)


def test_an_unknown_material_is_refused_with_the_nearest(places):
    with pytest.raises(JobError, match=r"no material is called 'metall' \(did you mean 'metal'\?\)"):
        find_material("metall", *places)
    with pytest.raises(JobError, match="'amprep materials list' lists them"):
        find_material("xyzzy", *places)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("EOS Ti-6Al-4V Grade 5", "Ti6Al4V"),
        ("EOS AlSi10Mg", "AlSi10Mg"),
        ("Inconel 718", "IN718"),
        ("stainless steel 316L (1.4404)", "316L"),
    ],
)
def test_a_part_whose_material_names_an_alloy_has_the_density_of_its_profile(text, name):
    default = find_material("metal")
    density = find_material(name).density_g_cm3
    assert densities_of([text, None, "black paint"], default) == (density, None, None)


def test_other_parts_have_the_density_of_the_jobs_material(places):
    folder, _ = places
    alloy = find_material("AlSi10Mg")
    assert densities_of([None, "unknown"], alloy) == (alloy.density_g_cm3,) * 2
    (folder / "materials" / "our-alloy.toml").write_text("density_g_cm3 = 5.5")
    assert densities_of(["Our Alloy"], alloy, folder) == (5.5,)
