"""Parse small XML parts of a package safely: no entities, no network."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lxml.etree import _Element


def parse_xml(content: bytes) -> "_Element":
    """Return the root element of an XML part.

    Raises
    ------
    ValueError
        If the content is not well-formed.
    """
    from lxml import etree

    try:
        return etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise ValueError(str(error)) from None
