#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws docs/pictures/*.png again: the inspector on each shipped session, dark and light, and what `glint render` makes of it.
# Usage: docs/make_pictures.sh   (GLINT_BIN=FOLDER: where the programs are; default build/release/bin). Needs xvfb-run.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
bin=${GLINT_BIN:-$root/build/release/bin}
out=$root/docs/pictures
mkdir -p "$out"
for session in "$root"/sessions/*/*.glint; do
  name=$(basename "$session" .glint)
  for theme in dark light; do
    QT_QPA_PLATFORM=xcb xvfb-run -a -s "-screen 0 1600x1000x24" "$bin/glint-inspector" "$session" --theme "$theme" \
      --size 1500x940 --screenshot "$out/$name-inspector-$theme.png" --wait-idle
  done
  for view in scene frame ladder plots; do
    "$bin/glint" render "$session" --view "$view" --size 960x600 -o "$out/$name-$view.png"
  done
done
# A palette is enough for pictures of text and lines, and a quarter of the size.
if command -v mogrify > /dev/null; then mogrify -strip -colors 96 -define png:compression-level=9 "$out"/*.png; fi
du -sh "$out"
