"""What an amplifier does to its digits before it sends them: read, judged, never changed.

The host scales from the factory curve (protocol note, section 6). A curve of the user's, a
linearisation or a zero set at power-on would make the same digits mean another force, and nothing
in a value shows it. So these are read before a run and a run is refused where they are not the
factory's: they are somebody's calibration, and to write LDW or LWT clears the tare (section 4).

SZA and SFA, the factory curve itself, are not asked for: without its question mark, which a line
may lose, the question would measure the curve anew.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rig.amplifier.message import REFUSED

Numbers = tuple[int, ...]

UNKNOWN = REFUSED.decode("ascii").strip()
"""The answer of a dialect that has no such setting."""

_UNTIL_OFF = " Then switch it off and on."


@dataclass(frozen=True)
class OwnSetting:
    """One setting that changes digits.

    Attributes
    ----------
    factory
        The answer, in numbers, that leaves the digits alone; only as many are compared.
    meaning
        What another answer does.
    restore
        The commands that put it back, from what was read.
    after
        What else it takes.
    """

    factory: Numbers
    meaning: str
    restore: Callable[[Numbers], str]
    after: str = ""


def _user_curve(_: Numbers) -> str:
    return "LDW0;LWT1000000;"


JUDGED = {
    "LDW": OwnSetting((0,), "a dead weight is taken off", _user_curve),
    "LWT": OwnSetting((1_000_000,), "the span is the user's", _user_curve),
    "LIC": OwnSetting(
        (0, 1_000_000, 0, 0),
        "values are linearised inside",
        lambda _: "LIC0,0;LIC1,1000000;LIC2,0;LIC3,0;",
    ),
    "ZSE": OwnSetting((0,), "a zero is taken at power-on", lambda _: "ZSE0;", _UNTIL_OFF),
    "TRC": OwnSetting(
        (0,),
        "only triggered values are given",
        lambda found: "TRC" + ",".join(str(each) for each in (0, *found[1:])) + ";",
    ),
}
"""A run is refused where one of these is not the factory's."""

SET_FOR_THE_RUN = ("NOV", "TAS", "ZTR")

AS_FOUND = (*SET_FOR_THE_RUN, "TAV", "CWT", "RSN")
"""Settings that are told but refuse no run: the first three are written for the run (not saved),
TAV is not in gross values, CWT matters only while LWT is measured, RSN makes the digits coarser.
"""


def numbers(answer: str) -> Numbers:
    """The numbers of an answer; none where the setting is not known."""
    return () if answer == UNKNOWN else tuple(int(word) for word in answer.split(","))


def deviations(settings: Mapping[str, str]) -> dict[str, str]:
    """Settings that make digits mean something else: mnemonic -> answer and what it does."""
    found = {}
    for mnemonic, own in JUDGED.items():
        answer = numbers(settings.get(mnemonic, UNKNOWN))[: len(own.factory)]
        if answer and answer != own.factory:
            found[mnemonic] = f"{mnemonic} is {settings[mnemonic]}: {own.meaning}"
    return found


def allowed(mnemonics: Mapping[str, str]) -> str:
    """What those settings must be."""
    return ", ".join(
        f"{each} {','.join(str(number) for number in JUDGED[each].factory)}" for each in mnemonics
    )


def remedy(settings: Mapping[str, str], address: int, password: str) -> str:
    """How to put back what deviates, to be typed into any serial terminal."""
    wrong = list(deviations(settings))
    commands = dict.fromkeys(JUDGED[each].restore(numbers(settings[each])) for each in wrong)
    after = "".join(dict.fromkeys(JUDGED[each].after for each in wrong))
    curve = {"LDW", "LWT"} & set(wrong)
    return (
        "write the values down first; then from a serial terminal send "
        f'`;S{address:02d};SPW"{password}";{"".join(commands)}TDD1;`'
        + (" (this clears its tare)" if curve else "")
        + f".{after} The toolkit changes none of them; `rig scan` tells of all amplifiers"
    )


def concerns(settings: Mapping[str, str], found: Mapping[str, str]) -> list[str]:
    """What a user must know though the run is not refused.

    Parameters
    ----------
    settings
        As read back before the run.
    found
        Those of `AS_FOUND`, as they were before anything was written.
    """
    told = {name: numbers(answer) for name, answer in found.items()}
    words = []
    untold = [each for each in JUDGED if settings.get(each) == UNKNOWN]
    untold += [each for each in SET_FOR_THE_RUN if found.get(each) == UNKNOWN]
    if untold:
        words.append(
            f"does not tell its {', '.join(untold)}: the tensions are right only if it has none"
        )
    if told.get("NOV", (0,)) not in ((0,), ()):
        words.append(f"scales by itself (NOV {found['NOV']}): off while recording, not for good")
    if told.get("ZTR", ())[:1] == (1,):
        words.append(
            "tracks its zero (ZTR 1): off while recording; what it took off before is not known. "
            "Take the zeros again with `rig zero`"
        )
    if told.get("TAS") == (0,) and told.get("TAV", (0,)) != (0,):
        words.append(
            f"is tared (TAV {found['TAV']}): the tare is left alone and is not in the values. "
            "Zeros are the host's, `rig zero`"
        )
    if told.get("RSN", (1,)) not in ((1,), ()):
        words.append(f"gives digits in steps of {told['RSN'][0]} (RSN)")
    return words
