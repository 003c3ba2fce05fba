"""Rules of the model parts of a package: every element is handed to the rules of its chapter."""

from collections.abc import Mapping

from amprep.threemf.rules.broken import BrokenRules
from amprep.threemf.rules.build import check_build
from amprep.threemf.rules.markup import Markup
from amprep.threemf.rules.meshes import MeshRules
from amprep.threemf.rules.metadata import MetadataRules
from amprep.threemf.rules.resources import Component, ResourceRules
from amprep.threemf.rules.runs import Run
from amprep.threemf.rules.schema import READ_EXTENSIONS


def check_model_parts(entries: Mapping[str, bytes], start: str, found: BrokenRules) -> None:
    """Add the rules that the model parts of a package break.

    Parameters
    ----------
    entries
        Name -> contents of each entry of the package.
    start
        Name of the start part; its build is what is printed.
    found
        Collects what is broken.
    """
    names = sorted(
        (name for name in entries if name.lower().endswith(".model")), key=lambda name: name != start
    )
    parts = {name: _ModelPart(name, entries, found) for name in names}
    for name, part in parts.items():
        part.markup.read(entries[name])
    objects = {name: part.resources.objects for name, part in parts.items()}
    check_build(objects, {name: part.items for name, part in parts.items()}, start, found)


class _ModelPart:
    """Reads one model part."""

    def __init__(self, name: str, entries: Mapping[str, bytes], found: BrokenRules) -> None:
        self.markup = Markup(name, found, self._start, self._end, self._run)
        self.resources = ResourceRules(self.markup, entries)
        self.meshes = MeshRules(self.markup, self.resources)
        self.metadata = MetadataRules(self.markup)
        self.items: list[Component] = []

    def _start(self, key: str, attributes: Mapping[str, str]) -> None:
        if key in ("vertex", "triangle"):
            self.meshes.start(key, attributes)
        elif key == "model":
            self._check_extensions(attributes.get("requiredextensions", "").split())
        elif key.startswith("metadata"):
            self.metadata.start(key, attributes)
        elif key == "item":
            self.markup.place = f"{self.markup.name}, item {len(self.items) + 1}"
            self.items.append(
                Component(attributes.get("p:path", "").lstrip("/"), attributes.get("objectid", "").strip())
            )
        else:
            self.resources.start(key, attributes)

    def _end(self, key: str) -> None:
        if key == "mesh":
            self.meshes.end()
        elif key == "metadatagroup":
            self.metadata.end(key)
        elif key in ("object", "item"):
            self.markup.place = self.markup.name

    def _run(self, run: Run) -> None:
        self.meshes.run(run)

    def _check_extensions(self, prefixes: list[str]) -> None:
        """Refuse a file that requires what amprep does not read, as the specification demands of readers."""
        for prefix in prefixes:
            space = self.markup.prefixes.get(prefix)
            place = f"{self.markup.name}, requiredextensions {prefix[:40]!r}"
            if space is None:
                expected = "a required extension must be the prefix of a declared namespace"
                self.markup.add("3MF core 3.4", expected, touches_parts=True, place=place)
            elif space not in READ_EXTENSIONS:
                expected = f"a reader must know the extensions that a file requires; amprep does not know {space[:80]}"
                self.markup.add("3MF core 2.3.1", expected, touches_parts=True, place=place)
        self.meshes.may_be_empty = any(
            "beamlattice" in self.markup.prefixes.get(each, "") for each in prefixes
        )
