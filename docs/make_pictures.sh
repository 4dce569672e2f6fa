#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws docs/pictures/*.png from the shipped sessions, for README, docs/inspector.md and docs/share.md.
# Usage: docs/make_pictures.sh   (GLINT_BIN=FOLDER: where the programs are; default build/release/bin). Needs xvfb-run; for share.png also Chromium;
# ImageMagick's mogrify cuts the file sizes to a third.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
bin=${GLINT_BIN:-$root/build/release/bin}
out=$root/docs/pictures
mkdir -p "$out"
started=$(mktemp)
trap 'rm -f "$started"' EXIT

inspector() {  # NAME SESSION FRAME THEME [MORE OPTIONS]
  QT_QPA_PLATFORM=xcb xvfb-run -a -s "-screen 0 1600x1000x24 -noreset" "$bin/glint-inspector" "$root/sessions/$2/${2##*/}.glint" --frame "$3" \
    --theme "$4" --size 1500x940 --screenshot "$out/$1.png" --wait-idle "${@:5}"
}
picture() {  # NAME SESSION FRAME VIEW
  "$bin/glint" render "$root/sessions/$2/$2.glint" --view "$4" --frame "$3" --size 1100x620 -o "$out/$1.png"
}

inspector inspector plane-to-cylinder 0045 dark
inspector inspector-vase vase 0010 light
inspector compare ellipsoid 0012 dark --layout compare
inspector explain plane-to-cylinder 0045 dark --layout explain --run explain.step-limit-angles
inspector explain-primal ellipsoid 0008 light --layout explain --run explain.step-virtual-camera
inspector look-through ellipsoid 0004 dark --run view.look-through
inspector look-through-virtual ellipsoid 0004 dark --run view.look-through-virtual
inspector four-views plane-to-cylinder 0045 dark --layout present --run view.views-4
inspector two-frames ellipsoid 0004 dark --layout compare --run frame.side-by-side
inspector inspector-retexture vase 0010 dark --layout present --run frame.retexture-removed
inspector lesson-mirror lessons/mirror 0001 dark --run explain.step-virtual-camera
inspector lesson-plane lessons/plane 0004 light --run explain.step-ellipsoid
inspector lesson-sphere lessons/sphere 0000 dark
inspector lesson-bent-mirror lessons/bent-mirror 0010 light --run explain.step-limit-angles
inspector lesson-plane-to-cylinder lessons/plane-to-cylinder 0018 dark --run explain.step-inverse-walk
inspector lesson-waist lessons/waist 0006 light --run explain.step-comparison
inspector lesson-moving-lamp lessons/moving-lamp 0002 light --run explain.step-light
inspector explain-cones ellipsoid 0008 light --layout explain --run explain.step-ellipsoid
picture scene plane-to-cylinder 0045 scene
picture ladder plane-to-cylinder 0045 ladder
picture frame ellipsoid 0012 frame
picture plots plane-to-cylinder 0045 plots
# A checked texture for the vase; the frame beside it, and without its highlight.
texture=$(mktemp --suffix=.png)
PYTHONPATH=$root/tests/formats python3 -B -c 'import sys
from pictures import png
row = lambda y: b"".join(bytes((205, 225, 240) if (x // 32 + y // 32) % 2 else (225, 150, 70)) for x in range(256))
open(sys.argv[1], "wb").write(png(256, 256, 3, 8, b"".join(row(y) for y in range(256))))' "$texture"
vase() { "$bin/glint" retexture "$root/sessions/vase/vase.glint" --frame 0010 --model reflectance "${@:2}" -o "$out/$1.png"; }
vase retexture --texture "$texture" --repeat 2
vase retexture-removed --remove
rm -f "$texture"
# The shared page of the vase, as a browser shows it.
if command -v chromium > /dev/null; then
  page=$(mktemp -d)
  "$bin/glint" share "$root/sessions/vase/vase.glint" -o "$page/vase.html" 2> /dev/null
  PYTHONPATH=$root/tests/share python3 -B -c 'import sys
from browser import Browser
with Browser(1280, 920) as browser:
    browser.open(f"file://{sys.argv[1]}#theme=light")
    browser.picture(sys.argv[2])' "$page/vase.html" "$out/share.png"
  rm -r "$page"
fi
if command -v mogrify > /dev/null; then
  # Other commands draw the other pictures of the folder.
  find "$out" -name '*.png' -newer "$started" -exec mogrify -strip -colors 128 -define png:compression-level=9 {} +
fi
