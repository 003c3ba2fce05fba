"""Loading plugins: fake installed packages on disk, one of them broken in each way there is."""

import sys

import pytest

from amprep.errors import PluginError
from amprep.host import Host
from amprep.host.loading import BUILT_IN

HEAD = """
from amprep.hookspecs import *
amprep_api = 1
"""
PACKER = """
@hookimpl
def amprep_packers():
    yield Packer({name!r}, "packs nothing", run=lambda problem, **rest: None)
"""
GOOD = HEAD + PACKER


@pytest.fixture
def site(tmp_path, monkeypatch):
    """A folder on sys.path into which fake packages are installed; their modules are forgotten afterwards."""
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)

    def install(distribution, source, version="1.2", entry_point=None):
        module = distribution.replace("-", "_")
        (tmp_path / f"{module}.py").write_text(source, encoding="utf-8")
        info = tmp_path / f"{module}-{version}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n")
        (info / "entry_points.txt").write_text(f"[amprep]\n{entry_point or module} = {module}\n")

    yield install
    for name in set(sys.modules) - before:
        del sys.modules[name]


def load(*modules, env=None, **options):
    return Host.load(modules=modules, env=env or {}, **options)


def own_warnings(host):
    """Warnings about anything but the built-in plugins."""
    return [warning for warning in host.warnings if "of amprep " not in warning]


def test_an_installed_plugin_is_listed_with_its_distribution_and_version(site):
    site("fake-rows", GOOD.format(name="rows"))
    host = load()
    listed = host.choose("packer", "rows")
    assert (listed.distribution, listed.version, listed.builtin) == ("fake-rows", "1.2", False)
    assert listed.title == "packer 'rows' of fake-rows 1.2"
    assert own_warnings(host) == []


def test_the_built_in_plugins_load_without_a_warning():
    host = load(plugins_enabled=False)
    assert host.warnings == []
    origins = {
        each.plugin
        for kind in ("reader", "volume", "packer", "router", "cell")
        for each in host.offers(kind).values()
    }
    assert origins == set(BUILT_IN)


X = GOOD.format(name="x")


def yielding(record, hook="amprep_packers"):
    """A plugin whose one hook yields `record`."""
    return f"{HEAD}@hookimpl\ndef {hook}():\n    yield {record}"


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import nothing_like_this", "ModuleNotFoundError: No module named 'nothing_like_this'"),
        ("raise SystemExit(3)", "SystemExit: 3"),
        ("def broken(:", "SyntaxError"),
        (X.replace("amprep_api = 1", ""), "states no hook API version; expected 'amprep_api = 1'"),
        (X.replace("amprep_api = 1", "amprep_api = 99"), "hook API 99, this amprep has 1"),
        (
            X.replace("amprep_packers", "amprep_packer"),
            "'amprep_packer' (did you mean 'amprep_packers'?)",
        ),
        (X.replace("@hookimpl", ""), "amprep_packers lacks the decorator @hookimpl"),
        (HEAD, "has none of the hooks"),
        (X.replace("amprep_packers()", "amprep_packers(config)"), "PluginValidationError"),
        (yielding("int('no licence')"), "ValueError: invalid literal for int() with base 10: 'no licence'"),
        (X.replace("yield", "return None #"), "amprep_packers returned nothing"),
        (yielding("'x'"), "yields Packer records, got str"),
        (X + X[X.index("    yield") :], "more than one offer named 'x'"),
        (GOOD.format(name="Two Words"), "a name must consist of lower-case"),
        (yielding("Packer('x', '', run=print)"), "a summary must be one line"),
        (yielding("Packer('x', 'y', run=3)"), "run must be callable, got int"),
        (yielding("Packer('x', 'y', run=print, params=dict)"), "params must be a dataclass"),
        (
            yielding("Packer('x', 'y', run=print, accepts=PackerAccepts(objectives=frozenset({'speed'})))"),
            "accepts.objectives must be among builds, fill, height, got speed",
        ),
        (
            yielding("VolumeMaker('x', 'y', run=print, makes='ball')", "amprep_volume_makers"),
            "makes must be one of box, boxes, convex, solid, got 'ball'",
        ),
        (
            yielding("MeshReader('x', 'y', run=print, suffixes=('STL',))", "amprep_mesh_readers"),
            "suffixes must be lower case and start with a dot",
        ),
        (
            yielding("CellEmitter('x', 'y', run=print, material=3)", "amprep_cell_emitters"),
            "material must be a function or None",
        ),
        (
            yielding("SupportRouter('x y', 'y', run=print)", "amprep_support_routers"),
            "a name must consist of lower-case",
        ),
    ],
)
def test_a_broken_plugin_costs_one_warning_and_nothing_else(site, source, reason):
    site("fake-broken", source, version="0.9")
    site("fake-rows", GOOD.format(name="rows"))
    host = load()
    (warning,) = own_warnings(host)
    assert warning.startswith("plugin 'fake_broken' of fake-broken 0.9 was not loaded: ")
    assert reason in warning
    assert "\n" not in warning
    assert host.choose("packer", "rows").distribution == "fake-rows"


FROZEN = "@dataclass(frozen=True)\nclass P:\n    "


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("@dataclass\nclass P:\n    a: int = 1", "must be frozen"),
        (FROZEN + "a: int", "every parameter must have a default; these have none: a"),
        (FROZEN + "a: complex = 1j", "use bool, int, float"),
        (FROZEN + "a: 'Nothing' = 1", "name 'Nothing' is not defined"),
        (FROZEN + "def __post_init__(self): raise ValueError('a is 2')", "are out of its own bounds: a is 2"),
    ],
)
def test_a_params_class_that_cannot_be_set_is_refused_at_once(site, body, reason):
    offer = "\n@hookimpl\ndef amprep_packers():\n    yield Packer('x', 'y', run=print, params=P)"
    site("fake-broken", HEAD + "from dataclasses import dataclass\n" + body + offer)
    (warning,) = own_warnings(load())
    assert reason in warning


