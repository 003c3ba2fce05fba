"""Check that an offer is well-formed, and list it with its origin."""

import re
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from typing import Any, Final, Generic, Literal, TypeVar

from amprep.hookspecs import CellEmitter, MeshReader, Offer, Packer, SupportRouter, VolumeMaker
from amprep.model.bounding_volume import Boxes, ConvexPieces, Solid, TurnedVolume
from amprep.model.cells import Cells
from amprep.model.packing import Packing
from amprep.model.supports import SupportPlan
from amprep.typed import field_types

Kind = Literal["reader", "volume", "packer", "router", "cell"]
OfferT_co = TypeVar("OfferT_co", bound=Offer, covariant=True)


@dataclass(frozen=True)
class KindOfOffer:
    """A kind of offer: its hook, its record, its name for messages, and the result types of its `run`."""

    hook: str
    record: type[Any]
    noun: str
    result: tuple[type[Any], ...]


KINDS: Final[Mapping[Kind, KindOfOffer]] = {
    "reader": KindOfOffer("amprep_mesh_readers", MeshReader, "mesh reader", (list,)),
    "volume": KindOfOffer(
        "amprep_volume_makers", VolumeMaker, "volume maker", (Boxes, ConvexPieces, Solid, TurnedVolume)
    ),
    "packer": KindOfOffer("amprep_packers", Packer, "packer", (Packing,)),
    "router": KindOfOffer("amprep_support_routers", SupportRouter, "support router", (SupportPlan,)),
    "cell": KindOfOffer("amprep_cell_emitters", CellEmitter, "lattice cell", (Cells,)),
}

VOLUME_WORDS = frozenset({"box", "boxes", "convex", "solid"})
OBJECTIVE_WORDS = frozenset({"fill", "builds", "height"})
ORIENTATION_WORDS = frozenset({"fixed", "axis", "list", "about-z", "free"})
_NAME = re.compile(r"[a-z0-9][a-z0-9_.-]*")


@dataclass(frozen=True)
class Listed(Generic[OfferT_co]):
    """An offer and its origin.

    Attributes
    ----------
    plugin
        Name of the plugin: its entry point, or its module.
    distribution, version
        Installed package of the plugin; empty for a module given with ``-p``.
    """

    kind: Kind
    offer: OfferT_co
    plugin: str
    distribution: str = ""
    version: str = ""
    builtin: bool = False

    @property
    def origin(self) -> str:
        """Origin for messages: ``amprep-shelves 1.2``, or ``module my_packer``."""
        return f"{self.distribution} {self.version}" if self.distribution else f"module {self.plugin}"

    @property
    def title(self) -> str:
        """Title for messages: ``packer 'shelves' of amprep-shelves 1.2``."""
        return f"{KINDS[self.kind].noun} {self.offer.name!r} of {self.origin}"


def faults_of(kind: Kind, offer: Any) -> list[str]:
    """Return the faults of an offer of a kind, one sentence each; an empty list for a well-formed offer."""
    wanted = KINDS[kind]
    if not isinstance(offer, wanted.record):
        return [f"{wanted.hook} yields {wanted.record.__name__} records, got {type(offer).__name__}"]
    found = [*_naming(offer), *_params(offer.params)]
    if not callable(offer.run):
        found.append(f"run must be callable, got {type(offer.run).__name__}")
    return [f"{wanted.noun} {offer.name!r}: {fault}" for fault in [*found, *_particular(offer)]]


def _naming(offer: Any) -> list[str]:
    found = []
    if not isinstance(offer.name, str) or not _NAME.fullmatch(offer.name):
        found.append("a name must consist of lower-case letters, digits, '-', '_' and '.'")
    if not isinstance(offer.summary, str) or not offer.summary.strip() or "\n" in offer.summary:
        found.append("a summary must be one line of text")
    return found


def _params(params: Any) -> list[str]:
    if not isinstance(params, type) or not is_dataclass(params):
        return [f"params must be a dataclass, got {params!r}"]
    if not params.__dataclass_params__.frozen:  # type: ignore[attr-defined]
        return [f"params class {params.__name__} must be frozen: @dataclass(frozen=True)"]
    missing = [field.name for field in fields(params) if field.init and not _has_default(field)]
    if missing:
        return [f"every parameter must have a default; these have none: {', '.join(missing)}"]
    try:
        field_types(params)
    except (TypeError, NameError) as error:
        return [f"params class {params.__name__}: {error}"]
    try:
        params()
    except ValueError as error:
        return [f"the defaults of {params.__name__} are out of its own bounds: {error}"]
    return []


def _has_default(field: Field[Any]) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def _particular(offer: Any) -> list[str]:
    if isinstance(offer, MeshReader):
        return _suffixes(offer.suffixes)
    if isinstance(offer, VolumeMaker) and offer.makes not in VOLUME_WORDS:
        return [f"makes must be one of {_words(VOLUME_WORDS)}, got {offer.makes!r}"]
    if isinstance(offer, Packer):
        accepts = offer.accepts
        return [
            *_unknown("volumes", accepts.volumes, VOLUME_WORDS),
            *_unknown("objectives", accepts.objectives, OBJECTIVE_WORDS),
            *_unknown("orientations", accepts.orientations, ORIENTATION_WORDS),
            *_unknown("stacking", accepts.stacking, frozenset({True, False})),
            *_default_volumes(offer.volumes),
        ]
    material = offer.material if isinstance(offer, CellEmitter) else None
    return [] if material is None or callable(material) else ["material must be a function or None"]


def _default_volumes(name: Any) -> list[str]:
    valid = isinstance(name, str) and _NAME.fullmatch(name)
    return [] if valid else [f"volumes must be the name of a volume maker, got {name!r}"]


def _suffixes(suffixes: Any) -> list[str]:
    if not isinstance(suffixes, tuple) or not suffixes:
        return ["suffixes must be a tuple of at least one suffix"]
    wrong = [s for s in suffixes if not isinstance(s, str) or not s.startswith(".") or s != s.lower()]
    return [f"suffixes must be lower case and start with a dot, got {wrong}"] if wrong else []


def _unknown(name: str, given: Any, known: frozenset[Any]) -> list[str]:
    if not isinstance(given, frozenset | set) or not given:
        return [f"accepts.{name} must be a set of at least one of {_words(known)}, got {given!r}"]
    return (
        [f"accepts.{name} must be among {_words(known)}, got {_words(given - known)}"]
        if given - known
        else []
    )


def _words(values: frozenset[Any] | set[Any]) -> str:
    return ", ".join(sorted(map(str, values)))
