"""Cut a build into layers and write them: Common Layer Interface, SVG, or 3MF with slices."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from amprep.errors import AmprepError, InputError
from amprep.files import replacing
from amprep.geometry.slicing.layers import LayerContours
from amprep.measures.density import layer_count
from amprep.model.build import Build
from amprep.model.control import Progress, Stop, silent
from amprep.report.slices.record import FORMS, SlicedBodyRecord, SliceRecord
from amprep.slices.bodies import Layer, SliceBody, bodies_of, cut_layers, layered
from amprep.slices.cli_file import CliFile
from amprep.slices.svg_file import layer_svg

MOST_LAYERS = 200_000
"""Layers of a build; more are refused."""

MOST_PICTURES = 100
"""SVG files of a build; of more layers, equally spaced ones are drawn."""

_MOST_MESSAGES = 20
"""Messages of progress while layers are cut; a log has a line for each."""


class _Tally:
    """Adds up the areas of the bodies by layer, reports progress, and ends at a deadline."""

    def __init__(self, bodies: Sequence[SliceBody], layers: int, stop: Stop, progress: Progress) -> None:
        self.areas = np.zeros((len(bodies), layers))
        self.contours = np.zeros(len(bodies), np.int64)
        self.lines_mm = np.zeros(len(bodies))
        self._stop, self._progress = stop, progress

    def count(self, body: int, contours: LayerContours, own: range) -> None:
        """Add the contours of a body in one layer."""
        layer = int(contours.layer[own.start])
        self.areas[body, layer] += float(contours.area[own.start : own.stop].sum())
        self.contours[body] += len(own)
        if contours.is_open:
            self.lines_mm[body] += contours.length_of(own)

    def show(self, done: float, message: str) -> None:
        """Report the fraction that is done; raise AmprepError if the work is to end."""
        if self._stop():
            raise AmprepError(
                f"slicing ended early ({self._stop.reason}); nothing was written; allow more time"
            )
        self._progress(done, message)


def slice_build(
    build: Build,
    layer_mm: float,
    form: str,
    folder: Path,
    *,
    stop: Stop | None = None,
    progress: Progress = silent,
) -> SliceRecord:
    """Write the layers of a build and return what was written; all files appear, or none.

    Parameters
    ----------
    build
        The build.
    layer_mm
        Thickness of a layer, mm. Each layer is cut in its middle.
    form
        One of `amprep.report.slices.record.FORMS`.
    folder
        Output folder; it is created.
    stop, progress
        Ends the work early, and is called with the fraction that is done.

    Raises
    ------
    InputError
        If the form is unknown, or the layers are too thin or too thick for the build.
    AmprepError
        If the work ends early or a file cannot be written.
    """
    layers = _checked(build, layer_mm, form)
    bodies = bodies_of(build)
    tally = _Tally(bodies, layers, stop or Stop(), progress)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise AmprepError(
            f"cannot write to {folder}: {error.strerror or error}; choose another folder"
        ) from error
    name = build.settings.build_id
    if form == "3mf-slice":
        files = [_write_3mf(bodies, layer_mm, folder / f"{name}.slices.3mf", tally)]
    elif form == "svg":
        files = _write_svg(build, bodies, layer_mm, folder / name, tally)
    else:
        files = _write_cli(bodies, layer_mm, folder / name, tally, is_binary=form == "cli-binary")
    found = tuple(
        SlicedBodyRecord(
            each.name,
            "support" if each.is_support else "part",
            tally.areas[i],
            int(tally.contours[i]),
            each.volume_mm3,
            float(tally.lines_mm[i]),
            has_beams=each.has_beams,
        )
        for i, each in enumerate(bodies)
    )
    return SliceRecord(name, layer_mm, layers, found, tuple(file.name for file in files), folder)


def _checked(build: Build, layer_mm: float, form: str) -> int:
    """Return the number of layers; raise InputError for a wrong thickness or form."""
    if form not in FORMS:
        raise InputError(f"slices cannot be written as {form!r}; choose one of {', '.join(FORMS)}")
    if not 0.0 < layer_mm <= 100.0:
        raise InputError(f"a layer must be thicker than 0 and at most 100 mm, got {layer_mm:g}")
    layers = layer_count(build, layer_mm)
    if not layers:
        raise InputError("the build has nothing above the plate, so it has no layers")
    if layers > MOST_LAYERS:
        raise InputError(
            f"layers of {layer_mm:g} mm are {layers}, more than {MOST_LAYERS}; choose thicker ones"
        )
    return layers


def _counted(bodies: Sequence[SliceBody], layer_mm: float, tally: _Tally) -> Iterator[Layer]:
    """Yield the layers of all bodies, and count them."""
    layers = tally.areas.shape[1]
    shown = max(layers // _MOST_MESSAGES, 1)
    for layer in cut_layers(bodies, layer_mm, layers):
        tally.show(layer.number / layers, f"layer {layer.number // shown * shown + 1} of {layers}")
        for body, contours, own in layer.contours:
            tally.count(body, contours, own)
        yield layer


def _write_cli(
    bodies: Sequence[SliceBody], layer_mm: float, stem: Path, tally: _Tally, *, is_binary: bool
) -> list[Path]:
    """Write parts and supports as two files, because machines expose them with different parameters."""
    layers = tally.areas.shape[1]
    paths = []
    with ExitStack() as stack:
        files = []
        for role in ("parts", "supports"):
            names = {i: each.name for i, each in enumerate(bodies) if each.is_support == (role == "supports")}
            if not names:
                continue
            path = stem.with_name(f"{stem.name}.{role}.cli")
            file = stack.enter_context((stack.enter_context(replacing(path))).open("wb"))
            bounds = np.array([bodies[i].mesh.bounds for i in names])
            box = np.array([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])
            files.append(CliFile(file, names, layers, box, is_binary=is_binary))
            paths.append(path)
        for layer in _counted(bodies, layer_mm, tally):
            for each in files:
                each.add(layer)
        for each in files:
            each.end()
    return paths


def _write_svg(
    build: Build, bodies: Sequence[SliceBody], layer_mm: float, stem: Path, tally: _Tally
) -> list[Path]:
    """Write a picture of each layer, or of equally spaced layers with the first and the last one."""
    layers = tally.areas.shape[1]
    drawn = set(
        np.unique(np.linspace(0, layers - 1, min(layers, MOST_PICTURES)).round().astype(int)).tolist()
    )
    width, depth, _ = build.settings.space.size.tolist()
    paths = []
    with ExitStack() as stack:
        for layer in _counted(bodies, layer_mm, tally):
            if layer.number in drawn:
                path = stem.with_name(f"{stem.name}.layer-{layer.number + 1:0{len(str(layers))}d}.svg")
                stack.enter_context(replacing(path)).write_bytes(layer_svg(layer, bodies, (width, depth)))
                paths.append(path)
    return paths


def _write_3mf(bodies: Sequence[SliceBody], layer_mm: float, path: Path, tally: _Tally) -> Path:
    from amprep.threemf.write.document import MeshObject, ObjectType
    from amprep.threemf.write.slices import ObjectWithSlices, write_sliced

    layers = tally.areas.shape[1]

    def blocks(body: int) -> Iterable[LayerContours]:
        for block in layered(bodies[body]).blocks(layer_mm, layers):
            tally.show((body + block.first_layer / layers) / len(bodies), bodies[body].name)
            for layer in range(block.first_layer, block.first_layer + block.layers):
                own = block.of_layer(layer)
                if own:
                    tally.count(body, block, own)
            yield block

    def objects() -> Iterator[ObjectWithSlices]:
        for i, each in enumerate(bodies):
            kind: ObjectType = "surface" if each.is_surface else "support" if each.is_support else "model"
            yield ObjectWithSlices(MeshObject(each.name, each.mesh, kind), blocks(i))

    with replacing(path) as temporary:
        write_sliced(objects(), layer_mm, temporary)
    return path
