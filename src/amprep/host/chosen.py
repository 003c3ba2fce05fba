"""An offer that was chosen by name, with its checked parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, Self

from amprep.host.manager import Host
from amprep.host.offers import Kind, Listed, OfferT_co


@dataclass(frozen=True, eq=False)
class Chosen(Generic[OfferT_co]):
    """An offer and its checked parameters, ready to be called.

    Attributes
    ----------
    host
        Host that guards every call.
    listed
        The offer, and the plugin or file that it comes from.
    params
        Instance of the parameter class of the offer.
    """

    host: Host
    listed: Listed[OfferT_co]
    params: Any

    @classmethod
    def of(cls, host: Host, listed: Listed[OfferT_co], table: Mapping[str, Any]) -> Self:
        """Check the parameters in `table` and return the offer with them.

        Raises
        ------
        JobError
            When a parameter is unknown or has a wrong value.
        """
        return cls(host, listed, host.params(listed, table))

    @property
    def name(self) -> str:
        """Name of the offer."""
        return self.listed.offer.name

    def call(self, *args: Any, **kwargs: Any) -> Any:
        """Run the offer with its parameters and return its result, as `Host.call` does."""
        listed: Listed[Any] = self.listed
        return self.host.call(listed, *args, params=self.params, **kwargs)


def choose(host: Host, kind: Kind, name: str, table: Mapping[str, Any]) -> Chosen[Any]:
    """Return the offer of a kind that is called `name`, with parameters made from a table of plain values.

    Raises
    ------
    PluginError
        When there is no such offer, or several plugins offer it.
    JobError
        When a parameter is unknown or has a wrong value.
    """
    return Chosen.of(host, host.choose(kind, name), table)
