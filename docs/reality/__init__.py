# SPDX-License-Identifier: BSD-3-Clause
"""The reality ladder: what docs/make_reality.py runs and how it judges."""
