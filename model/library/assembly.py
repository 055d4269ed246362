"""The text that calls every law of the plant, in either kernel: written from the effects found.

One kernel serves all combinations of effects: each law stands behind a switch that is read at run
time. So a new effect needs no change of the kernel, and a new combination no compiler.
"""

from collections.abc import Callable, Iterable
from inspect import signature
from typing import Any

from cdpr8 import CABLES
from model.library import context
from model.library.discovery import first_parameters, kernel_effects
from model.library.effect import Acts, Effect, Law
from model.library.lanes import CABLE, LANES, WORK, number_of

Find = Callable[[str], str]
"""From a name a law asks for to the expression that gives it."""


def laws() -> dict[str, Law]:
    """Every law the text calls, by the name it calls it."""
    return {
        _called(effect, hook): law
        for effect in kernel_effects()
        for hook in ("pull", "behind", "rates", "transverse", "across", "wrench")
        if (law := getattr(effect, hook)) is not None
    }


def text() -> str:
    """All functions."""
    parts = (
        _scalar_pull(),
        _scalar_rates(),
        _scalar_wrench(),
        _lane_pull(),
        _lane_rates(),
        _lane_wrench(),
    )
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _called(effect: Effect, hook: str) -> str:
    return f"{effect.name}_{hook}"


def _call(effect: Effect, hook: str, find: Find) -> str:
    """The call of a law, each argument found by its name."""
    law: Any = getattr(effect, hook)
    arguments = ", ".join(find(name) for name in signature(law).parameters)
    return f"{_called(effect, hook)}({arguments})"


def _cable_effects() -> Iterable[tuple[int, Effect]]:
    """Those of the cable before those at the pulley, which is pulled by both."""
    numbered = enumerate(kernel_effects())
    found = ((number, effect) for number, effect in numbered if effect.acts is not Acts.PLATFORM)
    return sorted(found, key=lambda one: one[1].acts is Acts.PULLEY)


def _platform_effects() -> Iterable[tuple[int, Effect]]:
    return (
        (number, effect)
        for number, effect in enumerate(kernel_effects())
        if effect.acts is Acts.PLATFORM
    )


def _switch(number: int) -> str:
    """Whether an effect is on: a bit of a word that is read once."""
    return f"    if on & {1 << number}:"


def _own(effect: Effect, name: str) -> tuple[str, int] | None:
    """Whether a name is a parameter or a state of the effect, and which."""
    for number, parameter in enumerate(effect.parameters):
        if parameter.name == name:
            return "parameter", first_parameters()[effect.name] + number
    for number, state in enumerate(effect.states):
        if state.name == name:
            return "state", number
    return None


# The scalar kernel.


def rated() -> int:
    """Bits of the effects that have states, shake their cable, or pull across it."""
    return sum(1 << number for number, effect in _cable_effects() if _has_rates(effect))


def _has_rates(effect: Effect) -> bool:
    return any(law is not None for law in (effect.rates, effect.transverse, effect.across))


def _scalar_find(effect: Effect, number: int, *, pulling: bool = False) -> Find:
    column = "0" if effect.acts is Acts.PLATFORM else "i"

    def find(name: str) -> str:
        own = _own(effect, name)
        if name == "before_pulley" and pulling:
            return "(line.elastic + pull)"
        if own is None:
            known = context.PLATFORM if effect.acts is Acts.PLATFORM else context.CABLE
            return known[name][1] if name in known else f"numbers[{column}, {number_of(name)}]"
        kind, which = own
        if kind == "parameter":
            return f"numbers[{column}, {CABLE['values'] + which}]"
        return f"state[{_scalar_state(effect, number, which)}]"

    return find


def _scalar_state(effect: Effect, number: int, which: int) -> str:
    cable = "carrier[i]" if effect.states[which].shared else "i"
    return f"offset[{number}] + {which * CABLES} + {cable}"


