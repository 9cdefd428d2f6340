#!/usr/bin/env bash
# What does this machine still need to build and test Foveal? Installs it, or says what to install.
#
#   scripts/install.sh           install what is missing; prints nothing when nothing is
#   scripts/install.sh --check   only report; exit 1 when something is missing
#
# Debian and Ubuntu (as root or with sudo): apt-get does it. Elsewhere the packages are named for
# the system at hand and the exit status is 1. Needs no network when nothing is missing.
set -u

RUST_MAJOR=1
RUST_MINOR=95
WASM=wasm32-unknown-unknown
# rustup's own installer puts cargo here; a shell started before it does not look there yet.
PATH="$PATH:${CARGO_HOME:-$HOME/.cargo}/bin"

# One row a need: the test, then its package on Debian, Fedora, Arch and Homebrew (- for none).
needs() {
  cat <<'TABLE'
has_compiler              build-essential     gcc-c++|make          base-devel         -
has_command:pkg-config    pkg-config          pkgconf-pkg-config    pkgconf            pkgconf
has_command:clang         clang               clang                 clang              llvm
has_libclang              libclang-dev        clang-devel           clang              llvm
has_library:libavcodec    libavcodec-dev      ffmpeg-free-devel     ffmpeg             ffmpeg
has_library:libavformat   libavformat-dev     ffmpeg-free-devel     ffmpeg             ffmpeg
has_library:libavdevice   libavdevice-dev     ffmpeg-free-devel     ffmpeg             ffmpeg
has_library:libavfilter   libavfilter-dev     ffmpeg-free-devel     ffmpeg             ffmpeg
has_library:libavutil     libavutil-dev       ffmpeg-free-devel     ffmpeg             ffmpeg
has_library:libswscale    libswscale-dev      ffmpeg-free-devel     ffmpeg             ffmpeg
has_library:libswresample libswresample-dev   ffmpeg-free-devel     ffmpeg             ffmpeg
has_vulkan_loader         libvulkan1          vulkan-loader         vulkan-icd-loader  -
has_library:alsa          libasound2-dev      alsa-lib-devel        alsa-lib           -
has_keyboard_library      libxkbcommon-x11-0  libxkbcommon-x11      libxkbcommon-x11   -
has_xvfb                  xvfb                xorg-x11-server-Xvfb  xorg-server-xvfb   -
has_vulkan_driver         mesa-vulkan-drivers mesa-vulkan-drivers   vulkan-swrast      -
has_node                  nodejs              nodejs                nodejs             node
has_command:npm           npm                 nodejs-npm            npm                node
has_chromium              chromium            chromium              chromium           -
has_command:python3       python3             python3               python             python
has_pip                   python3-pip         python3-pip           python-pip         python
TABLE
}

has_command() { command -v "$1" >/dev/null 2>&1; }
has_compiler() { has_command cc && has_command c++ && has_command make; }
has_library() {
  { [ "$1" = alsa ] && [ "$(uname)" = Darwin ]; } || pkg-config --exists "$1" 2>/dev/null
}
has_pip() {
  python3 -c 'import importlib.util as u; assert u.find_spec("pip")' </dev/null 2>/dev/null
}

# has_file PATTERN...: does any of the patterns name a file?
has_file() {
  local file
  for file in "$@"; do [ -e "$file" ] && return 0; done
  return 1
}

has_libclang() {
  [ -n "${LIBCLANG_PATH:-}" ] || has_file /usr/lib/llvm*/lib/libclang*.so* /usr/lib/libclang*.so* \
    /usr/lib64/libclang*.so* /usr/lib/*-linux-gnu*/libclang*.so* \
    /Library/Developer/CommandLineTools/usr/lib/libclang.dylib \
    /opt/homebrew/opt/llvm/lib/libclang.dylib /usr/local/opt/llvm/lib/libclang.dylib
}

# macOS plays sound and opens windows through what it brings itself.
has_keyboard_library() {
  [ "$(uname)" = Darwin ] || has_file /usr/lib/*-linux-gnu*/libxkbcommon-x11.so.0 \
    /usr/lib/libxkbcommon-x11.so.0 /usr/lib64/libxkbcommon-x11.so.0
}

# The page is built by tools that need Node 20.19 or later.
has_node() {
  node -e 'const [a, b] = process.versions.node.split(".").map(Number);
    process.exit(a > 20 || (a === 20 && b >= 19) ? 0 : 1)' 2>/dev/null
}

# The tests look at the page in a browser.
has_chromium() {
  [ "$(uname)" = Darwin ] || has_command chromium || has_command chromium-browser ||
    has_command google-chrome
}

# The tests open windows on a display without a screen.
has_xvfb() { [ "$(uname)" = Darwin ] || has_command Xvfb; }

# macOS draws through Metal, which it brings itself.
has_vulkan_loader() {
  [ "$(uname)" = Darwin ] || has_file /usr/lib/*-linux-gnu*/libvulkan.so.1 \
    /usr/lib/libvulkan.so.1 /usr/lib64/libvulkan.so.1 /usr/local/lib/libvulkan.so.1
}

# The tests draw with Mesa's lavapipe where there is no GPU.
has_vulkan_driver() {
  [ "$(uname)" = Darwin ] || [ -n "${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" ] ||
    has_file /usr/share/vulkan/icd.d/lvp_icd*.json /etc/vulkan/icd.d/lvp_icd*.json
}

say() { printf 'install: %s\n' "$*" >&2; }
fail() { say "$*"; exit 1; }
# say_missing WHAT HOW: for what this script does not install by itself.
say_missing() { say "missing: $1"; say "to install: $2"; failed=1; }

