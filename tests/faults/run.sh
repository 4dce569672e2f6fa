# shellcheck shell=bash disable=SC2154
# SPDX-License-Identifier: BSD-3-Clause
# Shared by tests/run_faults, run_kills and run_determinism (sourced, bash), which set `program`, `variables` and `usage`.
root=$(dirname -- "$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")")
. "$root/resources/setup/common.sh"
preset=ci
[ "$program" != test_kills ] || variables=(GLINT_KILLS=1000)
while [ $# -gt 0 ]; do
  case "$1" in
    --help|-h) usage; exit 0 ;;
    --preset|--piece|--count|--seed)
      [ $# -ge 2 ] || die "$1 needs a value (see --help)"
      case "$1" in
        --preset) preset=$2 ;;
        --piece) variables+=("GLINT_PIECE=$(realpath -m -- "$2")") ;;
        --count) variables+=("GLINT_KILLS=$2") ;;
        --seed) variables+=("GLINT_SEED=$2") ;;
      esac
      shift 2 ;;
    *) break ;;
  esac
done
file="$root/build/$preset/bin/$program"
[ -x "$file" ] || die "$file is missing: build the preset first"
cd "$root"
exec env "${variables[@]}" "$file" --gtest_brief=1 "$@"