def test_a_name_offered_twice_is_refused_when_chosen_and_others_still_work(site):
    site("fake-one", HEAD + PACKER.format(name="rows"))
    site("fake-two", HEAD + PACKER.format(name="rows") + "    yield Packer('other', 'y', run=print)")
    host = load()
    (warning,) = own_warnings(host)
    assert "packer 'rows' is offered by fake-one 1.2 and by fake-two 1.2" in warning
    with pytest.raises(PluginError, match=r"offered by fake-one 1\.2 and fake-two 1\.2; block one"):
        host.choose("packer", "rows")
    assert host.choose("packer", "other").distribution == "fake-two"
    assert load("no:fake-two").choose("packer", "rows").distribution == "fake-one"


def test_a_built_in_name_cannot_be_taken_over(site):
    site(
        "fake-box",
        HEAD + "@hookimpl\ndef amprep_volume_makers():\n    yield VolumeMaker('box', 'y', run=print)",
    )
    host = load()
    assert host.choose("volume", "box").builtin
    assert [w for w in host.warnings if "'box' is offered by amprep" in w and "the built-in one is kept" in w]


def test_no_plugins_loads_the_built_in_ones_only(site):
    site("fake-rows", GOOD.format(name="rows"))
    host = load(plugins_enabled=False)
    assert all(each.builtin for each in host.offers("packer").values())
    with pytest.raises(PluginError, match="contradict each other"):
        load("fake_rows", plugins_enabled=False)


@pytest.mark.parametrize(
    ("listed", "found"), [("", set()), ("fake_one", {"one"}), (" fake-two , fake_one", {"one", "two"})]
)
def test_the_environment_limits_the_installed_plugins_by_name_or_distribution(site, listed, found):
    site("fake-one", GOOD.format(name="one"))
    site("fake-two", GOOD.format(name="two"))
    host = load(env={"AMPREP_LOAD_PLUGINS": listed})
    assert {name for name, each in host.offers("packer").items() if not each.builtin} == found
    assert own_warnings(host) == []


def test_an_unknown_name_in_the_environment_is_a_warning_with_the_nearest(site):
    site("fake-one", GOOD.format(name="one"))
    (warning,) = own_warnings(load(env={"AMPREP_LOAD_PLUGINS": "fake_on"}))
    assert "'fake_on'" in warning
    assert "did you mean 'fake_one'" in warning


def test_blocking_what_is_not_there_is_a_warning(site):
    site("fake-one", GOOD.format(name="one"))
    assert own_warnings(load("no:fake_one")) == []
    (warning,) = own_warnings(load("no:fake_onee"))
    assert "did you mean 'fake_one'" in warning


def test_a_module_asked_for_is_loaded_by_name_or_path_and_only_once(site, tmp_path):
    site("fake-one", GOOD.format(name="one"))
    (tmp_path / "loose.py").write_text(GOOD.format(name="loose"), encoding="utf-8")
    host = load("loose", "fake_one")
    assert host.choose("packer", "loose").origin == "module loose"
    assert host.choose("packer", "one").distribution == "fake-one"
    assert own_warnings(host) == []
    assert load(str(tmp_path / "loose.py")).choose("packer", "loose").plugin == "loose"


@pytest.mark.parametrize("name", ["nothing_like_this", "nowhere/plugin.py", "", "..", "json"])
def test_a_module_asked_for_that_is_no_plugin_is_an_error(name):
    with pytest.raises(PluginError, match="cannot be loaded"):
        load(name)


def test_damaged_metadata_of_a_stranger_is_survived(site, tmp_path):
    site("fake-rows", GOOD.format(name="rows"))
    (tmp_path / "fake_rows-1.2.dist-info" / "METADATA").unlink()
    assert load().choose("packer", "rows").version in ("?", "1.2")


def test_a_damaged_list_of_entry_points_costs_one_warning(site, tmp_path):
    site("fake-rows", GOOD.format(name="rows"))
    site("fake-damaged", GOOD.format(name="other"))
    (tmp_path / "fake_damaged-1.2.dist-info" / "entry_points.txt").write_text("[amprep]\nnonsense\n")
    host = load()
    assert host.choose("packer", "rows").distribution == "fake-rows"
    (warning,) = own_warnings(host)
    assert "the entry points of fake-damaged 1.2 cannot be read" in warning


def test_a_file_that_has_the_name_of_a_loaded_module_is_refused(tmp_path):
    path = tmp_path / "json.py"
    path.write_text(GOOD.format(name="rows"))
    with pytest.raises(PluginError, match="another module called 'json' is loaded already"):
        load(str(path))


def test_a_package_given_by_path_may_import_its_own_modules(site, tmp_path):
    package = tmp_path / "fake_package"
    package.mkdir()
    (package / "__init__.py").write_text("from fake_package.inner import *\namprep_api = 1")
    (package / "inner.py").write_text(GOOD.format(name="rows"))
    host = load(str(package))
    assert host.choose("packer", "rows").plugin == "fake_package"
    assert load(str(package)).choose("packer", "rows").plugin == "fake_package", (
        "loading it again does no harm"
    )


def test_listing_imports_nothing_heavy():
    import subprocess

    heavy = "{'numba', 'scipy', 'trimesh', 'manifold3d', 'lib3mf', 'networkx', 'cascadio', 'pulp', 'lxml'}"
    code = f"import sys; from amprep.host import Host; Host.load(); print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]", (
        "import it inside the function that needs it, so that start-up stays fast"
    )
