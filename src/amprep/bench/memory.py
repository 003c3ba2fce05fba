"""Measure the peak memory of this process."""

import sys
from contextlib import suppress
from pathlib import Path


def reset_peak() -> None:
    """Start the measurement of peak memory anew, where Linux supports that."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def peak_mb() -> int | None:
    """Return the peak memory of this process (MiB) since the last reset; None where the system does not tell."""
    with suppress(OSError):
        status = Path("/proc/self/status").read_text(encoding="ascii")
        return int(status.split("VmHWM:")[1].split()[0]) // 2**10
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(peak // (2**20 if sys.platform == "darwin" else 2**10))
