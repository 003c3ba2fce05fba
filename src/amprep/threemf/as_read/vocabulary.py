"""Find what no build file has: elements, attributes and values of the model that amprep never writes.

Extensions of 3MF, and the programs that read it, attach instructions to objects and triangles: painted supports, slices
in place of meshes, geometry in another part of the package. Whoever reads only the geometry does not see them.
"""

from collections.abc import Mapping
from xml.parsers import expat

from amprep.threemf.names import BEAM_NAMESPACE, CORE_NAMESPACE
from amprep.threemf.rules.runs import RUN, without_runs
from amprep.threemf.rules.schema import ELEMENTS, PRODUCTION_NAMESPACE, VALUES

_MATERIALS = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
_XML = "http://www.w3.org/XML/1998/namespace"
_PREFIXES = {
    CORE_NAMESPACE: "",
    BEAM_NAMESPACE: "b:",
    _MATERIALS: "m:",
    PRODUCTION_NAMESPACE: "p:",
    _XML: "xml:",
}
_MOST = 5
"""Different things that are named."""

_UUID = frozenset({"p:UUID"})
_WRITTEN: Mapping[str, frozenset[str]] = {
    "model": frozenset({"unit", "xml:lang", "requiredextensions"}),
    "metadata": frozenset({"name", "preserve", "type"}),
    "metadatagroup": frozenset(),
    "resources": frozenset(),
    "basematerials": frozenset({"id"}),
    "base": frozenset({"name", "displaycolor"}),
    "m:colorgroup": frozenset({"id"}),
    "m:color": frozenset({"color"}),
    "object": frozenset({"id", "name", "type", "partnumber", "pid", "pindex"}) | _UUID,
    "mesh": frozenset(),
    "vertices": frozenset(),
    "vertex": frozenset("xyz"),
    "triangles": frozenset(),
    "triangle": frozenset({"v1", "v2", "v3", "pid", "p1", "p2", "p3"}),
    "components": frozenset(),
    "component": frozenset({"objectid", "transform"}) | _UUID,
    "build": _UUID,
    "item": frozenset({"objectid", "transform", "partnumber", "printable"}) | _UUID,
    "b:beamlattice": frozenset(
        {"radius", "minlength", "clippingmode", "clippingmesh", "representationmesh", "cap"}
    ),
    "b:beams": frozenset(),
    "b:beam": frozenset({"v1", "v2", "r1", "r2"}),
}
"""Element -> attributes that amprep writes, and `printable`, which the readers judge."""


class _ForeignMarkup:
    """Collects elements, attributes and values that are not in `_WRITTEN`."""

    def __init__(self) -> None:
        self.found: dict[str, None] = {}
        self._parser = expat.ParserCreate(namespace_separator=" ")
        self._parser.StartElementHandler = self._open

    def read(self, content: bytes) -> None:
        for text, _ in without_runs(content):
            self._parser.Parse(text, False)
        self._parser.Parse(b"", True)

    def _open(self, name: str, attributes: dict[str, str]) -> None:
        key = _short(name)
        known = _WRITTEN.get(key)
        if known is None:
            self._add(f"the element {key}")
            return
        schema = ELEMENTS[key].attributes if key in ELEMENTS else {}
        for full, value in attributes.items():
            attribute = _short(full)
            if attribute not in known and attribute != RUN:
                self._add(f"the attribute {attribute} of {key}")
            elif attribute in schema and not VALUES[schema[attribute].kind][0](value):
                self._add(f"{attribute}={value[:20]!r} of {key}")

    def _add(self, what: str) -> None:
        if len(self.found) < _MOST:
            self.found[what[:80]] = None


def foreign_words(model: bytes) -> tuple[str, ...]:
    """Return what a model has that no build file has, in words, up to five different things.

    Parameters
    ----------
    model
        Text of the model. Time and memory are proportional to its size.

    Raises
    ------
    ValueError
        If the model is not well-formed.
    """
    markup = _ForeignMarkup()
    try:
        markup.read(model)
    except (expat.ExpatError, LookupError) as error:
        raise ValueError(str(error)) from None
    return tuple(markup.found)


def _short(name: str) -> str:
    """Return a name with the usual prefix of its namespace."""
    space, _, local = name.rpartition(" ")
    return f"{_PREFIXES[space]}{local}" if space in _PREFIXES else f"{{{space}}}{local}" if space else local
