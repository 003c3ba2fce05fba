"""The steps of a build: load, pack, plan supports, emit cells."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from amprep.api.arguments import require_record
from amprep.api.job import job_and_host
from amprep.errors import InputError
from amprep.host import Host
from amprep.model import Mesh, Part, Progress, Stop, silent
from amprep.pipeline.packing import PackedBuild, PackedParts, pack_parts
from amprep.pipeline.reading import LoadedParts, read_job
from amprep.pipeline.resolve import resolve
from amprep.pipeline.stages import Clock, ProgressWatcher
from amprep.pipeline.support_plate import place_as_read
from amprep.pipeline.supporting import PlannedBuild, SupportedBuild, emit_supports, plan_build

Input = str | Path | Part | Mesh
"""A file, a folder, a job file, or geometry that is in memory."""


def load(
    *inputs: Input,
    printer: str | Path | Mapping[str, Any] | None = None,
    seed: int | None = None,
    target: str | None = None,
    settings: Mapping[str, Any] | None = None,
    allow_surface: bool = False,
    plugins: Host | Sequence[str] = (),
    progress: Progress = silent,
) -> LoadedParts:
    """Read parts from files and folders, check their meshes and repair them where possible.

    Parameters
    ----------
    inputs
        Mesh files, 3MF files and folders, also as ``NAME:4`` for four copies; one job file (.toml); or records
        `amprep.model.Part` and `amprep.model.Mesh`.
    printer
        Printer by name, path of a printer profile, or a table like one; default: the job's, else the EOS M290.
    seed
        Seed of the random numbers; default: the job's, else 0.
    target
        Program that will open the build jobs: ``generic``, ``prusaslicer`` or ``cura``; default: the job's, else
        ``generic``.
    settings
        Other settings of the job by the dotted keys of a job file, for example ``{"supports.pitch_mm": 0.8}``.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.
    plugins
        Plugin modules to load beside the installed plugins, by name or path.
    progress
        Called with the fraction that is done and a message.

    Returns
    -------
    LoadedParts
        The parts, and the job that the following steps work with.

    Raises
    ------
    InputError, MeshError
        When a file cannot be read or a mesh is not a solid.
    JobError, PluginError
        When a setting is wrong, or a plugin is unknown or fails.

    Examples
    --------
    >>> import amprep
    >>> parts = amprep.load("bracket.stl:4", "housing.3mf", printer="EOS M290")
    >>> print(parts)
    2 parts, 5 copies: bracket, housing
    """
    geometry = [_part(each) for each in inputs if isinstance(each, Part | Mesh)]
    files = [each for each in inputs if not isinstance(each, Part | Mesh)]
    changes = {"printer": printer, "seed": seed, "target": target, **(settings or {})}
    resolved = resolve(*job_and_host(files, changes, plugins, default=geometry[0].name if geometry else None))
    return read_job(resolved, Clock(ProgressWatcher(progress)), more=geometry, allow_surface=allow_surface)


def pack(
    parts: LoadedParts,
    *,
    packer: str | None = None,
    params: Mapping[str, Any] | None = None,
    stop: Stop | None = None,
    progress: Progress = silent,
    **settings: Any,
) -> PackedParts:
    """Place the parts in as few builds as possible, or as the objective says.

    Parameters
    ----------
    parts
        Parts from `load`.
    packer
        Packer by name, for example ``auto``; default: the job's, else ``auto``.
    params
        Parameters of the packer.
    stop
        Ends the packing early; the result is the best packing found so far.
    progress
        Called with the fraction that is done and a message.
    settings
        Keys of the section ``[packing]`` of a job file: ``clearance_mm``, ``lift_mm``, ``objective``,
        ``effort``, ``time_limit_s`` and so on.

    Returns
    -------
    PackedParts
        The builds, the copies that are unplaced, and the bound that the packer proved.

    Raises
    ------
    JobError, PluginError
        When a setting is wrong, or the packer is unknown, fails or cannot handle the parts.
    AmprepError
        When no part fits the build volume.

    Examples
    --------
    >>> packed = amprep.pack(parts, packer="auto", clearance_mm=4, lift_mm=3, time_limit_s=10)
    >>> [len(build.parts) for build in packed.builds]
    [5]
    """
    require_record(parts, (LoadedParts,), "pack", "pass the result of load")
    changes = _section("packing", packer, params, settings)
    loaded = replace(parts, resolved=parts.resolved.changed(changes))
    return pack_parts(loaded, Clock(ProgressWatcher(progress)), stop or Stop())


def plan_supports(
    build: PackedBuild | LoadedParts,
    *,
    router: str | None = None,
    params: Mapping[str, Any] | None = None,
    cell: str | Path | None = None,
    stop: Stop | None = None,
    progress: Progress = silent,
    **settings: Any,
) -> PlannedBuild:
    """Find the overhangs of a build and plan supports for them on the support grid.

    Parameters
    ----------
    build
        A build from `pack`; or parts from `load`, which are then supported at the positions in their files.
    router
        Support router by name, for example ``tree``; default: the job's, else ``shortest-paths``.
    params
        Parameters of the router.
    cell
        Lattice cell by name or file; the router takes the material of an edge from it, and `emit_cells` uses it.
    stop
        Ends the routing early; the result is the best plan found so far.
    progress
        Called with the fraction that is done and a message.
    settings
        Keys of the section ``[supports]`` of a job file: ``pitch_mm``, ``overhang_angle_deg``, ``time_limit_s``
        and so on.

    Returns
    -------
    PlannedBuild
        The build with the layout of its supports.

    Raises
    ------
    JobError, PluginError
        When a setting is wrong, or the router or the cell is unknown or fails.
    InputError
        When a part from `load` is outside the build volume.

    Examples
    --------
    >>> planned = amprep.plan_supports(packed.builds[0], pitch_mm=2)
    >>> print(planned)
    bracket.build-1: 412 of 412 demand squares connected, pitch 2 mm
    """
    advice = "pass one of the builds of pack, or the result of load"
    require_record(build, (PackedBuild, LoadedParts), "plan_supports", advice)
    changes = {**_section("supports", router, params, settings), "cells.strategy": cell}
    if isinstance(build, LoadedParts):
        build = place_as_read(replace(build, resolved=build.resolved.changed(changes)))
    else:
        build = replace(build, resolved=build.resolved.changed(changes))
    return plan_build(build, Clock(ProgressWatcher(progress)), stop or Stop())


def emit_cells(
    planned: PlannedBuild,
    *,
    cell: str | Path | None = None,
    params: Mapping[str, Any] | None = None,
    stop: Stop | None = None,
    progress: Progress = silent,
    **settings: Any,
) -> SupportedBuild:
    """Replace the edges of planned supports by lattice cells and unite them to closed solids.

    Parameters
    ----------
    planned
        A build from `plan_supports`.
    cell
        Lattice cell by name or file; default: the cell of the plan.
    params
        Parameters of the cell.
    stop
        Ends the work early.
    progress
        Called with the fraction that is done and a message.
    settings
        Keys of the section ``[cells]`` of a job file: ``connector``, ``base``, ``neck_mm`` and so on.

    Returns
    -------
    SupportedBuild
        The build with its supports, and the regions that stay unsupported, each with a reason.

    Raises
    ------
    JobError, PluginError, InputError
        When a setting is wrong, or the cell is unknown, fails or cannot be read.

    Examples
    --------
    >>> supported = amprep.emit_cells(planned, cell="x-wall", connector="teeth")
    >>> supported.build.unsupported
    ()
    """
    require_record(planned, (PlannedBuild,), "emit_cells", "pass the result of plan_supports")
    changes = _section("cells", cell, params, settings)
    job = planned.build.resolved.job
    resolved = planned.build.resolved.changed(changes)
    # positions that the user chose have no clearance and lift; settings of the job file do not bring them back
    resolved = replace(resolved, job=replace(resolved.job, packing=job.packing, supports=job.supports))
    planned = replace(planned, build=replace(planned.build, resolved=resolved))
    return emit_supports(planned, Clock(ProgressWatcher(progress)), stop or Stop())


def _part(geometry: Part | Mesh) -> Part:
    mesh = geometry.mesh if isinstance(geometry, Part) else geometry
    least, greatest = mesh.triangles.min(initial=0), mesh.triangles.max(initial=-1)
    if least < 0 or greatest >= len(mesh.vertices):
        index = least if least < 0 else greatest
        message = f"triangles must refer to the vertices 0 to {len(mesh.vertices) - 1}, got the index {index}"
        raise InputError(f"{message}; pass all vertices of the mesh")
    return geometry if isinstance(geometry, Part) else Part("mesh", mesh, mesh.signed_volume)


def _section(
    section: str, strategy: str | Path | None, params: Mapping[str, Any] | None, settings: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the settings of a section by dotted keys; the strategy comes first, because it resets the parameters."""
    named = {f"{section}.{key}": value for key, value in settings.items()}
    return {f"{section}.strategy": strategy, f"{section}.params": params, **named}
