"""Rules of resources: chapters 3.4.2, 4 and 5 of the core specification, and the materials extension."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from amprep.threemf.rules.markup import Markup
from amprep.threemf.rules.schema import is_index

_GROUPS = {
    "basematerials": "base",
    "m:colorgroup": "m:color",
    "m:texture2dgroup": "m:tex2coord",
    "m:compositematerials": "m:composite",
    "m:multiproperties": "m:multi",
}
"""Groups of properties -> their members."""

_MATERIALS = ("basematerials", "m:compositematerials")


class Component(NamedTuple):
    """A component: the model part (empty for its own) and the id of the object that it places."""

    part: str
    object_id: str


@dataclass
class ObjectFacts:
    """What other elements need to know of an object."""

    object_type: str
    components: list[Component] = field(default_factory=list)


class ResourceRules:
    """Checks the resources of a model part in their order, each against those before it.

    Attributes
    ----------
    objects
        Id -> facts of the objects so far.
    groups
        Id -> kind and number of properties of the groups of properties so far.
    """

    def __init__(self, markup: Markup, entries: Mapping[str, bytes]) -> None:
        self.markup = markup
        self.objects: dict[str, ObjectFacts] = {}
        self.groups: dict[str, tuple[str, int]] = {}
        self.current: ObjectFacts = ObjectFacts("model")
        self.default_group = ""
        """Group of the properties of the current object."""
        self._kinds: dict[str, str] = {}
        self._names = {name.lower() for name in entries}
        self._open_group = ""

    def start(self, key: str, attributes: Mapping[str, str]) -> None:
        """Check an element that is no metadata, no item and no part of a mesh."""
        if key in _GROUPS:
            self._start_group(key, attributes)
        elif key in _GROUPS.values() and self._open_group:
            kind, count = self.groups[self._open_group]
            self.groups[self._open_group] = (kind, count + 1)
        elif key == "m:texture2d":
            self._start_texture(attributes)
        elif key == "object":
            self._start_object(attributes)
        elif key == "component":
            self._start_component(attributes)

    def check_property(self, group: str, index: str, where: str) -> None:
        """Check that a property exists, where an object or a triangle refers to it."""
        known = self.groups.get(group)
        if known is None:
            self._add(where, "pid must name a group of properties that is defined before", group)
        elif is_index(index) and int(index) >= known[1]:
            self._add(where, "indices of properties must be below the number of properties", index)

    def _enter(self, key: str, attributes: Mapping[str, str], *, touches_parts: bool) -> str:
        """Return the id of a resource after a check that no other one has it."""
        identifier = attributes.get("id", "").strip()
        if identifier in self._kinds:
            both_objects = touches_parts and self._kinds[identifier] == "object"
            expected = "ids of resources must differ"
            self.markup.add(
                "3MF core 3.4.2",
                expected,
                touches_parts=both_objects,
                place=f"{self.markup.name}, id {identifier[:12]}",
            )
        self._kinds[identifier] = key
        return identifier

    def _start_group(self, key: str, attributes: Mapping[str, str]) -> None:
        identifier = self._enter(key, attributes, touches_parts=False)
        self.markup.place = f"{self.markup.name}, {key} {identifier[:12]}"
        self._open_group = identifier
        texture = attributes.get("texid", "").strip()
        if key == "m:texture2dgroup" and self._kinds.get(texture) != "m:texture2d":
            self._add("3MF materials 3", "texid must name a texture that is defined before", texture)
        if key == "m:compositematerials":
            self._check_composite(attributes)
        if key == "m:multiproperties":
            self._check_multiproperties(attributes.get("pids", "").split())
        self.groups[identifier] = (key, 0)

    def _check_composite(self, attributes: Mapping[str, str]) -> None:
        kind, count = self.groups.get(attributes.get("matid", "").strip(), ("", 0))
        if kind != "basematerials":
            self._add(
                "3MF materials 4", "matid must name a group of base materials", attributes.get("matid", "")
            )
        elif any(is_index(word) and int(word) >= count for word in attributes.get("matindices", "").split()):
            self._add("3MF materials 4", "matindices must be below the number of materials", "")

    def _check_multiproperties(self, groups: list[str]) -> None:
        kinds = [self._kinds.get(group, "") for group in groups]
        materials = [position for position, kind in enumerate(kinds) if kind in _MATERIALS]
        for wrong, expected in (
            ("" in kinds, "pids must name resources that are defined before"),
            ("m:multiproperties" in kinds, "pids may not name other multiproperties"),
            (kinds.count("m:colorgroup") > 1, "pids may name only one group of colours"),
            (len(materials) > 1, "pids may name only one group of materials"),
            (any(materials), "a group of materials must be the first of the pids"),
        ):
            if wrong:
                self._add("3MF materials 5", expected, " ".join(groups)[:40])

    def _start_texture(self, attributes: Mapping[str, str]) -> None:
        identifier = self._enter("m:texture2d", attributes, touches_parts=False)
        path = attributes.get("path", "")
        if path.startswith("/") and path[1:].lower() not in self._names:
            expected = "the path of a texture must be in the package"
            self._add("3MF materials 6", expected, f"texture {identifier[:12]}, {path}")

    def _start_object(self, attributes: Mapping[str, str]) -> None:
        identifier = self._enter("object", attributes, touches_parts=True)
        self.markup.place = f"{self.markup.name}, object {identifier[:12]}"
        self.current = self.objects[identifier] = ObjectFacts(attributes.get("type", "model"))
        self._open_group = ""
        self.default_group = attributes.get("pid", "").strip()
        if "pindex" in attributes and not self.default_group:
            self._add("3MF core 4", "an object with pindex must have pid", "")
        if self.default_group:
            self.check_property(self.default_group, attributes.get("pindex", ""), "3MF core 4")
        thumbnail = attributes.get("thumbnail", "")
        if thumbnail.startswith("/") and thumbnail[1:].lower() not in self._names:
            self._add("3MF core 4", "the thumbnail of an object must be in the package", thumbnail)

    def _start_component(self, attributes: Mapping[str, str]) -> None:
        component = Component(
            attributes.get("p:path", "").lstrip("/"), attributes.get("objectid", "").strip()
        )
        self.current.components.append(component)
        if not component.part and component.object_id not in self.objects:
            expected = "a component must name an object that is defined before"
            place = f"{self.markup.place}, objectid {component.object_id[:12]}"
            self.markup.add("3MF core 4.2.1", expected, touches_parts=True, place=place)

    def _add(self, rule: str, expected: str, detail: str) -> None:
        """Add a finding about properties or images."""
        place = f"{self.markup.place}, {detail}" if detail else self.markup.place
        self.markup.add(rule, expected, touches_parts=False, place=place)
