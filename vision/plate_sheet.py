"""A plate on paper, to scale: PDF or SVG, with a ruler to check the printer by."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cdpr8.errors import DataError, UsageError
from vision.marker_print import PADDING, print_of
from vision.plate import Plate

MARGIN_MM = 12.0
RULER_MM = 100.0
FOOT_MM = 16.0
POINTS_PER_MM = 72.0 / 25.4

Box = tuple[float, float, float, float]
"""Left, top, width and height, mm from the sheet's top left."""


@dataclass(frozen=True)
class Sheet:
    """Black boxes on white.

    Attributes
    ----------
    width_mm, height_mm
        Of the sheet.
    boxes
        What is black.
    outline
        Along which to cut.
    text
        One line at the foot.
    """

    width_mm: float
    height_mm: float
    boxes: tuple[Box, ...]
    outline: Box
    text: str


def sheet_of(plate: Plate, margin_m: float) -> Sheet:
    """Lay a flat plate out.

    Parameters
    ----------
    plate
        Its markers lie in one plane, upright.
    margin_m
        White border round the markers.

    Raises
    ------
    UsageError
        The plate is not flat and upright: print its planes one by one.
    """
    corners = plate.corners
    if np.ptp(corners[..., 2]) > 1e-6 or not np.allclose(corners[:, 0, 1], corners[:, 1, 1]):
        raise UsageError(
            "the plate has several planes, or turned markers",
            allowed="a flat plate of upright markers",
            remedy="print each plane from a board file of its own",
        )
    flat = corners.reshape(-1, 3)
    left, top = 1e3 * (flat[:, 0].min() - margin_m), 1e3 * (flat[:, 1].max() + margin_m)
    right, bottom = 1e3 * (flat[:, 0].max() + margin_m), 1e3 * (flat[:, 1].min() - margin_m)
    width, height = float(right - left), float(top - bottom)
    printed = print_of(plate)
    boxes = []
    for paper, frame in zip(printed.paper, printed.frame, strict=True):
        side = 1e3 * float(frame[0, 0])
        x, y = 1e3 * frame[0, 2] - left + MARGIN_MM, top - 1e3 * frame[1, 2] + MARGIN_MM
        boxes += _runs(1.0 - paper[PADDING:-PADDING, PADDING:-PADDING], float(x), float(y), side)
    size = 1e3 * float(np.linalg.norm(corners[0, 1] - corners[0, 0]))
    foot = MARGIN_MM + height
    boxes += [
        (MARGIN_MM, foot + 6.0, RULER_MM, 0.4),
        (MARGIN_MM, foot + 4.0, 0.4, 4.0),
        (MARGIN_MM + RULER_MM - 0.4, foot + 4.0, 0.4, 4.0),
    ]
    text = (
        f"{plate.dictionary}, ids {', '.join(map(str, plate.ids[:12]))}"
        f"{', ...' if len(plate.ids) > 12 else ''}, {size:g} mm; "
        f"the ruler is {RULER_MM:g} mm: print at 100 %, measure it"
    )
    return Sheet(
        max(width, RULER_MM, 1.9 * len(text) * 0.75) + 2 * MARGIN_MM,
        foot + FOOT_MM,
        tuple(boxes),
        (MARGIN_MM, MARGIN_MM, width, height),
        text,
    )


def _runs(black: np.ndarray, x: float, y: float, side: float) -> list[Box]:
    """Boxes of the black modules; those beside each other in a row are one, without a seam."""
    boxes: list[Box] = []
    for row, line in enumerate(black):
        edges = np.flatnonzero(np.diff(np.concatenate([[0.0], line, [0.0]])))
        for start, end in zip(edges[::2], edges[1::2], strict=True):
            boxes.append((x + start * side, y + row * side, (end - start) * side, side))
    return boxes


def write_sheet(sheet: Sheet, path: Path) -> None:
    """Write a sheet as PDF or SVG, by the name's ending.

    Raises
    ------
    UsageError
        Another ending.
    DataError
        The file cannot be written.
    """
    writers = {".svg": _svg, ".pdf": _pdf}
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise UsageError(f"{path.name}: unknown kind of file", allowed=" or ".join(writers))
    try:
        path.write_bytes(writer(sheet))
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}", where=str(path)) from None


def _svg(sheet: Sheet) -> bytes:
    rectangles = "\n".join(
        f'<rect x="{x:.4f}" y="{y:.4f}" width="{w:.4f}" height="{h:.4f}"/>'
        for x, y, w, h in sheet.boxes
    )
    x, y, w, h = sheet.outline
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{sheet.width_mm:.4f}mm" '
        f'height="{sheet.height_mm:.4f}mm" '
        f'viewBox="0 0 {sheet.width_mm:.4f} {sheet.height_mm:.4f}" shape-rendering="crispEdges">\n'
        '<rect width="100%" height="100%" fill="white"/>\n'
        f'<rect x="{x:.4f}" y="{y:.4f}" width="{w:.4f}" height="{h:.4f}" fill="none" '
        'stroke="#bbb" stroke-width="0.1"/>\n'
        f'{rectangles}\n<text x="{MARGIN_MM}" y="{sheet.height_mm - 4.0:.4f}" font-size="3" '
        f'font-family="sans-serif">{sheet.text}</text>\n</svg>\n'
    ).encode()


def _pdf(sheet: Sheet) -> bytes:
    """A PDF of one page, uncompressed."""
    scale, height = POINTS_PER_MM, sheet.height_mm
    lines = ["0 g"]
    lines += [
        f"{x * scale:.4f} {(height - y - h) * scale:.4f} {w * scale:.4f} {h * scale:.4f} re f"
        for x, y, w, h in sheet.boxes
    ]
    x, y, w, h = (value * scale for value in sheet.outline)
    lines.append(f"0.75 G 0.3 w {x:.4f} {height * scale - y - h:.4f} {w:.4f} {h:.4f} re S")
    text = sheet.text.replace("(", r"\(").replace(")", r"\)")
    lines.append(f"BT /F 8.5 Tf {MARGIN_MM * scale:.2f} {4.0 * scale:.2f} Td ({text}) Tj ET")
    content = "\n".join(lines)
    box = f"[0 0 {sheet.width_mm * scale:.4f} {height * scale:.4f}]"
    return _pdf_file(
        (
            "<< /Type /Catalog /Pages 2 0 R >>",
            "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
            f"<< /Type /Page /Parent 2 0 R /MediaBox {box} /Contents 4 0 R "
            "/Resources << /Font << /F 5 0 R >> >> >>",
            f"<< /Length {len(content)} >>\nstream\n{content}\nendstream",
            "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        )
    )


def _pdf_file(objects: Sequence[str]) -> bytes:
    out = b"%PDF-1.4\n"
    places = []
    for number, text in enumerate(objects, 1):
        places.append(len(out))
        out += f"{number} 0 obj\n{text}\nendobj\n".encode("latin-1", "replace")
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    return (
        out
        + (
            f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n{table}"
            f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R >>\nstartxref\n{len(out)}\n%%EOF\n"
        ).encode()
    )
