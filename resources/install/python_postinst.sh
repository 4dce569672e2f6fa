#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
set -e
if command -v py3compile >/dev/null 2>&1; then
  py3compile -p python3-glint
fi
