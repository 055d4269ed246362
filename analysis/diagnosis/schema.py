"""The form of `diagnose.json` (design, section 6), from which its JSON Schema is made."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Verdict = Literal["none", "parameter", "explained", "ambiguous", "unexplained", "not asked"]

Side = Literal["plant", "parameter", "drive", "cell", "camera", "clock"]


class Open(BaseModel):
    """Keys beside those named here are allowed: a reader must pass over them."""

    model_config = ConfigDict(extra="allow")


class Where(Open):
    """Where a cause acts."""

    side: Side
    cables: list[int] = Field(description="1 to 8; empty where there is no choice")
    or_cables: list[list[int]] = Field(
        default=[], description="sets of cables where it might as well be, within 20 to 1"
    )
    when: str
    harmonics: list[int]


class Parameter(Open):
    """One number of a cause."""

    value: float = Field(description="the mean, where cables differ")
    sigma: float = Field(ge=0.0)
    cables: dict[str, float] | None = None


class Cause(Open):
    """One cause of the mismatch."""

    effect: str
    probability: float = Field(ge=0.0, le=1.0)
    where: Where
    parameters: dict[str, Parameter]
    indistinguishable_from: list[str]


class Remains(Open):
    """What is left when the causes are in."""

    significant: bool
    where: str | None
    not_followed: list[str] = Field(
        default=[], description="runs that the causes do not explain; they were not counted"
    )
    shown: bool = Field(
        default=False,
        description="samples show the causes; with these too no simulation follows them",
    )
    foretold_until_s: float | None = Field(
        default=None, description="what was recorded later was not counted: nothing foretells it"
    )
    begins_s: float | None = Field(
        default=None, description="when something begins at once that nothing explains"
    )
    begins_in: str | None = Field(default=None, description="the channel where it is loudest")


class Parts(Open):
    """Rms of the residual over the noise, by kind of channel."""

    used: dict[str, float]
    held_out: dict[str, float]


class Fit(Open):
    """The fit before and after, beside the noise."""

    noise: dict[str, Any]
    before: Parts
    after: Parts


class Experiment(Open):
    """The cheapest next experiment."""

    what: str
    separates: list[str]


class Residual(Open):
    """What one of the three residuals sees."""

    residual: Literal["cables", "platform", "inner"]
    sees: Literal["yes", "no", "cannot tell"]
    where: list[str] = Field(description="rows that stand out; empty where it sees nothing")
    sigmas: float = Field(ge=0.0, description="of the row that stands out most")


class Balance(Open):
    """The three residuals of one run."""

    run: str
    residuals: list[Residual]
    means: str


class Likely(Open):
    """An effect that is not named, and likely all the same."""

    effect: str
    probability: float = Field(ge=0.0, le=1.0)


class Limit(Open):
    """From which size on a number of an effect would not have gone unnoticed."""

    effect: str
    parameter: str
    unit: str
    everywhere: float | None = Field(
        description="in all cables alike, or where it has no choice; null: at no plausible size"
    )
    placed: bool = Field(description="whether it may be in some cables only")
    in_one_cable: float | None = Field(description="in any one cable; null as above")


class Amount(Open):
    """A term of a cable's measured state with its coefficient, in SI units."""

    term: str
    value: float
    sigma: float = Field(ge=0.0)
    unit: str


class Proposed(Amount):
    """A term that sparse regression chose."""

    chosen_share: float = Field(ge=0.0, le=1.0, description="of the resamples")
    alternatives: list[Amount] = Field(description="what does as well in its place")


class Proposal(Open):
    """A law for what is missing in a cable: a proposal, not a finding."""

    cables: list[int]
    terms: list[Proposed]
    explains_share_held_out: float = Field(
        ge=0.0, le=1.0, description="of the square beyond noise, on stretches not used"
    )
    note: str = Field(description="that it is a proposal, and what to check it with")


class Statement(Open):
    """A diagnosis."""

    verdict: Verdict
    causes: list[Cause]
    not_ruled_out: list[Likely] = Field(
        default=[], description="where the verdict is none: effects likelier than a tenth"
    )
    limits: list[Limit] = Field(
        default=[], description="where the verdict is none: what would not have gone unnoticed"
    )
    remains: Remains
    fit: Fit
    next_experiment: Experiment | None
    improved_rig: str | None
    balance: list[Balance] = Field(
        default=[], description="runs that tell on which side it is; empty where none can"
    )
    proposal: list[Proposal] = Field(
        default=[], description="where something is unexplained: laws that the data propose"
    )


def statement_schema() -> dict[str, Any]:
    """The JSON Schema of `diagnose.json` and of what `--json` prints."""
    return Statement.model_json_schema()
