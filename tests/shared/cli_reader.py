"""Reads the Common Layer Interface; written from its description, without code of the writer."""

import struct

import numpy as np


def read_cli(path):
    """Return the header lines and the layers of a file: height, and polylines as (body, direction, points) in mm."""
    data = path.read_bytes()
    head, rest = data.split(b"$$HEADEREND", 1)
    header = head.decode("ascii").split("\n")
    unit = next(float(line.split("/")[1]) for line in header if line.startswith("$$UNITS/"))
    layers = _binary_layers(rest) if "$$BINARY" in header else _text_layers(rest)
    return header, [
        (z * unit, [(body, way, points * unit) for body, way, points in lines]) for z, lines in layers
    ]


def _text_layers(rest):
    lines = rest.decode("ascii").split("\n")
    assert lines[:2] == ["", "$$GEOMETRYSTART"]
    assert lines[-2:] == ["$$GEOMETRYEND", ""]
    layers: list[tuple[float, list[tuple[int, int, np.ndarray]]]] = []
    for line in lines[2:-2]:
        command, values = line.split("/")
        if command == "$$LAYER":
            layers.append((float(values), []))
        else:
            assert command == "$$POLYLINE"
            body, way, count, *numbers = values.split(",")
            assert len(numbers) == 2 * int(count)
            layers[-1][1].append((int(body), int(way), np.array(numbers, float).reshape(-1, 2)))
    return layers


def _binary_layers(rest):
    layers: list[tuple[float, list[tuple[int, int, np.ndarray]]]] = []
    at = 0
    while at < len(rest):
        (command,) = struct.unpack_from("<H", rest, at)
        if command == 127:
            layers.append((struct.unpack_from("<f", rest, at + 2)[0], []))
            at += 6
        else:
            assert command == 130
            body, way, count = struct.unpack_from("<iii", rest, at + 2)
            numbers = np.frombuffer(rest, "<f4", 2 * count, at + 14).astype(float)
            layers[-1][1].append((body, way, numbers.reshape(-1, 2)))
            at += 14 + 8 * count
    return layers


def signed_area(points):
    """Return the area that a polyline encloses, mm2, positive if it is counter-clockwise (shoelace formula)."""
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0