system_name() {
  [ "$(uname)" = Darwin ] && { echo macos; return; }
  # shellcheck disable=SC1091
  case " $(. /etc/os-release 2>/dev/null; echo "${ID:-} ${ID_LIKE:-}") " in
    *" debian "* | *" ubuntu "*) echo debian ;;
    *" fedora "* | *" rhel "* | *" centos "*) echo fedora ;;
    *" arch "*) echo arch ;;
    *) echo unknown ;;
  esac
}

# The packages of system $1 whose need is not met, each once.
missing_packages() {
  local check debian fedora arch brew name
  needs | while read -r check debian fedora arch brew; do
    case "$check" in
      *:*) "${check%%:*}" "${check#*:}" && continue ;;
      *) "$check" && continue ;;
    esac
    case "$1" in
      fedora) name=$fedora ;;
      arch) name=$arch ;;
      macos) name=$brew ;;
      *) name=$debian ;;
    esac
    [ "$name" = - ] || printf '%s\n' "${name//|/$'\n'}"
  done | awk '!seen[$0]++'
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then env DEBIAN_FRONTEND=noninteractive "$@"
  else sudo env DEBIAN_FRONTEND=noninteractive "$@"; fi
}

may_be_root() { [ "$(id -u)" -eq 0 ] || has_command sudo; }

# apt_install PACKAGE...: output only when it fails.
apt_install() {
  local log
  may_be_root || fail "run as root or install sudo, or run: apt-get install $*"
  log=$(mktemp)
  say "apt-get installs: $*"
  if as_root apt-get update -q >"$log" 2>&1 &&
    as_root apt-get install -q -y --no-install-recommends "$@" >>"$log" 2>&1; then
    rm -f "$log"
  else
    tail -n 15 "$log" >&2
    rm -f "$log"
    fail "apt-get failed (its last lines are above): mend that, then run this again"
  fi
}

install_command() {
  case "$1" in
    debian) echo "sudo apt-get install" ;;
    fedora) echo "sudo dnf install" ;;
    arch) echo "sudo pacman -S" ;;
    macos) echo "brew install" ;;
    *) echo "your system's packages for" ;;
  esac
}

check_packages() {
  local missing
  if [ "$system" = macos ] && ! has_compiler; then
    say_missing "a C compiler" "xcode-select --install"
  fi
  missing=$(missing_packages "$system" | tr '\n' ' ')
  missing=${missing% }
  [ -z "$missing" ] && return 0
  if [ "$system" = debian ] && [ -z "$only_check" ]; then
    # shellcheck disable=SC2086  # one word a package
    apt_install $missing
    missing=$(missing_packages debian | tr '\n' ' ')
    [ -z "$missing" ] || fail "installed, yet still not found: $missing"
  else
    say_missing "$missing" "$(install_command "$system") $missing"
  fi
}

# The version of the cargo in reach meets the workspace's rust-version.
has_rust() {
  local version major minor
  version=$(cargo --version 2>/dev/null) || return 1
  version=${version#cargo }
  major=${version%%.*}
  minor=${version#*.}
  minor=${minor%%.*}
  case "$major$minor" in '' | *[!0-9]*) return 1 ;; esac
  [ "$major" -gt "$RUST_MAJOR" ] ||
    { [ "$major" -eq "$RUST_MAJOR" ] && [ "$minor" -ge "$RUST_MINOR" ]; }
}

has_rust_tools() { cargo fmt --version >/dev/null 2>&1 && cargo clippy --version >/dev/null 2>&1; }
has_wasm() { [ -d "$(rustc --print sysroot 2>/dev/null)/lib/rustlib/$WASM" ]; }

say_how_to_get_rust() {
  local how here
  case "$system" in
    fedora) how="sudo dnf install rustup && rustup-init" ;;
    arch) how="sudo pacman -S rustup && rustup default stable" ;;
    macos) how="brew install rustup && rustup default stable" ;;
    *) how="rustup, from https://rustup.rs, then: rustup default stable" ;;
  esac
  here=$(cargo --version 2>/dev/null || echo none)
  say_missing "Rust $RUST_MAJOR.$RUST_MINOR or later (here: $here)" "$how"
}

# Debian has the package rustup from version 13 on, Ubuntu from 24.04 on.
get_rust() {
  if ! has_command rustup && [ "$system" = debian ] && may_be_root &&
    apt-cache show rustup >/dev/null 2>&1; then
    apt_install rustup
    hash -r
  fi
  if has_command rustup; then
    say "rustup installs the stable toolchain"
    rustup toolchain install stable --profile minimal --component rustfmt --component clippy >&2 ||
      fail "rustup could not install the stable toolchain: see its message above"
    has_rust || say "the stable toolchain is not the one in use: run: rustup default stable"
  fi
}

check_rust() {
  if ! has_rust; then
    [ -n "$only_check" ] || get_rust
    has_rust || { say_how_to_get_rust; return; }
  fi
  if ! has_rust_tools; then
    [ -z "$only_check" ] && has_command rustup && rustup component add rustfmt clippy >&2
    has_rust_tools || say_missing "rustfmt and clippy" "rustup component add rustfmt clippy"
  fi
  if ! has_wasm; then
    [ -z "$only_check" ] && has_command rustup && rustup target add "$WASM" >&2
    has_wasm || say_missing "Rust's target $WASM" "rustup target add $WASM"
  fi
}

only_check=
case "${1:-}" in
  '') ;;
  --check) only_check=yes ;;
  -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) say "unknown option $1; there is only --check"; exit 2 ;;
esac
failed=
system=$(system_name)
check_packages
check_rust
[ -z "$failed" ] || exit 1
[ -z "$only_check" ] || echo "install: nothing is missing"
