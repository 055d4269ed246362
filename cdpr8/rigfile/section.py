"""What every section of a rig file is made of."""

from pydantic import BaseModel, ConfigDict

Vector = tuple[float, float, float]


class Section(BaseModel):
    """A table of the rig file: unknown keys are refused, values cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)
