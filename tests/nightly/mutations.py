"""Make hostile inputs out of good ones: bytes, archives, XML, job files, settings and records of build files."""

import io
import random
import re
import zipfile
from dataclasses import dataclass
from pathlib import Path

FIXTURES = Path(__file__).parents[2] / "fixtures"

NUMBERS = (
    "0",
    "-1",
    "1e-9",
    "1e9",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "99999999999999999999",
    "1e-320",
)
VALUES = (
    *NUMBERS,
    "true",
    "[]",
    "{}",
    "''",
    "null",
    "[1, 2]",
    "x" * 300,
    "\u0000",
    "../../x",
    "/etc/passwd",
    "é\u202e",
)

KEYS = (
    "seed",
    "target",
    "printer",
    "material",
    "printer.size_mm",
    "supports.",
    ".x",
    "packing.nonsense",
    "packing.strategy",
    "packing.objective",
    "packing.clearance_mm",
    "packing.lift_mm",
    "packing.stacking",
    "packing.volumes",
    "packing.effort",
    "packing.params",
    "packing.time_limit_s",
    "packing.blade_angle_deg",
    "packing.interlocking",
    "packing.even_layers",
    "supports.enabled",
    "supports.strategy",
    "supports.pitch_mm",
    "supports.step_mm",
    "supports.overhang_angle_deg",
    "supports.memory_mb",
    "supports.gap_mm",
    "supports.edge_capacity",
    "supports.node_capacity",
    "supports.grounding",
    "supports.leg_ratio",
    "supports.escalation",
    "supports.write_as",
    "supports.contact_spacing_mm",
    "supports.layer_mm",
    "supports.load_area_mm2",
    "supports.params",
    "cells.strategy",
    "cells.params",
    "cells.connector",
    "cells.base",
    "cells.overlap_mm",
    "cells.neck_mm",
    "cells.lattice",
    "cells.powder_hole_mm",
    "cells.removability",
    "cells.perforation_mm",
)

JOB = """seed = 1
inputs = ["part.stl"]
printer = "EOS M290"

[packing]
strategy = "extreme-points"
clearance_mm = 2.0
lift_mm = 0.0
time_limit_s = 2

[supports]
enabled = false
pitch_mm = 4.0
overhang_angle_deg = 45.0

[cells]
strategy = "prism"
overlap_mm = 0.1

[[part]]
file = "part.stl"
quantity = 2
rotations = "z90"
value = 3.0
"""


@dataclass(frozen=True)
class Case:
    """A call of the command line in a folder.

    Attributes
    ----------
    files
        Files to put into the folder before the call, by name.
    arguments
        Arguments of `amprep`; ``out`` is the output folder.
    """

    files: dict[str, bytes]
    arguments: tuple[str, ...]


QUICK = ("--set", "supports.enabled=false", "--set", "packing.strategy=extreme-points")


def make_case(kind: str, seed: int, build_file: bytes) -> Case:
    """Return the case of a kind and seed; `build_file` is a build that amprep wrote."""
    rng = random.Random(f"{kind} {seed}")
    case: Case = _MAKERS[kind](rng, build_file)
    return case


def _of_bytes(rng, _):
    name = rng.choice(["knife-edge.stl", "table.stl", "wheel.3mf", *_malformed()])
    data = _changed((FIXTURES / name).read_bytes(), rng)
    return _run_on(Path(name).suffix, data, rng)


def _of_zip(rng, build_file):
    entries = _entries(rng.choice([(FIXTURES / "wheel.3mf").read_bytes(), build_file]))
    for _ in range(rng.randint(1, 3)):
        _change_entries(entries, rng)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", rng.choice([zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED])) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    data = stream.getvalue()
    return _run_on(".3mf", _changed(data, rng) if rng.random() < 0.2 else data, rng)


def _of_xml(rng, build_file):
    entries = _entries(rng.choice([(FIXTURES / "wheel.3mf").read_bytes(), build_file]))
    chosen = rng.choice(
        [name for name, _ in entries if name.endswith((".model", ".rels", ".xml", ".config"))]
    )
    changed = [(name, _changed_xml(data, rng) if name == chosen else data) for name, data in entries]
    return _run_on(".3mf", _zipped(changed), rng)


def _of_record(rng, build_file):
    """Change the texts between the tags of metadata, where amprep keeps its record."""
    entries = _entries(build_file)
    changed = []
    for name, data in entries:
        text = data.decode("utf-8", "replace")
        if "<metadata" in text:
            spots = list(re.finditer(r"(?<=>)[^<>]+(?=</metadata>)", text))
            for spot in rng.sample(spots, min(len(spots), 1)):
                text = text[: spot.start()] + _changed_record(spot[0], rng) + text[spot.end() :]
        changed.append((name, text.encode("utf-8", "replace") if "<metadata" in text else data))
    return Case({"a.3mf": _zipped(changed)}, ("verify", "a.3mf"))


