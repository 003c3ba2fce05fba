"""Rules of metadata: chapter 3.4.1 of the core specification."""

from collections.abc import Mapping

from amprep.threemf.rules.markup import Markup

RULE = "3MF core 3.4.1"

_NO_NAMES = frozenset({"", "undefined", "null", "none", "nan"})
"""What programs write where a name is missing."""


class MetadataRules:
    """Checks the names of the metadata of a model, an object or an item.

    A name without a namespace that the specification does not define is no fault here, since the same chapter asks
    readers to ignore names that they do not recognise.
    """

    def __init__(self, markup: Markup) -> None:
        self.markup = markup
        self._scopes: list[set[str]] = [set()]

    def start(self, key: str, attributes: Mapping[str, str]) -> None:
        """Check an element."""
        if key == "metadatagroup":
            self._scopes.append(set())
        elif "name" in attributes:
            self._check_name(attributes["name"].strip())

    def end(self, key: str) -> None:
        """Forget the names of a group at its end."""
        if key == "metadatagroup" and len(self._scopes) > 1:
            self._scopes.pop()

    def _check_name(self, name: str) -> None:
        prefix, colon, _ = name.rpartition(":")
        if name.lower() in _NO_NAMES:
            self._add("metadata must have a name", name)
        if colon and prefix not in self.markup.prefixes:
            self._add("the prefix of a metadata name must be declared", name)
        if name in self._scopes[-1]:
            self._add("names of metadata must differ", name)
        self._scopes[-1].add(name)

    def _add(self, expected: str, name: str) -> None:
        place = f"{self.markup.place}, metadata {name[:40]!r}"
        self.markup.add(RULE, expected, touches_parts=False, place=place)
