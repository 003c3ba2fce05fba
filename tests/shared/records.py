"""Compare records with arrays in them."""

import dataclasses
from collections.abc import Mapping
from dataclasses import fields

import numpy as np

MODEL = "3D/3dmodel.model"
"""The part of a 3MF package with the objects."""


def differences(one, other, where="build"):
    """Return where two records differ by more than the rounding to float32 in a file."""
    if dataclasses.is_dataclass(one):
        pairs = [(getattr(one, each.name), getattr(other, each.name), each.name) for each in fields(one)]
    elif isinstance(one, Mapping):
        pairs = [(one[key], other.get(key), str(key)) for key in {**one, **other}]
    elif isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
        pairs = [(*each, str(index)) for index, each in enumerate(zip(one, other, strict=True))]
    elif isinstance(one, np.ndarray):
        same = (
            isinstance(other, np.ndarray) and one.shape == other.shape and np.allclose(one, other, atol=1e-5)
        )
        return [] if same else [where]
    else:
        return [] if one == other else [where]
    return [found for a, b, name in pairs for found in differences(a, b, f"{where}.{name}")]
