"""Look through XML parts of a package before lib3mf does: no DTD, bounded depth and size; who uses whom."""

import re
from dataclasses import dataclass, field
from typing import NamedTuple
from xml.parsers import expat

from amprep.errors import InputError

MOST_DEPTH = 64
MOST_ELEMENTS = 120_000_000
"""About 50 million triangles with their vertices; a build of metal parts has a hundredth of that."""
MOST_INSTANCES = 100_000
MOST_NESTING = 64

_LEAF = rb'<(?:\w++:)?(?:vertex|triangle)(?:\s++[\w:]++="[^"<>]*+")*+\s*+/>\s*+'
_LEAVES = re.compile(rb"(?>(?:" + _LEAF + rb")++)")
_LONGEST_PIECE = 1 << 24


@dataclass
class Outline:
    """What a model part holds, apart from vertices and triangles.

    Attributes
    ----------
    uses
        Object id -> the objects its components name, as (model part, id); part "" is the same one.
    items
        What the build asks for, as (model part, id).
    unprintable
        Indices into `items` of those marked ``printable="0"``, as PrusaSlicer does.
    """

    uses: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    items: list[tuple[str, str]] = field(default_factory=list)
    unprintable: set[int] = field(default_factory=set)


class Scanner:
    """Takes an XML part piece by piece, refuses what is hostile, and draws up its outline.

    Runs of plain vertices and triangles, nearly all of any file, are cut down to one empty element before
    the parser sees them: the parser would spend most of its time on them.
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

    def feed(self, piece: bytes) -> None:
        """Take the next bytes of the part."""
        whole = self._held + piece
        cut = whole.rfind(b"<") if len(whole) < _LONGEST_PIECE else len(whole)
        self._held = whole[cut:]
        self._parse(whole[:cut], final=False)

    def close(self) -> Outline:
        """Take the end of the part, and return its outline."""
        self._parse(self._held, final=True)
        return self.outline

    def _parse(self, piece: bytes, *, final: bool) -> None:
        self.elements += piece.count(b"<")
        if self.elements > MOST_ELEMENTS:
            raise InputError(f"{self.where}: more than {MOST_ELEMENTS} XML elements; split the job")
        try:
            self._parser.Parse(_LEAVES.sub(b"<vertex/>", piece), final)
        except (expat.ExpatError, ValueError, LookupError) as error:
            raise InputError(f"{self.where}: not well-formed XML ({error}); the file is damaged") from error

    def _refuse_doctype(self, *_: object) -> None:
        raise InputError(
            f"{self.where}: has a document type definition, which 3MF forbids and amprep refuses"
        )

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        if self._depth > MOST_DEPTH:
            raise InputError(f"{self.where}: XML nested deeper than {MOST_DEPTH} levels")
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
        Of each model part by its name in the package.
    """
    graph = {
        (part, name): [(target or part, used) for target, used in uses]
        for part, outline in outlines.items()
        for name, uses in outline.uses.items()
    }
    known: dict[Key, _Tree] = {}
    for start in graph:
        _measure(start, graph, known, where)
    deepest = max((tree.depth for tree in known.values()), default=0)
    if deepest > MOST_NESTING:
        raise InputError(f"{where}: components nested {deepest} deep, at most {MOST_NESTING} are read")
    items = [(target or part, used) for part, outline in outlines.items() for target, used in outline.items]
    total = sum(known[item].instances for item in items if item in known)
    if total > MOST_INSTANCES:
        raise InputError(
            f"{where}: the build asks for {total} instances of objects, at most {MOST_INSTANCES}"
        )


Key = tuple[str, str]
"""(model part, object id)."""


class _Tree(NamedTuple):
    instances: int
    depth: int


def _measure(start: Key, graph: dict[Key, list[Key]], known: dict[Key, _Tree], where: str) -> None:
    """Measure what an object stands for: what it uses first, without recursion."""
    waiting, ancestors = [start], set[Key]()
    while waiting:
        here = waiting[-1]
        unknown = [used for used in graph.get(here, ()) if used not in known]
        if any(used in ancestors or used == here for used in unknown):
            raise InputError(f"{where}: object {here[1]} contains itself")
        if unknown:
            ancestors.add(here)
            waiting.extend(unknown)
        else:
            trees = [known[used] for used in graph.get(here, ())]
            instances = min(1 + sum(tree.instances for tree in trees), 1 << 62)
            known[here] = _Tree(instances, 1 + max((tree.depth for tree in trees), default=0))
            ancestors.discard(here)
            waiting.pop()


def _target(attributes: dict[str, str]) -> Key:
    """Return (model part, id) an item or component names; the path is the production extension's."""
    path = next((value for key, value in attributes.items() if key.rpartition(":")[2] == "path"), "")
    return path.lstrip("/"), attributes.get("objectid", "")