def _of_job(rng, _):
    lines = JOB.splitlines()
    for _ in range(rng.randint(1, 3)):
        row = rng.randrange(len(lines))
        key = lines[row].partition("=")[0]
        choices = [f"{key}= {rng.choice(VALUES)}", f"{key}= {rng.choice(VALUES)!r}", "", lines[row] * 2]
        choices += [lines[row][: rng.randint(0, len(lines[row]))], f"[{rng.choice(VALUES)}]"]
        lines[row] = rng.choice(choices)
    text = "\n".join(lines).encode("utf-8", "replace")
    part = (FIXTURES / "knife-edge.stl").read_bytes()
    return Case({"job.toml": text, "part.stl": part}, ("run", "job.toml", "-q", "-o", "out"))


def _of_setting(rng, _):
    key, value = rng.choice(KEYS), rng.choice(VALUES).replace("\u0000", "0")
    part = (FIXTURES / "knife-edge.stl").read_bytes()
    return Case({"a.stl": part}, ("run", "a.stl", "-q", "-o", "out", *QUICK, "--set", f"{key}={value}"))


_MAKERS = {
    "bytes": _of_bytes,
    "zip": _of_zip,
    "xml": _of_xml,
    "record": _of_record,
    "job": _of_job,
    "setting": _of_setting,
}
KINDS = tuple(_MAKERS)


def _malformed():
    return sorted(f"malformed/{path.name}" for path in (FIXTURES / "malformed").iterdir())


def _run_on(suffix, data, rng):
    file = f"a{suffix}"
    command = rng.choice(["run", "run", "inspect", "verify" if suffix == ".3mf" else "run"])
    if command == "run":
        return Case({file: data}, ("run", file, "-q", "-o", "out", *QUICK))
    return Case({file: data}, (command, file, "-q"))


def _changed(data, rng):
    changed = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 8, 64])):
        at = rng.randrange(len(changed) + 1)
        match rng.randrange(5):
            case 0 if at < len(changed):
                changed[at] ^= 1 << rng.randrange(8)
            case 1:
                del changed[at : at + rng.choice([1, 4, 50, 2000])]
            case 2:
                changed[at:at] = rng.randbytes(rng.choice([1, 4, 50]))
            case 3:
                changed[at : at + 4] = rng.choice([b"\xff" * 4, b"\0" * 4, b"\x7f\xf0\0\0", b"\0\0\xc0\x7f"])
            case _ if rng.random() < 0.2:
                del changed[at:]
    return bytes(changed)


def _entries(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return [(name, archive.read(name)) for name in archive.namelist()]


def _zipped(entries):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return stream.getvalue()


def _change_entries(entries, rng):
    at = rng.randrange(len(entries)) if entries else None
    if at is None:
        return
    name, data = entries[at]
    names = ["../../evil.model", "/abs.model", name.upper(), "3D/other.model", name + "/", "a" * 200]
    match rng.randrange(4):
        case 0:
            del entries[at]
        case 1:
            entries[at] = (rng.choice(names), data)
        case 2:
            entries[at] = (name, rng.choice([b"", data[: len(data) // 2], data + data, rng.randbytes(200)]))
        case _:
            entries.append((rng.choice(names), data))


def _changed_xml(data, rng):
    text = data.decode("utf-8", "replace")
    for _ in range(rng.randint(1, 3)):
        spots = list(re.finditer(r'(?<==")[^"]*(?=")', text)) if rng.random() < 0.7 else []
        if spots:
            spot = rng.choice(spots[:200] if rng.random() < 0.5 else spots)
            value = rng.choice([*NUMBERS, "", "a b", "1 0 0 0 1 0 0 0 1 0 0 0", "0 " * 12, "x" * 500])
            text = text[: spot.start()] + value + text[spot.end() :]
            continue
        tags = list(re.finditer(r"</?[\w:]+[^<>]*>", text))
        if tags:
            tag = rng.choice(tags[:100] if rng.random() < 0.7 else tags)
            value = rng.choice(
                ["", tag[0] * 2, tag[0] * 50, "<x>", "&lol;", "<!DOCTYPE a [<!ENTITY l 'l'>]>"]
            )
            text = text[: tag.start()] + value + text[tag.end() :]
    return text.encode("utf-8", "replace")


def _changed_record(text, rng):
    spots = list(re.finditer(r"-?\d+\.?\d*(?:e-?\d+)?|true|false|null|&quot;[^&]*&quot;", text))
    for _ in range(rng.choice([1, 1, 2, 5])):
        if not spots or rng.random() < 0.1:
            at = rng.randrange(len(text) + 1)
            text = text[:at] + rng.choice(["", "[", "}", ",", "9" * 50]) + text[at + rng.randint(0, 20) :]
            spots = []
            continue
        spot = rng.choice(spots)
        text = text[: spot.start()] + rng.choice([*NUMBERS, "true", "null", "[]"]) + text[spot.end() :]
        spots = []
    return text
