"""Which kernels are compiled, as the cache of numba says."""

import os
import re
import sys
from pathlib import Path

_KERNEL = re.compile(r"@(?:kernel|njit\([^)]*cache=True[^)]*\))\s+def (\w+)")
"""Definition of a function whose compiled code is kept; other compiled functions are part of those that call them."""


def compiled_kernels() -> str:
    """Return how many kernels are compiled for this Python."""
    known, cached = _known(), _cached()
    return f"{len(known & cached)} of {len(known)}; the others are compiled when they are first needed"


def _known() -> set[str]:
    """Return all kernels, by their modules and names."""
    return {
        f"{path.stem}.{name}"
        for path in _folder().rglob("*.py")
        for name in _KERNEL.findall(path.read_text(encoding="utf-8"))
    }


def _cached() -> set[str]:
    """Return the compiled kernels, by their modules and names."""
    tag = f"py{sys.version_info.major}{sys.version_info.minor}"
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    files = (
        Path(elsewhere).rglob(f"*.{tag}*.nbi") if elsewhere else _folder().rglob(f"__pycache__/*.{tag}*.nbi")
    )
    return {".".join(path.name.partition("-")[0].split(".")[:2]) for path in files}


def _folder() -> Path:
    from amprep import kernels

    return Path(kernels.__file__).parent
