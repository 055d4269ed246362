"""The report: one page that needs nothing else, for light and dark, screen and phone."""

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from browser import WANTED, Browser, open_browser
from diagnosis_stand_ins import pictures, statement

from analysis.page.gather import Material
from analysis.page.page import page

PHONE, SCREEN = 390, 1280


def quantity(name: str, unit: str, measured: float, simulated: float) -> dict[str, Any]:
    error = 100.0 * abs(simulated - measured) / measured
    return {"name": name, "unit": unit, "measured": measured, "simulated": simulated,
            "relative_error_percent": error}  # fmt: skip


def compared(factor: float) -> dict[str, Any]:
    return {
        "angle": quantity("pitch", "deg", 1.92, 1.92 * factor),
        "tension": {c: quantity(f"tension {c}", "N", 7.46, 7.46 * factor) for c in ("1", "2", "7")},
    }


@pytest.fixture(scope="module")
def material() -> Material:
    plan = {
        "what": "record roll of 2 deg", "separates": ["cable_viscous"], "bits": 0.9, "minutes": 0.8,
        "bits_per_minute": 1.1, "command": "rig record --rig next_1.toml",
    }  # fmt: skip
    notes = ["a note with <b>markup</b> & an umlaut ä"]
    said = statement(next_experiment=plan, campaign=[plan], notes=notes)
    return Material("hand", said, pictures(), compared(1.057), compared(1.001), ())


@pytest.fixture(scope="module")
def written(material: Material, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page(material), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with open_browser() as one:
        yield one


class Tags(HTMLParser):
    """Every tag, and whether all are closed in order."""

    EMPTY = frozenset({"meta", "link", "img", "source"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_it_needs_nothing_else(written: Path) -> None:
    text = written.read_text(encoding="utf-8")
    tags = Tags(text)
    assert tags.open == []
    assert not any(tag in ("script", "iframe", "object") for tag, _ in tags.seen)
    links = [own.get(key) or "" for _, own in tags.seen for key in ("src", "href", "srcset")]
    assert all(link.startswith("data:") for link in links if link)
    assert "url(" not in re.sub(r'"data:[^"]*"', "", text)


def test_it_shows_all_that_was_found(written: Path) -> None:
    text = written.read_text(encoding="utf-8")
    headings = re.findall(r"<h2>(.*?)</h2>", text)
    for wanted in ("Before, where, after", "What was found", "On which side it is",
                   "What was ruled out", "The paper&#x27;s Section 5", "Causes",
                   "Where they differ", "Tension against elongation", "Rivals", "Before and after",
                   "Next experiment", "Provenance"):  # fmt: skip
        assert wanted in headings
    assert headings[0] == "Before, where, after"
    assert "tension of each cable beyond k ΔL" in text
    assert "0.25 ± 0.02 N" in text
    assert "5.70 %" in text
    assert "0.10 %" in text
    assert "Record roll of 2 deg." in text
    assert "rig record --rig next_1.toml" in text
    assert "&lt;b&gt;markup&lt;/b&gt; &amp; an umlaut ä" in text


def test_a_run_without_a_comparison_or_figures_has_a_page_too() -> None:
    said = statement("none", [], ruled_out=[], paper_guesses={}, parameters=[], improved_rig=None)
    text = page(Material("hand", said, None, None, None, ("the diagnosis",)))
    assert "Section 5" not in text
    assert "Nothing was left out that these runs show" in text
    assert "Made for this page: the diagnosis" in text


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [PHONE, SCREEN])
def test_it_fits_and_can_be_read(browser: Browser, written: Path, width: int, dark: bool) -> None:
    browser.look(written, width=width, dark=dark)
    assert browser.run("return window.innerWidth") == width
    assert browser.run("return document.documentElement.scrollWidth") <= width
    ink, paper = browser.run(
        "const s = getComputedStyle(document.body); return [s.color, s.backgroundColor]"
    )
    assert contrast(ink, paper) > 10.0
    assert (luminance(paper) < 0.1) == dark
    badge, behind = browser.run(
        "const s = getComputedStyle(document.querySelector('.verdict'));"
        "return [s.color, s.backgroundColor]"
    )
    assert contrast(badge, behind) > 4.5


def test_light_and_dark_phone_and_screen_have_figures_of_their_own(
    browser: Browser, written: Path
) -> None:
    shown = set()
    for width in (PHONE, SCREEN):
        for dark in (False, True):
            browser.look(written, width=width, dark=dark)
            pictures_ = browser.run(
                "return [...document.images].map(i => [i.alt, i.naturalWidth, i.complete,"
                " i.getBoundingClientRect().width, i.currentSrc.slice(-200)])"
            )
            assert len(pictures_) == 8
            for alt, natural, complete, wide, _ in pictures_:
                assert len(alt) > 30
                assert complete
                assert natural > 300
                assert wide <= width
            shown.add(tuple(one[4] for one in pictures_))
    assert len(shown) == 4


def test_nothing_is_fetched(browser: Browser, written: Path) -> None:
    browser.requests()
    browser.look(written, width=SCREEN, dark=False)
    asked = browser.requests()
    assert written.resolve().as_uri() in asked
    outside = [url for url in asked if not url.startswith(("data:", written.resolve().as_uri()))]
    assert outside == []


def test_where_a_browser_is_wanted_its_absence_fails_and_elsewhere_it_skips(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    monkeypatch.setenv(WANTED, "1")
    with pytest.raises(pytest.fail.Exception, match="apt-get install chromium"), open_browser():
        pass
    monkeypatch.delenv(WANTED)
    with pytest.raises(pytest.skip.Exception, match="no chromium"), open_browser():
        pass


def luminance(colour: str) -> float:
    """Of a CSS colour, by WCAG."""
    parts = [float(one) / 255.0 for one in re.findall(r"[\d.]+", colour)[:3]]
    linear = [p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Between two CSS colours, by WCAG: 1 to 21."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)
