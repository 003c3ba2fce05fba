"""The tiny problems on which offers are tried: a few for each kind, only what the offer says it accepts."""

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
from amprep.hookspecs import CellEmitter, MeshReader, Packer, SupportRouter, VolumeMaker
from amprep.host import Host, Listed
from amprep.host.mismatch import fits, volume_word
from amprep.model import PackingProblem, Part, Stop, SupportProblem, silent
from amprep.pipeline.reading import repair_part
from amprep.testing.case import SEED, Case
from amprep.testing.problems import packing_problems, sample_parts, support_problems, written_samples


def cases_for(host: Host, listed: Listed[Any], files: Sequence[Path], folder: Path) -> list[Case]:
    """Return the cases of one offer; mesh readers get `files`, and `folder` for more of them."""
    offer = listed.offer
    if isinstance(offer, Packer):
        return list(_packer_cases(host, listed))
    if isinstance(offer, SupportRouter):
        return list(_router_cases(host, listed))
    if isinstance(offer, VolumeMaker):
        return list(_volume_cases(host, listed))
    if isinstance(offer, CellEmitter):
        from amprep.testing.cell_cases import cell_cases

        return list(cell_cases(host, listed))
    return list(_reader_cases(host, listed, files, folder))


def runner(host: Host, listed: Listed[Any], argument: Any, keywords: str) -> Callable[[Stop], Any]:
    """Return a function that calls an offer with its default parameters and the `keywords` of its hook."""
    params = host.params(listed, {})

    def run(stop: Stop) -> Any:
        given = {"params": params, "rng": np.random.default_rng(SEED), "stop": stop, "progress": silent}
        return host.call(listed, argument, **{name: given[name] for name in keywords.split()})

    return run


def _packer_cases(host: Host, listed: Listed[Packer]) -> Iterator[Case]:
    def judge(problem: PackingProblem) -> Callable[[Any], Sequence[Violation]]:
        return lambda packing: check_packing(problem, packing)

    for name, problem in packing_problems():
        if not fits(listed.offer.accepts, problem):
            yield Case(name, runner(host, listed, problem, "params rng stop progress"), judge(problem))


def _router_cases(host: Host, listed: Listed[SupportRouter]) -> Iterator[Case]:
    def judge(problem: SupportProblem) -> Callable[[Any], Sequence[Violation]]:
        return lambda plan: check_plan(problem, plan)

    for name, problem in support_problems():
        yield Case(name, runner(host, listed, problem, "params rng stop progress"), judge(problem))


def _volume_cases(host: Host, listed: Listed[VolumeMaker]) -> Iterator[Case]:
    makes = listed.offer.makes

    def judge(part: Part) -> Callable[[Any], Sequence[Violation]]:
        def judged(volume: Any) -> list[Violation]:
            made = volume_word(volume)
            stated = made == makes or (made, makes) == ("box", "boxes")
            wrong = Violation("kind of volume", part.name, f"the offer says it makes {makes!r}, got {made!r}")
            return [*check_volume(part, volume), *([] if stated else [wrong])]

        return judged

    for part in sample_parts():
        yield Case(part.name, runner(host, listed, part, "params rng stop"), judge(part))


def _reader_cases(
    host: Host, listed: Listed[MeshReader], files: Sequence[Path], folder: Path
) -> Iterator[Case]:
    known = listed.offer.suffixes
    own = [path for path in files if path.suffix.lower() in known]
    for path in [*own, *written_samples(folder, set(known))]:
        yield Case(path.name, runner(host, listed, path, "params"), _judge_parts, timed=False)
    noise = np.random.default_rng(SEED).bytes(1000)
    for suffix in known:
        for name, content in (("empty", b""), ("noise", noise), ("missing", None)):
            path = folder / f"{name}{suffix}"
            if content is not None:
                path.write_bytes(content)
            read = _refusal(runner(host, listed, path, "params"))
            yield Case(f"a file that is {name} ({suffix})", read, _judge_refusal, timed=False)


def _judge_parts(parts: list[Part]) -> list[Violation]:
    if not parts:
        return [Violation("reads parts", "file", "expected at least one part, got none")]
    settled = [repair_part(part, allow_surface=False) for part in parts]
    return [violation for part in settled for violation in check_part(part)]


def _refusal(read: Callable[[Stop], Any]) -> Callable[[Stop], str]:
    # what is no mesh is refused by InputError and nothing else
    def run(stop: Stop) -> str:
        try:
            return f"{len(read(stop))} parts"
        except InputError:
            return ""

    return run


def _judge_refusal(read: str) -> list[Violation]:
    return [Violation("refuses what is no mesh", "file", f"expected InputError, got {read}")] if read else []
