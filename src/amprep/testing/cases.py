"""Sample problems for each kind of offer; a packer gets only the problems that it accepts."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from amprep.checks.meshes import check_part
from amprep.checks.packing.volumes_placed import check_packing
from amprep.checks.supports.plan import check_plan
from amprep.checks.violation import Violation
from amprep.checks.volumes import check_volume
from amprep.errors import InputError
from amprep.host import Kind
from amprep.host.mismatch import mismatches, volume_word
from amprep.model import PackingProblem, Part, Stop, SupportProblem
from amprep.model.bounding_volume import as_turned
from amprep.pipeline.reading import repair_part
from amprep.testing.case import Case
from amprep.testing.offers import SEED, LoadedOffer
from amprep.testing.problems import packing_problems, sample_parts, support_problems, written_samples

REFUSED = "a file that is "
"""Beginning of the titles of the problems that a mesh reader must refuse."""


def cases_for(offer: LoadedOffer, files: Sequence[Path], folder: Path) -> list[Case]:
    """Return the sample problems for one offer.

    Parameters
    ----------
    offer
        Offer to run.
    files
        Files for a mesh reader to read.
    folder
        Folder for the files that the sample problems of a mesh reader need.
    """
    from amprep.testing.cell_cases import cell_cases

    makers: dict[Kind, Callable[[], Iterator[Case]]] = {
        "packer": lambda: _packer_cases(offer),
        "router": lambda: _router_cases(offer),
        "volume": lambda: _volume_cases(offer),
        "cell": lambda: cell_cases(offer),
        "reader": lambda: _reader_cases(offer, files, folder),
    }
    return list(makers[offer.listed.kind]())


def _runner(offer: LoadedOffer, subject: Any) -> Callable[[Stop], Any]:
    return lambda stop: offer.run(subject, stop=stop)


def _packer_cases(offer: LoadedOffer) -> Iterator[Case]:
    def judge(problem: PackingProblem) -> Callable[[Any], Sequence[Violation]]:
        return lambda packing: check_packing(problem, packing)

    for title, problem in packing_problems():
        if not mismatches(offer.listed.offer.accepts, problem):
            yield Case(title, _runner(offer, problem), judge(problem))


def _router_cases(offer: LoadedOffer) -> Iterator[Case]:
    def judge(problem: SupportProblem) -> Callable[[Any], Sequence[Violation]]:
        return lambda plan: check_plan(problem, plan)

    for title, problem in support_problems():
        yield Case(title, _runner(offer, problem), judge(problem))


def _volume_cases(offer: LoadedOffer) -> Iterator[Case]:
    makes = offer.listed.offer.makes

    def judge(part: Part) -> Callable[[Any], Sequence[Violation]]:
        def judged(volume: Any) -> list[Violation]:
            made = volume_word(as_turned(volume).volume)
            as_stated = made == makes or (made, makes) == ("box", "boxes")
            wrong = Violation("kind of volume", part.name, f"the offer states makes={makes!r}, got {made!r}")
            return [*check_volume(part, volume), *([] if as_stated else [wrong])]

        return judged

    for part in sample_parts():
        yield Case(part.name, _runner(offer, part), judge(part))


def _reader_cases(offer: LoadedOffer, files: Sequence[Path], folder: Path) -> Iterator[Case]:
    known = offer.listed.offer.suffixes
    own = [path for path in files if path.suffix.lower() in known]
    for path in [*own, *written_samples(folder, set(known))]:
        yield Case(path.name, _runner(offer, path), _judge_parts, timed=False)
    noise = np.random.default_rng(SEED).bytes(1000)
    for suffix in known:
        for name, content in (("empty", b""), ("noise", noise), ("missing", None)):
            path = folder / f"{name}{suffix}"
            if content is not None:
                path.write_bytes(content)
            yield Case(f"{REFUSED}{name} ({suffix})", _refusal(offer, path), _judge_refusal, timed=False)


def _judge_parts(parts: list[Part]) -> list[Violation]:
    if not parts:
        return [Violation("reads parts", "file", "expected at least one part, got none")]
    repaired = [repair_part(part, allow_surface=False) for part in parts]
    return [violation for part in repaired for violation in check_part(part)]


def _refusal(offer: LoadedOffer, path: Path) -> Callable[[Stop], str]:
    """Return a function that returns ``""`` if the reader raises `InputError`, and the unexpected result otherwise."""

    def run(stop: Stop) -> str:
        try:
            return f"{len(offer.run(path, stop=stop))} parts"
        except InputError:
            return ""

    return run


def _judge_refusal(read: str) -> list[Violation]:
    return [Violation("refuses what is no mesh", "file", f"expected InputError, got {read}")] if read else []
