# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest


@pytest.fixture(scope="session")
def program():
    """The command line, as CTest names it."""
    path = os.environ.get("GLINT_PROGRAM")
    if not path:
        pytest.skip("GLINT_PROGRAM does not name the program glint")
    return path
