"""Stiffnesses as a rig file, a table and a dictionary."""

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.stiffness import Stiffnesses
from cdpr8.provenance import versions
from cdpr8.rigfile import load_rig

if TYPE_CHECKING:
    from rich.table import Table

FILE = "stiffness.toml"


def write_rig(found: Stiffnesses, rig_file: Path, path: Path) -> Path:
    """Write a rig file with the stiffnesses in it; cables that moved too little keep theirs.

    Parameters
    ----------
    found
        The stiffnesses.
    rig_file
        The rig file they go into.
    path
        Where to write it.

    Raises
    ------
    RigFileError
        The rig file cannot be read, or the new one describes no machine that can be.
    """
    import tomli_w

    data = tomllib.loads(rig_file.read_text(encoding="utf-8"))
    for one in found.cables:
        if one.told:
            data["cable"][one.cable - 1]["stiffness_n_per_m"] = {
                "value": round(one.value, 3),
                "sigma": round(one.sigma, 3),
                "source": source(found),
            }
    intrinsics = data.get("camera", {}).get("intrinsics")
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(intrinsics, str) and rig_file.parent.resolve() != path.parent.resolve():
        (path.parent / intrinsics).write_bytes((rig_file.parent / intrinsics).read_bytes())
    head = f"# Written by `analysis stiffness`: stiffnesses from {_names(found)}.\n\n"
    path.write_text(head + tomli_w.dumps(data), encoding="utf-8")
    load_rig(path)
    return path


def source(found: Stiffnesses) -> str:
    """Where the values come from; `analysis compare` finds the runs' ids in it."""
    ids = ", ".join(one.run.start.id for one in found.recordings)
    return f"analysis stiffness {_names(found)} (id {ids})"


def _names(found: Stiffnesses) -> str:
    return ", ".join(one.run.name for one in found.recordings)


def table(found: Stiffnesses) -> "Table":
    """For people."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    shown = Table(
        title=f"{_names(found)}: cable stiffnesses", title_justify="left", box=SIMPLE_HEAD
    )
    for column in (
        "cable",
        "k_w (N/m)",
        "sigma",
        "of which\nnoise",
        "geometry",
        "calibration,\ntiming",
        "rig file",
        "off by\n(sigma)",
        "elongation\n(mm)",
        "follows\nthe rate (N)",
        "leads by\n(ms)",
    ):
        shown.add_column(column, justify="right", no_wrap=True)
    for one in found.cables:
        parts = one.parts
        rest = (parts["calibration"] ** 2 + parts["timing"] ** 2) ** 0.5
        bias = one.bias
        shown.add_row(
            str(one.cable),
            f"{one.value:.1f}" if one.told else "cannot tell",
            f"{one.sigma:.1f}",
            f"{parts['noise']:.1f}",
            f"{parts['geometry']:.1f}",
            f"{rest:.1f}",
            f"{one.rig_value:.1f}",
            f"{one.off_sigmas:+.1f}" if one.told else "",
            f"{1e3 * one.moved_m:.2f}",
            f"{bias.quadrature_n:+.4f} ± {bias.quadrature_sigma_n:.4f}",
            f"{1e3 * bias.lag_s:+.2f} ± {1e3 * bias.lag_sigma_s:.2f}",
        )
    return shown


def as_dictionary(found: Stiffnesses, written: Path | None) -> dict[str, Any]:
    """For machines; N/m, N, m and s."""
    return {
        "runs": [{"name": one.run.name, "id": one.run.start.id} for one in found.recordings],
        "cables": {
            str(one.cable): {
                "stiffness_n_per_m": one.value,
                "sigma_n_per_m": one.sigma,
                "sigma_parts_n_per_m": dict(one.parts),
                "told": one.told,
                "rig_n_per_m": one.rig_value,
                "rig_sigma_n_per_m": one.rig_sigma,
                "off_sigmas": one.off_sigmas,
                "elongation_m": one.moved_m,
                "spread_of_runs_sigmas": one.spread,
                "bias": vars(one.bias),
            }
            for one in found.cables
        },
        "lead_s": {"value": found.lag_s, "sigma": found.lag_sigma_s},
        "warnings": list(found.warnings),
        "rig_file": None if written is None else str(written),
        "versions": versions(),
    }
