import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.fixture(scope="session")
def command():
    """The command `magcomp`, which tests/python.sh builds."""
    return os.environ["MAGCOMP_COMMAND"]