def _scalar_pull() -> list[str]:
    lines = [
        "def cable_pull(i, on, line, state, offset, carrier, numbers):",
        "    pull, behind = 0.0, 0.0",
    ]
    for number, effect in _cable_effects():
        find = _scalar_find(effect, number, pulling=True)
        if effect.pull is None:
            continue
        lines.append(_switch(number))
        lines.append(f"        added = {_call(effect, 'pull', find)}")
        lines.append("        pull += added")
        if effect.behind is not None:
            lines.append(f"        behind += {_call(effect, 'behind', find)}")
        elif effect.acts is Acts.PULLEY:
            lines.append("        behind += added")
    return [*lines, "    return pull, behind"]


def _scalar_rates() -> list[str]:
    lines = [
        "def cable_rates(i, on, line, state, offset, carrier, numbers, rate):",
        "    f0, f1, f2 = 0.0, 0.0, 0.0",
    ]
    for number, effect in _cable_effects():
        find = _scalar_find(effect, number)
        if not _has_rates(effect):
            continue
        lines.append(_switch(number))
        if effect.transverse is not None:
            lines.append(f"        r0, r1 = {_call(effect, 'transverse', find)}")
            lines += [f"        rate[{12 + k * CABLES} + i] += r{k}" for k in range(2)]
        if effect.rates is not None:
            lines.append(f"        {_received(effect)} = {_call(effect, 'rates', find)}")
            for which in range(len(effect.states)):
                place = _scalar_state(effect, number, which)
                lines.append(f"        rate[{place}] += r{which}")
        if effect.across is not None:
            lines.append(f"        a0, a1, a2 = {_call(effect, 'across', find)}")
            lines += [f"        f{k} += a{k}" for k in range(3)]
    return [*lines, "    return f0, f1, f2"]


def _received(effect: Effect) -> str:
    return ", ".join(f"r{which}" for which in range(len(effect.states)))


def _scalar_wrench() -> list[str]:
    lines = [
        "def platform_wrench(on, state, velocity, omega, offset, numbers):",
        "    f0, f1, f2, f3, f4, f5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0",
    ]
    for number, effect in _platform_effects():
        lines.append(_switch(number))
        find = _scalar_find(effect, number)
        lines.append(f"        a0, a1, a2, a3, a4, a5 = {_call(effect, 'wrench', find)}")
        lines += [f"        f{k} += a{k}" for k in range(6)]
    return [*lines, "    return (f0, f1, f2), (f3, f4, f5)"]


# The lane kernel: `own` and `q` hold numbers, `y` states, `f` their rates, `work` the rest. A part
# of `y` that starts at 0 spares the vector loops a gather. All states of a law are in one part, a
# fixed way apart: of a part for each the compiler cannot tell that none overlaps, and leaves the
# loop as it is. How many lanes there are is read from `work`: a short loop of a known length is
# rolled out before it is made one of vectors, and then is none.

_EACH_LANE = "        for w in range(lanes):"
_COUNT_LANES = f"    lanes = work.size // {WORK['end']}"


def _lane_find(effect: Effect, *, pulling: bool = False) -> Find:
    of_platform = effect.acts is Acts.PLATFORM
    numbers = "q" if of_platform else "own"
    coordinates = ("x", "y", "z", "roll", "pitch", "yaw")

    def find(name: str) -> str:
        own = _own(effect, name)
        if own is not None and own[0] == "state":
            return _lane_state(effect, "s", own[1])
        if own is not None:
            return f"{numbers}[{(CABLE['values'] + own[1]) * LANES} + w]"
        if of_platform and name in coordinates:
            return f"y[{coordinates.index(name) * LANES} + w]"
        if name in context.NUMBERS:
            return f"own[{number_of(name) * LANES} + w]"
        if name == "before_pulley":
            pull = f"work[{WORK['pull'] * LANES} + w]"
            rest = "+ work[{}" if pulling else "- work[{}"
            return f"({pull} {rest.format(WORK['elastic' if pulling else 'behind'] * LANES)} + w])"
        return f"work[{_work_slot('pull' if name == 'tension' else name) * LANES} + w]"

    return find


def _work_slot(name: str) -> int:
    if name in WORK:
        return WORK[name]
    vector, axis = name.rsplit("_", 1)
    return WORK[vector] + "xyz".index(axis)


