"""What a user needs to judge a table of poses: how many, how good, the worst, and what is odd."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cdpr8.runfolder.tables import FrameFlag

if TYPE_CHECKING:
    import pandas as pd
    from rich.table import Table

MEANINGS = {
    FrameFlag.DROPPED_BEFORE: "a frame is missing before this one",
    FrameFlag.REPEATED: "the same picture as the frame before",
    FrameFlag.BLACK: "black",
    FrameFlag.NO_MARKER: "no marker of the plate",
    FrameFlag.FEW_MARKERS: "fewer than half of the plate's markers",
    FrameFlag.AMBIGUOUS: "two poses fit: turn the plate or move the camera off its normal",
    FrameFlag.BRANCH_FROM_PREVIOUS: "the frame before decided which of two poses",
    FrameFlag.HIGH_REPROJECTION: "corners off by over 1 px: check plate layout, intrinsics, focus",
}


MOST_LOST = 0.02
POOR_PITCH_DEG = 0.02
BLURRED_PX = 1.5
GOOD_REPROJECTION_PX = 0.08
"""Past these the summary gives advice; corners of a good plate miss by 0.01 to 0.03 px."""


@dataclass(frozen=True)
class TrackSummary:
    """Figures of one table of poses.

    Attributes
    ----------
    frames, with_pose
        Frames, and those with at least one pose.
    reproj_px
        Median reprojection error.
    angle
        The angle that `sigma_deg` is of: pitch, or a rotation about the line of sight.
    sigma_deg
        Median standard deviation of that angle.
    span_deg
        Least and greatest of that angle; None for independent markers.
    worst_frame, worst_reproj_px
        Where the reprojection error is greatest.
    flags
        Flag -> frames that carry it.
    advice
        What would make it better; empty where nothing stands out.
    notes
        What else a user must know.
    """

    frames: int
    with_pose: int
    reproj_px: float
    angle: str
    sigma_deg: float
    span_deg: tuple[float, float] | None
    worst_frame: int
    worst_reproj_px: float
    flags: dict[FrameFlag, int]
    advice: tuple[str, ...]
    notes: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """For machines; NaN is not known."""
        return {
            "frames": self.frames,
            "frames_with_pose": self.with_pose,
            "median_reproj_px": self.reproj_px,
            f"median_sigma_{self.angle}_deg": self.sigma_deg,
            f"{self.angle}_span_deg": self.span_deg,
            "worst_frame": self.worst_frame,
            "worst_reproj_px": self.worst_reproj_px,
            "flags": {flag.name.lower(): n for flag, n in self.flags.items() if flag.name},
            "advice": list(self.advice),
            "notes": list(self.notes),
        }

    def as_table(self, title: str) -> "Table":
        """For people."""
        from rich.table import Table

        table = Table(title=title, title_justify="left", show_header=False)
        table.add_row("frames", str(self.frames))
        table.add_row("with pose", f"{self.with_pose} ({self.with_pose / self.frames:.1%})")
        table.add_row("reprojection error, median", f"{self.reproj_px:.3f} px")
        table.add_row(f"sigma of {self.angle}, median", f"{self.sigma_deg:.4f} deg")
        if self.span_deg:
            table.add_row(self.angle, "{:+.3f} to {:+.3f} deg".format(*self.span_deg))
        table.add_row("worst frame", f"{self.worst_frame} ({self.worst_reproj_px:.3f} px)")
        for flag, count in self.flags.items():
            name = (flag.name or "").lower().replace("_", " ")
            table.add_row(name, f"{count} frames: {MEANINGS[flag]}")
        for line in self.advice:
            table.add_row("advice", line)
        return table


def summarise(poses: "pd.DataFrame", notes: list[str]) -> TrackSummary:
    """The figures of a table of poses, of a run or of a video; it has at least one pose."""
    angle = "pitch" if "pitch_deg" in poses else "rz"
    posed = poses[poses["x_m"].notna()]
    single = "marker" in poses and bool(poses["marker"].notna().any())
    worst = posed.iloc[int(posed["reproj_px"].to_numpy().argmax())]
    values = posed[f"{angle}_deg"].to_numpy()
    flags = poses["flags"].to_numpy()
    frames = poses["frame"].to_numpy()
    counted = {flag: len(np.unique(frames[(flags & int(flag)) != 0])) for flag in FrameFlag}
    return TrackSummary(
        frames=int(poses["frame"].nunique()),
        with_pose=int(posed["frame"].nunique()),
        reproj_px=float(posed["reproj_px"].median()),
        angle=angle,
        sigma_deg=float(posed[f"sigma_{angle}_deg"].median()),
        span_deg=None if single or angle != "pitch" else (float(values.min()), float(values.max())),
        worst_frame=int(worst["frame"]),
        worst_reproj_px=float(worst["reproj_px"]),
        flags={flag: count for flag, count in counted.items() if count},
        advice=tuple(_advice(poses, posed, angle)),
        notes=tuple(notes),
    )


def _advice(poses: "pd.DataFrame", posed: "pd.DataFrame", angle: str) -> list[str]:
    """What the figures suggest to do."""
    lines = []
    lost = 1.0 - posed["frame"].nunique() / poses["frame"].nunique()
    if lost > MOST_LOST:
        lines.append(f"{lost:.0%} of the frames have no pose: more light, or larger markers")
    sigma = float(posed[f"sigma_{angle}_deg"].median())
    if angle == "pitch" and sigma > POOR_PITCH_DEG:
        lines.append("pitch is poor: see `vision plate` for views that show it better")
    blur = float(posed["blur_px"].median())
    if blur > BLURRED_PX:
        lines.append(
            f"the picture is blurred by {blur:.1f} px: focus, or expose for a shorter time"
        )
    reprojection = float(posed["reproj_px"].median())
    if angle == "pitch" and reprojection > GOOD_REPROJECTION_PX:
        lines.append(
            f"corners miss by {reprojection:.2f} px, more than noise: measure the plate, or try "
            "--self-calibrate; else calibrate the camera anew"
        )
    return lines
