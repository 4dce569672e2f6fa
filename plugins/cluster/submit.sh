#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# plugins/cluster/submit.sh STUDY.json [SBATCH-ARGUMENTS...]: what is left of a study as one Slurm array, and a job that merges behind it.
# The same command goes on where an earlier run was stopped. Folders of the study must be the same on all nodes.
set -euo pipefail
[ $# -ge 1 ] || { echo "usage: submit.sh STUDY.json [SBATCH-ARGUMENTS...]" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
study=$(realpath "$1")
shift
left=$(python3 "$here/study.py" "$study" left)
mkdir -p "$(dirname "$study")/logs"
logs=$(dirname "${study//%/%%}")/logs  # Slurm takes % in names of files as a pattern
# The jobs get the names by the environment: in --export a comma would end them, in a command line a quote.
export STUDY=$study STUDY_PY=$here/study.py
after=()
if [ -n "$left" ]; then
  array=$(sbatch --parsable --array="$left" --output="$logs/%a.txt" --export=ALL "$@" "$here/study.sbatch")
  echo "array $array: shards $left"
  after=(--dependency="afterok:${array%%;*}")
fi
merge=$(sbatch --parsable --export=ALL --kill-on-invalid-dep=yes --job-name=glint-merge --output="$logs/merge.txt" "${after[@]}" --wrap='exec python3 "$STUDY_PY" "$STUDY" merge')
echo "merge ${merge%%;*}"