def _lane_state(effect: Effect, of: str, which: int) -> str:
    """A state, or its rate: that of the cable, or of the one that carries it for several."""
    shared = "_shared" if effect.states[which].shared else ""
    return f"{of}{shared}[{which * CABLES * LANES} + w]"


def _lane_states(effect: Effect, number: int, rates: bool) -> list[str]:
    lines = []
    span = ((len(effect.states) - 1) * CABLES + 1) * LANES
    for shared in sorted({state.shared for state in effect.states}):
        cable, name = ("carrier[i]", "_shared") if shared else ("i", "")
        lines.append(f"        at = (offset[{number}] + {cable}) * {LANES}")
        lines.append(f"        s{name} = y[at : at + {span}]")
        if rates:
            lines.append(f"        d{name} = f[at : at + {span}]")
    return lines


def _lane_pull() -> list[str]:
    pull, behind = WORK["pull"] * LANES, WORK["behind"] * LANES
    lines = ["def lane_pull(i, on, offset, carrier, own, y, work):", _COUNT_LANES]
    for number, effect in _cable_effects():
        if effect.pull is None:
            continue
        find = _lane_find(effect, pulling=True)
        lines += [_switch(number), *_lane_states(effect, number, False)]
        lines.append(_EACH_LANE)
        lines.append(f"            added = {_call(effect, 'pull', find)}")
        lines.append(f"            work[{pull} + w] += added")
        if effect.behind is not None:
            lines.append(f"            work[{behind} + w] += {_call(effect, 'behind', find)}")
        elif effect.acts is Acts.PULLEY:
            lines.append(f"            work[{behind} + w] += added")
    return [*lines, "    return"]


def _lane_rates() -> list[str]:
    lines = ["def lane_rates(i, on, offset, carrier, own, y, work, f):", _COUNT_LANES]
    for number, effect in _cable_effects():
        if not _has_rates(effect):
            continue
        find = _lane_find(effect)
        lines += [_switch(number), *_lane_states(effect, number, True)]
        if effect.transverse is not None:
            lines.append(f"        at = (12 + i) * {LANES}")
            lines.append(f"        m = f[at : at + {(CABLES + 1) * LANES}]")
            lines.append(_EACH_LANE)
            lines.append(f"            r0, r1 = {_call(effect, 'transverse', find)}")
            lines += [f"            m[{k * CABLES * LANES} + w] += r{k}" for k in range(2)]
        if effect.rates is not None:
            lines.append(_EACH_LANE)
            lines.append(f"            {_received(effect)} = {_call(effect, 'rates', find)}")
            for which in range(len(effect.states)):
                lines.append(f"            {_lane_state(effect, 'd', which)} += r{which}")
        if effect.across is not None:
            lines += _lane_across(effect, find)
    return [*lines, "    return"]


def _lane_across(effect: Effect, find: Find) -> list[str]:
    force, moment = WORK["force"], WORK["moment"]
    arm = [f"work[{(WORK['arm'] + k) * LANES} + w]" for k in range(3)]
    lines = [
        _EACH_LANE,
        f"            a0, a1, a2 = {_call(effect, 'across', find)}",
    ]
    lines += [f"            work[{(force + k) * LANES} + w] += a{k}" for k in range(3)]
    for k in range(3):
        one, other = (k + 1) % 3, (k + 2) % 3
        lever = f"{arm[one]} * a{other} - {arm[other]} * a{one}"
        lines.append(f"            work[{(moment + k) * LANES} + w] += {lever}")
    return lines


def _lane_wrench() -> list[str]:
    lines = ["def lane_wrench(on, q, y, work):", _COUNT_LANES]
    for number, effect in _platform_effects():
        find = _lane_find(effect)
        lines.append(_switch(number))
        lines.append(_EACH_LANE)
        lines.append(f"            a0, a1, a2, a3, a4, a5 = {_call(effect, 'wrench', find)}")
        for k in range(6):
            slot = (WORK["force"] + k) * LANES
            lines.append(f"            work[{slot} + w] += a{k}")
    return [*lines, "    return"]
