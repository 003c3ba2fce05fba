"""Scan the XML parts of a package before lib3mf reads them: no DTD, limited depth, size and references."""

import re
from dataclasses import dataclass, field
from typing import NamedTuple
from xml.parsers import expat

from amprep.errors import InputError

MOST_DEPTH = 64
"""Deepest nesting of XML elements."""
MOST_ELEMENTS = 120_000_000
"""About 50 million triangles with their vertices; a build of metal parts has a hundredth of that."""
MOST_INSTANCES = 100_000
MOST_NESTING = 64
"""Deepest nesting of components."""

_LEAF = rb'<(?:\w+:)?(?:vertex|triangle)(?:\s+[\w:]+="[^"<>]*")*\s*/>\s*'
_USUAL_LEAVES = (
    rb'<vertex x="[^"<>]*" y="[^"<>]*" z="[^"<>]*"\s?/>\s*',
    rb'<triangle v1="[^"<>]*" v2="[^"<>]*" v3="[^"<>]*"\s?/>\s*',
)
_LEAVES = re.compile(rb"(?:" + rb"|".join((*_USUAL_LEAVES, _LEAF)) + rb"){1,1000}")
"""Plain vertices and triangles, at most so many that the match needs little memory.

The usual spellings are special cases of the general one; without a loop over attributes they match twice as fast.
Possessive groups would need none, but Python 3.11.2 matches them wrongly.
"""
_LONGEST_BUFFER = 1 << 24

ObjectKey = tuple[str, str]
"""(model part, object id)."""


@dataclass
class Outline:
    """The references in a model part.

    Attributes
    ----------
    uses
        Object id -> the objects of its components; an empty model part means the same part.
    items
        The object of each build item.
    unprintable
        Indices into `items` of those marked ``printable="0"``, as PrusaSlicer does.
    """

    uses: dict[str, list[ObjectKey]] = field(default_factory=dict)
    items: list[ObjectKey] = field(default_factory=list)
    unprintable: set[int] = field(default_factory=set)


class Scanner:
    """Takes an XML part in chunks, refuses hostile content and collects the outline.

    Runs of plain vertices and triangles make up nearly all of any file, and the parser would spend most of
    its time on them. A thousand are replaced by one empty element before the parser sees them.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self.outline = Outline()
        self.elements = 0
        self._depth = 0
        self._object = ""
        self._held = b""
        self._parser = expat.ParserCreate()
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end

    def feed(self, chunk: bytes) -> None:
        """Take the next bytes of the part."""
        buffer = self._held + chunk
        cut = buffer.rfind(b"<") if len(buffer) < _LONGEST_BUFFER else len(buffer)
        self._held = buffer[cut:]
        self._parse(buffer[:cut], final=False)

    def close(self) -> Outline:
        """Finish the part and return its outline."""
        self._parse(self._held, final=True)
        return self.outline

    def _parse(self, chunk: bytes, *, final: bool) -> None:
        self.elements += chunk.count(b"<")
        if self.elements > MOST_ELEMENTS:
            raise InputError(f"{self.where}: expected at most {MOST_ELEMENTS} XML elements; split the job")
        try:
            self._parser.Parse(_LEAVES.sub(b"<vertex/>", chunk), final)
        except (expat.ExpatError, ValueError, LookupError) as error:
            raise InputError(f"{self.where}: not well-formed XML ({error}); the file is damaged") from error

    def _refuse_doctype(self, *_: object) -> None:
        raise InputError(f"{self.where}: contains a document type definition, which 3MF forbids; refused")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        if self._depth > MOST_DEPTH:
            raise InputError(f"{self.where}: XML is nested deeper than {MOST_DEPTH} levels; refused")
        local = name.rpartition(":")[2]
        if local == "object":
            self._object = attributes.get("id", "")
            self.outline.uses.setdefault(self._object, [])
        elif local == "component":
            self.outline.uses.setdefault(self._object, []).append(_target(attributes))
        elif local == "item":
            if attributes.get("printable") == "0":
                self.outline.unprintable.add(len(self.outline.items))
            self.outline.items.append(_target(attributes))

    def _end(self, _: str) -> None:
        self._depth -= 1


def check_instances(outlines: dict[str, Outline], where: str) -> None:
    """Refuse objects that contain themselves, and builds of more than `MOST_INSTANCES` instances.

    Parameters
    ----------
    outlines
        Name of each model part in the package -> its outline.
    where
        Name of the file, for messages.

    Raises
    ------
    InputError
        If components refer to each other in a circle or are nested too deeply, or for too many instances.
    """
    graph = {
        (part, name): [(target or part, used) for target, used in uses]
        for part, outline in outlines.items()
        for name, uses in outline.uses.items()
    }
    known: dict[ObjectKey, _Tree] = {}
    for start in graph:
        _measure(start, graph, known, where)
    deepest = max((tree.depth for tree in known.values()), default=0)
    if deepest > MOST_NESTING:
        raise InputError(f"{where}: components nested {deepest} deep, at most {MOST_NESTING} are read")
    items = [(target or part, used) for part, outline in outlines.items() for target, used in outline.items]
    total = sum(known[item].instances for item in items if item in known)
    if total > MOST_INSTANCES:
        raise InputError(
            f"{where}: the build has {total} instances of objects, at most {MOST_INSTANCES} are read"
        )


class _Tree(NamedTuple):
    """Number of instances and depth of the component tree below an object, itself included."""

    instances: int
    depth: int


def _measure(
    start: ObjectKey, graph: dict[ObjectKey, list[ObjectKey]], known: dict[ObjectKey, _Tree], where: str
) -> None:
    """Add the trees of an object and of everything below it to `known`, depth first without recursion."""
    stack, ancestors = [start], set[ObjectKey]()
    while stack:
        here = stack[-1]
        unknown = [used for used in graph.get(here, ()) if used not in known]
        if any(used in ancestors or used == here for used in unknown):
            raise InputError(f"{where}: object {here[1]} contains itself")
        if unknown:
            ancestors.add(here)
            stack.extend(unknown)
        else:
            trees = [known[used] for used in graph.get(here, ())]
            instances = min(1 + sum(tree.instances for tree in trees), 1 << 62)
            known[here] = _Tree(instances, 1 + max((tree.depth for tree in trees), default=0))
            ancestors.discard(here)
            stack.pop()


def _target(attributes: dict[str, str]) -> ObjectKey:
    """Return the object that an item or component refers to; its path is the production extension's."""
    path = next((value for key, value in attributes.items() if key.rpartition(":")[2] == "path"), "")
    return path.lstrip("/"), attributes.get("objectid", "")
