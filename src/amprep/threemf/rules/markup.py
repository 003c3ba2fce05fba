"""Rules of the markup of a model part: chapter 2.3 of the core specification, and its schema."""

import codecs
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from amprep.threemf.names import CORE_NAMESPACE
from amprep.threemf.rules.broken import BrokenRules
from amprep.threemf.rules.runs import RUN, Run, without_runs
from amprep.threemf.rules.schema import (
    DIALECT,
    ELEMENTS,
    PREFIXES,
    PRODUCTION_NAMESPACE,
    READ_EXTENSIONS,
    VALUES,
    Element,
)

_XML = "http://www.w3.org/XML/1998/namespace"
_XSI = "http://www.w3.org/2001/XMLSchema-instance"

Start = Callable[[str, Mapping[str, str]], None]


@dataclass
class _Frame:
    """An open element: its schema (None for one of another namespace) and how far its children have come."""

    key: str
    element: Element | None
    position: int = 0
    seen: dict[str, int] = field(default_factory=dict)


class Markup:
    """Parses a model part and checks each element against the schema.

    Runs of plain vertices and of plain triangles, nearly all of any file, never reach the parser: they are checked
    by one pattern and handed on as arrays, see `amprep.threemf.rules.runs`.

    Parameters
    ----------
    name
        Name of the part, for places.
    found
        Collects what is broken.
    start, end
        Called with each known element and its attributes, and with its end.
    run
        Called with each run.
    """

    def __init__(
        self,
        name: str,
        found: BrokenRules,
        start: Start,
        end: Callable[[str], None],
        run: Callable[[Run], None],
    ) -> None:
        self.name = name
        self.found = found
        self.prefixes: dict[str, str] = {}
        self.place = name
        """The innermost thing with a name that is open, for messages."""
        self._start, self._end, self._run = start, end, run
        self._frames: list[_Frame] = []
        self._runs: dict[str, Run] = {}
        self._parser = expat.ParserCreate(namespace_separator=" ")
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._open
        self._parser.EndElementHandler = self._close
        self._parser.CharacterDataHandler = self._text
        self._parser.XmlDeclHandler = self._declared
        self._parser.StartNamespaceDeclHandler = self._declare

    def read(self, content: bytes) -> None:
        """Check a whole part."""
        if content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            self._declared("", "utf-16", 0)
        try:
            for text, self._runs in without_runs(content):
                self._parser.Parse(text, False)
            self._parser.Parse(b"", True)
        except (expat.ExpatError, ValueError, LookupError) as error:
            self.add(
                "3MF core 2.3.3.1", f"the markup must use declared namespaces ({error})", touches_parts=True
            )

    def add(self, rule: str, expected: str, *, touches_parts: bool, place: str = "") -> None:
        """Add a finding at the present place."""
        self.found.add(rule, expected, place or self.place, touches_parts=touches_parts)

    def _declared(self, _: str, encoding: str | None, __: int) -> None:
        if encoding is not None and encoding.lower() != "utf-8":
            self.add("3MF core 2.3.2", "XML must be encoded as UTF-8", touches_parts=True)

    def _declare(self, prefix: str | None, uri: str) -> None:
        self.prefixes[prefix or ""] = uri

    def _open(self, name: str, attributes: dict[str, str]) -> None:
        run = self._runs.pop(attributes[RUN], None) if RUN in attributes else None
        if run is not None and self._frames:
            self._count_child(run.key, run.length)
            self._frames.append(_Frame("", None))
            self._run(run)
            return
        key = _key(name)
        element = ELEMENTS.get(key)
        self._check_place(key, name)
        self._frames.append(_Frame(key, element))
        if element is None:
            self._check_foreign(attributes)
            return
        plain = {_plain(each): value for each, value in attributes.items() if _is_plain(each)}
        path = attributes.get(f"{PRODUCTION_NAMESPACE} path")
        self._start(key, plain if path is None else {**plain, "p:path": path})
        self._check_attributes(key, element, attributes, plain)

    def _close(self, _: str) -> None:
        frame = self._frames.pop()
        if frame.element is None:
            return
        for child in frame.element.children:
            name = child.rstrip("?*+")
            if child[-1] not in "?*" and name not in frame.seen:
                missing = ELEMENTS[name].touches_parts and frame.element.touches_parts
                expected = f"the {frame.key} element must contain {_article(name)}"
                self.add(frame.element.rule, expected, touches_parts=missing)
        self._end(frame.key)

    def _text(self, data: str) -> None:
        frame = self._frames[-1] if self._frames else None
        if frame and frame.element and not frame.element.text and not data.isspace():
            self.add("3MF core 2.3.3", "only metadata elements may contain text", touches_parts=False)

    def _check_place(self, key: str, name: str) -> None:
        """Check that an element may be where it is."""
        if not self._frames:
            if key != "model":
                self.add(
                    "3MF core 3.4", "the root of a model part must be a model element", touches_parts=True
                )
            return
        parent = self._frames[-1]
        if parent.element is None:
            return
        if key in ELEMENTS and (parent.key != "resources" or not key.startswith("m:")):
            self._count_child(key, 1)
        elif key not in ELEMENTS and (_is_core(name) or not parent.element.open_children):
            expected = f"the {parent.key} element may not contain {_article(_shown(name))}"
            touches = parent.element.touches_parts and _is_core(name)
            self.add("3MF core 2.3.2", expected, touches_parts=touches)

    def _count_child(self, key: str, count: int) -> None:
        """Check number and order of the known children of the innermost element."""
        parent = self._frames[-1]
        if parent.element is None:
            return
        names = [child.rstrip("?*+") for child in parent.element.children]
        if key not in names:
            expected = f"the {parent.key} element may not contain {_article(key)}"
            self.add("3MF core 2.3.2", expected, touches_parts=ELEMENTS[key].touches_parts)
            return
        position = names.index(key)
        if position < parent.position:
            expected = f"{key} elements must be before {names[parent.position]} elements"
            self.add(parent.element.rule, expected, touches_parts=False)
        parent.position = max(parent.position, position)
        parent.seen[key] = parent.seen.get(key, 0) + count
        if parent.seen[key] > 1 and parent.element.children[position][-1] not in "*+":
            expected = f"the {parent.key} element must contain only one {key} element"
            self.add(parent.element.rule, expected, touches_parts=ELEMENTS[key].touches_parts)

    def _check_attributes(
        self, key: str, element: Element, attributes: Mapping[str, str], plain: Mapping[str, str]
    ) -> None:
        for name, attribute in element.attributes.items():
            value = plain.get(name)
            if value is None:
                if attribute.required:
                    expected = f"the {key} element must have the attribute {name}"
                    self.add(element.rule, expected, touches_parts=attribute.touches_parts)
            elif not VALUES[attribute.kind][0](value):
                expected = f"{name} must be {VALUES[attribute.kind][1]}"
                place = f"{self.place}, {name}={value[:40]!r}"
                self.add(element.rule, expected, touches_parts=attribute.touches_parts, place=place)
        for name in plain:
            if name not in element.attributes:
                expected = f"the {key} element may not have the attribute {name[:40]}"
                known = (key, name) in DIALECT
                self.add("3MF core 2.3.2", expected, touches_parts=element.touches_parts and not known)
        self._check_foreign(attributes, open_attributes=element.open_attributes)

    def _check_foreign(self, attributes: Mapping[str, str], *, open_attributes: bool = True) -> None:
        """Check attributes with a namespace: only the language of ``xml``, none of ``xsi``, others where allowed."""
        for name in attributes:
            space, _, local = name.rpartition(" ")
            if space == _XML and local == "space":
                self.add("3MF core 2.3.4", "the attribute xml:space may not be used", touches_parts=False)
            elif space == _XSI or (space == _XML and local != "lang"):
                expected = "attributes of the namespaces xml and xsi may not be used"
                self.add("3MF core 2.3.2", expected, touches_parts=False)
            elif space and not open_attributes and space not in READ_EXTENSIONS and space != _XML:
                expected = f"{self._frames[-1].key} elements may not have attributes of unknown namespaces"
                self.add("3MF core 2.3.2", expected, touches_parts=False)


def _key(name: str) -> str:
    """Return the key of an element in `ELEMENTS`, or a name that is not in it."""
    space, _, local = name.rpartition(" ")
    return f"{PREFIXES[space]}{local}" if space in PREFIXES and ":" not in local else ""


def _is_core(name: str) -> bool:
    """Tell whether an element is in the core namespace, or in none."""
    return name.rpartition(" ")[0] in ("", CORE_NAMESPACE)


def _is_plain(name: str) -> bool:
    """Tell whether an attribute belongs to its element: without a namespace, or the language."""
    return " " not in name or name == f"{_XML} lang"


def _plain(name: str) -> str:
    return "xml:lang" if " " in name else name


def _shown(name: str) -> str:
    return name.rpartition(" ")[2][:40]


def _article(name: str) -> str:
    return f"a{'n' if name[:1] in 'aeiou' else ''} {name} element"
