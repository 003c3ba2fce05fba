"""A plugin of Cura: prepare the models on the plate with amprep.

Cura 4.13 and 5 load this folder. Only `extension`, `dialog` and this file import modules of Cura or of Qt.
The code must run on Python 3.8, which Cura 4.13 contains.
"""

from __future__ import annotations

from typing import Any


def getMetaData() -> dict[str, Any]:  # noqa: N802 - Cura looks for this name
    """Return no metadata beyond that in ``plugin.json``."""
    return {}


def register(app: Any) -> dict[str, Any]:
    """Return what the plugin adds to Cura: an entry in the menu of extensions."""
    from .extension import AmprepExtension

    return {"extension": AmprepExtension(app)}
