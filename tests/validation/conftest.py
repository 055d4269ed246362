import pytest

from tests.validation.shared import folder


@pytest.fixture(scope="session")
def recordings():
    """Skips where the recordings of other people are not at hand."""
    try:
        for name in ("emps", "silverbox", "cascaded_tanks"):
            folder(name)
    except FileNotFoundError as error:
        pytest.skip(str(error))
