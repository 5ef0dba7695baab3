# Sourced by scripts/reproduce, scripts/test and scripts/lint: packages, configuration, build.
#
# Packages are those of Debian 12 (bookworm) or newer and of Ubuntu 22.04 or newer.

PACKAGES=(build-essential cmake git libeigen3-dev libopenblas-pthread-dev liblapacke-dev
          libbenchmark-dev libfmt-dev libgtest-dev libcli11-dev nlohmann-json3-dev python3)
# What the NumPy module, the studies on it and charts need besides.
STUDY_PACKAGES=(python3-dev pybind11-dev python3-numpy python3-matplotlib python3-tqdm python3-distributed)
# What looking for data races needs besides.
CLANG_PACKAGES=(clang libomp-dev)
# What scripts/lint needs besides; formatting differs from version to version.
LINT_PACKAGES=(clang-format-14 clang-tidy-14 flake8)

say() { printf '%s\n' "$*" >&2; }

die() {  # die CODE MESSAGE
  say "$(basename "$0"): $2"
  exit "$1"
}

missing_packages() {
  local package
  for package in "${PACKAGES[@]}"; do
    dpkg-query --show --showformat='${Status}\n' "$package" 2>/dev/null |
      grep -q '^install ok installed$' || printf '%s\n' "$package"
  done
}

# install_packages yes|no: installs what is missing, or only names it.
install_packages() {
  command -v dpkg-query >/dev/null ||
    die 2 "needs a Debian or Ubuntu machine (no dpkg-query here); install by hand: ${PACKAGES[*]}"
  local missing
  mapfile -t missing < <(missing_packages)
  [ "${#missing[@]}" -eq 0 ] && return 0
  [ "$1" = yes ] || die 2 "missing packages, not installed because of --no-install: ${missing[*]}"
  local as_root=(env DEBIAN_FRONTEND=noninteractive)
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
      die 2 "missing packages, and neither root nor sudo to install them: ${missing[*]}"
    as_root=(sudo "${as_root[@]}")  # sudo would not pass the environment on
  fi
  say "Installing: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq >&2 || die 2 "apt-get update failed"
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2 ||
    die 2 "apt-get install failed for: ${missing[*]}"
}

# logged WHAT COMMAND ...: runs it; its log is shown only on failure, but for what it says of the module.
logged() {
  local what=$1 log
  shift
  log=$(mktemp)
  if ! "$@" >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    rm -f "$log"
    die 2 "$what failed"
  fi
  sed -n 's/^-- \(NumPy module: .*\)/\1/p' "$log" >&2
  rm -f "$log"
}

# configure FOLDER [CMAKE_ARGUMENT ...]
configure() {
  local folder=$1
  shift
  logged "the build in $folder" cmake -S "$ROOT" -B "$folder" "$@"
}

# build FOLDER TARGET [CMAKE_ARGUMENT ...]: configures and builds.
build() {
  local folder=$1 target=$2
  shift 2
  say "Building in ${folder#"$ROOT"/} ..."
  configure "$folder" "$@"
  logged "the build in $folder" cmake --build "$folder" --target "$target" --parallel "$(nproc)"
}
