"""The example of docs/engine.md runs, and prints what it says."""

import re
from pathlib import Path

DOCUMENT = Path(__file__).parents[2] / "docs" / "engine.md"


def test_the_documented_example_prints_what_it_says(capsys) -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    assert len(example.splitlines()) <= 60
    ran: dict[str, object] = {}
    exec(compile(example, str(DOCUMENT), "exec"), ran)
    (said,) = re.findall(r"It prints `(.*?)`", text)
    assert capsys.readouterr().out.strip() == said
    (printed,) = re.findall(r"```text\n(weight.*?)```", text, flags=re.DOTALL)
    # Last digits are the processor's.
    assert [_words(line) for line in str(ran["found"]).splitlines()] == [
        _words(line) for line in printed.splitlines()
    ]


def _words(line: str) -> str:
    return re.sub(r"\d[\d.e-]*", "0", line)
