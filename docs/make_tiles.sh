#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws the pictures of the start page, resources/tiles/*.png, from the shipped sessions, and the list that the program is built with.
# Usage: docs/make_tiles.sh   (GLINT_BIN=FOLDER: where glint is; default build/release/bin). Needs ImageMagick's convert, and Xvfb or a display.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
bin=${GLINT_BIN:-$root/build/release/bin}
out=$root/resources/tiles
most=20000  # bytes a picture: all of them are part of the program
mkdir -p "$out"
large=$(mktemp --suffix=.png)
trap 'rm -f -- "$large"' EXIT

tile() {  # NAME SESSION FRAME LAYERS
  "$bin/glint" render "$root/sessions/$2/${2##*/}.glint" --frame "$3" "--layers=none,$4" --theme dark --glyphs 1.3 --size 880x550 -o "$large" > /dev/null
  # Without the legend at the left and the bar at the bottom, at twice the size that it is shown at.
  convert "$large" -crop 640x400+200+90 +repage -resize 352x220 -strip -colors 64 -define png:compression-level=9 "$out/$1.png"
  if [ "$(stat -c %s "$out/$1.png")" -gt "$most" ]; then echo "make_tiles.sh: $out/$1.png is larger than $most bytes" >&2; exit 1; fi
}

base=+surface,+cameras
tile lesson-moving-highlight lessons/moving-highlight 0002 $base,+rays,+observed-contours,+light
tile lesson-mirror lessons/mirror 0001 $base,+virtual-cameras,+light
tile lesson-plane lessons/plane 0004 $base,+ellipsoids,+cones
tile lesson-sphere lessons/sphere 0001 $base,+virtual-cameras,+observed-contours
tile lesson-bent-mirror lessons/bent-mirror 0013 $base,+observed-contours,+tangent-planes
tile lesson-plane-to-cylinder lessons/plane-to-cylinder 0018 $base,+observed-contours,+rays,+light
tile lesson-waist lessons/waist 0008 +surface,+observed-contours,+rays,+light
tile lesson-moving-lamp lessons/moving-lamp 0002 $base,+rays,+light
tile plane plane 0004 $base,+photographs,+observed-contours
tile plane-to-cylinder plane-to-cylinder 0045 $base,+observed-contours,+rays
tile ellipsoid ellipsoid 0008 $base,+observed-contours,+tangent-planes
tile two-lamps two-lamps 0002 $base,+observed-contours,+rays,+light
tile vase vase 0010 $base,+observed-contours

{
  printf '<RCC>\n  <qresource prefix="/tiles">\n'
  for picture in "$out"/*.png; do printf '    <file>%s</file>\n' "${picture##*/}"; done
  printf '  </qresource>\n</RCC>\n'
} > "$out/tiles.qrc"
