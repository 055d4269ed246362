"""The effects that are there: every module of `model.effects` that holds an `EFFECT`."""

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType, ModuleType

from model.library.effect import Effect


@cache
def effect_modules() -> tuple[ModuleType, ...]:
    """The modules of `model.effects`, by name."""
    import model.effects

    names = sorted(one.name for one in iter_modules(model.effects.__path__))
    return tuple(import_module(f"model.effects.{name}") for name in names)


@cache
def library() -> Mapping[str, Effect]:
    """All effects by name."""
    effects = [module.EFFECT for module in effect_modules()]
    return MappingProxyType({effect.name: effect for effect in effects})


@cache
def kernel_effects() -> tuple[Effect, ...]:
    """The effects that are built into the kernel, in the order in which it numbers them."""
    return tuple(effect for effect in library().values() if effect.acts.in_kernel)


@cache
def first_parameters() -> Mapping[str, int]:
    """Row of each kernel effect's first parameter in the kernel's table of values."""
    rows, row = {}, 0
    for effect in kernel_effects():
        rows[effect.name] = row
        row += len(effect.parameters)
    return MappingProxyType(rows)


@cache
def parameter_rows() -> int:
    """Rows of the kernel's table of values."""
    return sum(len(effect.parameters) for effect in kernel_effects())
