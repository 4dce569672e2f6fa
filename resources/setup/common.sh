# shellcheck shell=bash disable=SC2154
# SPDX-License-Identifier: BSD-3-Clause
# Shared by glint-run and glint-test (sourced, bash): what to install, how to configure and build, which display to use.
# The caller sets `root` to the project's folder.

say() { printf 'glint: %s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

# missing_packages FILE: names of the packages listed there that are not installed.
missing_packages() {
  local package status
  while read -r package; do
    case "$package" in ''|'#'*) continue ;; esac
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || status=
    [ "$status" = installed ] || echo "$package"
  done < "$1"
}

# install_missing [FILE]: installs what is missing of a list, and only that. Nothing is removed or upgraded on purpose: --no-remove makes apt
# refuse instead.
install_missing() {
  local list=${1:-$root/resources/setup/packages-debian12.txt}
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "no apt: the packages in ${list#"$root/"} must be installed already"
    return 0
  fi
  local missing
  mapfile -t missing < <(missing_packages "$list")
  [ ${#missing[@]} -gt 0 ] || return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "packages are missing, and neither root nor sudo is available to install them; as root, run:
  apt-get install --no-remove --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  # A machine that is thrown away need not wait for the disk after each package.
  local options=(-o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300)
  [ "${CI:-}" != true ] || options+=(-o Dpkg::Options::=--force-unsafe-io)
  say "installing ${#missing[@]} missing packages: ${missing[*]}"
  "${as_root[@]}" apt-get update -q </dev/null || say "apt-get update failed; using the package lists at hand"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-remove --no-install-recommends \
    "${options[@]}" "${missing[@]}" </dev/null ||
    die "apt-get cannot install the packages above"
}

# Parallel compile jobs: GLINT_JOBS, else one per core, but no more than the memory carries (the largest files take 1.5 GB).
build_jobs() {
  if [ -n "${GLINT_JOBS:-}" ]; then
    case "$GLINT_JOBS" in *[!0-9]*|0*) die "GLINT_JOBS must be a whole number of at least 1, not '$GLINT_JOBS'" ;; esac
    echo "$GLINT_JOBS"
    return
  fi
  local cores gigabytes
  cores=$(nproc 2>/dev/null || echo 1)
  gigabytes=$(awk '/^MemAvailable:/ {print int($2 / 1572864)}' /proc/meminfo 2>/dev/null)
  [ -n "$gigabytes" ] || gigabytes=$cores
  [ "$gigabytes" -ge 1 ] || gigabytes=1
  if [ "$cores" -le "$gigabytes" ]; then echo "$cores"; else echo "$gigabytes"; fi
}

# The compiler of the builds that scripts make, as options of CMake: clang, which takes about two thirds of gcc's time, unless the
# user names one (CC, CXX) or clang is not there.
compiler_options() {
  if [ -z "${CC:-}${CXX:-}" ] && command -v clang >/dev/null && command -v clang++ >/dev/null; then
    echo -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
  fi
}

# configure PRESET: skipped when the build folder is up to date (ninja itself reconfigures when a CMakeLists.txt changed).
configure() {
  local preset=$1 folder="$root/build/$1" home
  if [ -f "$folder/build.ninja" ] && [ "$folder/build.ninja" -nt "$root/CMakePresets.json" ]; then
    home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$folder/CMakeCache.txt")
    [ "$home" != "$root" ] || return 0
    say "the project was moved; configuring again"
  fi
  say "configuring (preset $preset)"
  # Scripts build whole programs: several files as one take half the time. GLINT_UNITY=OFF for a build in which files change often.
  # shellcheck disable=SC2046  # words, each an option
  (cd "$root" && cmake --fresh --preset "$preset" "-DGLINT_UNITY=${GLINT_UNITY:-ON}" $(compiler_options))
}

# build PRESET [TARGET...]: everything, or only the targets.
build() {
  local preset=$1 jobs
  shift
  jobs=$(build_jobs) || exit 1
  say "building (preset $preset, $jobs jobs)"
  local targets=()
  [ $# -eq 0 ] || targets=(--target "$@")
  (cd "$root" && cmake --build --preset "$preset" -j "$jobs" "${targets[@]}" </dev/null)
}

# hard_ground BUILD: assignments for env, one a line: a locale with a decimal comma, which every program sets before main, as Qt does (of numbers
# only: messages of the system stay in English, which tests compare), and new and freed memory full of a pattern.
hard_ground() {
  printf '%s
' LC_NUMERIC=de_DE.UTF-8 "LOCPATH=$1/locale" "LD_PRELOAD=$1/locale/comma_locale.so" MALLOC_PERTURB_=165
}

# True when the session has a display that answers: a local one must have its socket.
have_display() {
  local number
  [ -n "${DISPLAY:-}" ] || return 1
  case "$DISPLAY" in
    :*) number=${DISPLAY#:}; number=${number%%.*}; [ -S "/tmp/.X11-unix/X$number" ] ;;
    *) return 0 ;;
  esac
}

# on_virtual_display COMMAND...: runs it on a display of its own, drawn in software. Qt's "offscreen" platform is no way out:
# it leaves VTK's views blank without an error. -noreset: else the server starts again when its last client leaves, and refuses whoever
# connects meanwhile, as tests beside each other do.
on_virtual_display() {
  command -v xvfb-run >/dev/null || die "no display, and no xvfb-run for a virtual one (packages xvfb and xauth)"
  env -u WAYLAND_DISPLAY QT_QPA_PLATFORM=xcb LIBGL_ALWAYS_SOFTWARE=1 \
    xvfb-run -a -s "-screen 0 1600x1000x24 -nolisten tcp -noreset" "$@" </dev/null
}
