"""The example of docs/engine.md runs, and prints what it says."""

import re
from pathlib import Path

DOCUMENT = Path(__file__).parents[2] / "docs" / "engine.md"


def test_the_documented_example_prints_what_it_says(capsys) -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    assert len(example.splitlines()) <= 60
    exec(compile(example, str(DOCUMENT), "exec"), {})
    (said,) = re.findall(r"It prints `(.*?)`", text)
    assert capsys.readouterr().out.strip() == said
