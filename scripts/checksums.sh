# Is a fetched file the right one? Read by the scripts that fetch samples.

say() { printf '%s: %s\n' "$(basename "$0" .sh)" "$*" >&2; }

sha256_of() {
  if command -v sha256sum >/dev/null 2>&1; then sha256sum "$1"; else shasum -a 256 "$1"; fi |
    cut -d' ' -f1
}

# must_be FILE SHA256: leaves with an error that names both sums where they differ.
must_be() {
  local found
  found=$(sha256_of "$1")
  [ "$found" = "$2" ] && return 0
  say "$(basename "$1") has the SHA-256 $found, expected $2: not used"
  exit 1
}
