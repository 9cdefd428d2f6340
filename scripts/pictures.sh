#!/usr/bin/env bash
# Which commands make the pictures of the documents?
#
#   scripts/pictures.sh PROGRAM WORK     writes docs/pictures; `make pictures` calls it
#
# PROGRAM is foveal; WORK is a folder for packs, which are kept for the next time. Everything shown
# is generated. Needs python3, and cargo for the plots of docs/measured.toml. The plot of gaze is
# made where GAZE is the folder of recordings that docs/concepts/gaze.md names.
set -eu

[ $# -eq 2 ] || { echo "usage: scripts/pictures.sh PROGRAM WORK" >&2; exit 2; }
program=$(realpath "$1")
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
out="$root/docs/pictures"
mkdir -p "$2"
cd "$2"

foveal() { "$program" "$@"; }
# Several pictures in one; what is joined stands in scripts/side_by_side.py.
join() { python3 "$root/scripts/side_by_side.py" "$@"; }
# show NAME PACK OPTION..: the last picture of a run, as NAME.png.
show() {
  local name=$1 pack=$2
  shift 2
  foveal simulate "$pack" --out "run-$name" "$@" >"run-$name.txt"
  cp "$(printf '%s\n' "run-$name"/frame_*.png | tail -n 1)" "$name.png"
}

# A sphere, a flat film and a mesh, as the demo prepares them.
[ -f demo/report.html ] || foveal demo --out demo >demo.txt
sphere=demo/generated-360.foveal film=demo/generated-wide.foveal mesh=demo/knot.foveal

# README: the whole picture with the gaze, the levels, and what is shown.
at=(--view 960x800 --fov 50 --gaze=8,-9 --frames 1)
show whole "$sphere" --policy full "${at[@]}"
show levels "$sphere" --policy acuity --slope 0.022 --heat-map "${at[@]}"
show shown "$sphere" --policy acuity --slope 0.022 "${at[@]}"
# On a sphere the head follows, so the gaze is in the middle; the ring is 2.5° round it.
join "$out/foveated.png" whole.png:half:ring=240,200,22 levels.png:half shown.png:half

# The source itself, every finest tile, and a target of 9.5.
[ -f source.foveal ] || foveal prepare video demo/generated-360.png --codec png --no-loss \
  --pack-projection equirect --calibrate off --out source.foveal >source.txt
at=(--view 400x400 --fov 40 --gaze 0,0 --frames 1)
show source source.foveal --policy full "${at[@]}"
show full "$sphere" --policy full "${at[@]}"
show target "$sphere" --policy perceptual --target 9.5 "${at[@]}"
join "$out/source-full-target.png" source.png full.png target.png

# A scene: for an eye at the ring, coloured by level, and as fine as the display.
at=(--view 1000x1000 --fov 40 --gaze 10,7 --frames 2)
show scene "$mesh" --policy acuity "${at[@]}"
show scene-levels "$mesh" --policy acuity --heat-map "${at[@]}"
show scene-fine "$mesh" --policy viewport "${at[@]}"
crop=half:crop=370x350+65+110
join "$out/scene.png" "scene.png:$crop:ring=305,50,30" {scene-levels,scene-fine}.png:$crop

# Panels: three that one source fills, where the source lies, and how much it is magnified.
rigs="$root/examples/panels"
foveal panels warp "$rigs/three.toml" world:valley --out three >three.txt
join "$out/panels.png" three/L.png:half three/C.png:half three/R.png:half
foveal panels figures "$rigs/three.toml" --out figures-three >>three.txt
cp figures-three/panels.svg "$out/panels-three.svg"
foveal panels figures "$rigs/twelve.toml" --out figures-twelve >>three.txt
cp figures-twelve/source.svg "$out/panels-twelve.svg"
foveal panels figures "$rigs/twelve.toml" --placement seed --source 1600x1200 \
  --out figures-seed >>three.txt
join "$out/panels-magnified.png" figures-seed/magnification.png

# What a step is worth (docs/concepts/perception.md).
at=(--view 960x540 --gaze 0,0 --frames 1)
show coarsest "$film" --policy coarsest "${at[@]}"
show finest "$film" --policy full "${at[@]}"
foveal perception importance coarsest.png finest.png --gaze 422,118 --fov 48 --out heat.png \
  --updates >heat.txt
join "$out/importance.png" heat-sheet.png

# Samples and blur (docs/concepts/kastner.md).
at=(--view 1920x1080 --gaze=-5,-3 --frames 1 --policy sampled)
for samples in 690926 35375; do
  show "nearest-$samples" "$film" --samples $samples --interpolation nearest "${at[@]}"
  show "blended-$samples" "$film" --samples $samples --interpolation blended "${at[@]}"
done
crop=crop=480x320+520+500
join "$out/samples.png" {nearest,blended}-690926.png:$crop / {nearest,blended}-35375.png:$crop
show blurred "$film" --policy viewport --blur on --view 640x360 --gaze 0,0 --frames 1
join "$out/blur.png" blurred.png

if [ -n "${GAZE:-}" ]; then
  foveal gaze eval delay --leave-one-out --data "$GAZE"/sgaze*.csv \
    --delays "$(seq -s, 0 20 500)" --plot "$out/gaze-delay.svg" >delay.txt
fi
cd "$root"
cargo xtask measured --write
