# SPDX-License-Identifier: BSD-3-Clause
"""Lines of the audit: each module here holds checks that docs/make_audit.py runs."""
