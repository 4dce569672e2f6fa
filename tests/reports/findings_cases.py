# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py."""
from run import lacks, near, says  # noqa: F401
