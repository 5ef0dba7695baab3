# Sourced by scripts/reproduce, scripts/test and scripts/lint: packages, configuration, build.
#
# Packages are those of Debian 12 (bookworm) and 13 (trixie), and of Ubuntu 22.04 and 24.04.

PACKAGES=(build-essential cmake git libeigen3-dev libopenblas-pthread-dev liblapacke-dev
          libbenchmark-dev libfmt-dev libgtest-dev libcli11-dev nlohmann-json3-dev python3)
# What the NumPy module, the studies on it and charts need besides.
STUDY_PACKAGES=(python3-dev pybind11-dev python3-numpy python3-scipy python3-matplotlib python3-tqdm
                python3-distributed)
# What the study of the paper's claims needs besides: the paper's language but for the name.
CLAIMS_PACKAGES=(octave)
# What the page to open, report.html, is made with. A run succeeds without them, and says that there is no page.
PAGE_PACKAGES=(python3-plotly python3-jinja2 python3-markdown)  # besides matplotlib
# What the tests need besides: the module is installed by pip, pages are rendered, and hypothesis draws the inputs of
# property tests.
TEST_PACKAGES=(python3-venv python3-pip python3-setuptools python3-wheel python3-hypothesis "${PAGE_PACKAGES[@]}")
# What the test of the page in a browser needs; Ubuntu has no such package, and there the test is skipped.
BROWSER_PACKAGES=(chromium)
# What looking for data races needs besides.
CLANG_PACKAGES=(clang libomp-dev)
# The runtime of its sanitizers, which Ubuntu 22.04 (jammy) has in another package that clang depends on.
grep -qs '^VERSION_CODENAME=jammy' /etc/os-release || CLANG_PACKAGES+=(libclang-rt-dev)
# What scripts/lint needs besides; formatting differs from version to version, and Debian 13 has not this one.
LINT_PACKAGES=(clang-format-14 clang-tidy-14 flake8)

say() { printf '%s\n' "$*" >&2; }

die() {  # die CODE MESSAGE
  say "$(basename "$0"): $2"
  exit "$1"
}

# missing_packages PACKAGE ...: those that are not installed.
missing_packages() {
  local package found
  found=$(dpkg-query --show --showformat='${Package} ${Status}\n' "$@" 2>/dev/null) || true  # one is not known
  for package in "$@"; do
    [[ $'\n'$found$'\n' = *$'\n'"$package install ok installed"$'\n'* ]] || printf '%s\n' "$package"
  done
}

# absent_packages PACKAGE ...: those that no source of this machine's packages has.
absent_packages() {
  local package
  for package in "$@"; do
    apt-cache show --no-all-versions "$package" >/dev/null 2>&1 || printf '%s\n' "$package"
  done
}

# install_packages yes|no [HINT]: installs what is missing, or only names it. HINT says what to do where this release has
# no such package.
install_packages() {
  command -v dpkg-query >/dev/null ||
    die 2 "needs a Debian or Ubuntu machine (no dpkg-query here); install by hand: ${PACKAGES[*]}"
  local missing absent
  mapfile -t missing < <(missing_packages "${PACKAGES[@]}")
  [ "${#missing[@]}" -eq 0 ] && return 0
  [ "$1" = yes ] || die 2 "missing packages, not installed because of --no-install: ${missing[*]}"
  become_root || die 2 "missing packages, and neither root nor sudo to install them: ${missing[*]}"
  say "Installing: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq >&2 || die 2 "apt-get update failed"
  mapfile -t absent < <(absent_packages "${missing[@]}")
  [ "${#absent[@]}" -eq 0 ] || die 2 "no package of this release: ${absent[*]}${2:+; $2}"
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2 ||
    die 2 "apt-get install failed for: ${missing[*]}"
}

# become_root [OPTION_OF_SUDO]: sets as_root, what a command of root begins with. Status 1 if there is no way.
become_root() {
  as_root=(env DEBIAN_FRONTEND=noninteractive)
  [ "$(id -u)" -ne 0 ] || return 0
  as_root=(sudo "$@" "${as_root[@]}")  # sudo would not pass the environment on
  command -v sudo >/dev/null
}

# install_optional yes|no PACKAGE ...: installs what is missing of packages that a script can do without, where that is
# wanted, asks for no password, and this release has them all. What lacks them says so itself.
install_optional() {
  local wanted=$1 missing absent
  shift
  mapfile -t missing < <(missing_packages "$@")
  if [ "$wanted" != yes ] || [ "${#missing[@]}" -eq 0 ] || ! become_root --non-interactive; then return 0; fi
  "${as_root[@]}" apt-get update -qq >&2 || return 0
  mapfile -t absent < <(absent_packages "${missing[@]}")
  [ "${#absent[@]}" -eq 0 ] || return 0
  say "Installing: ${missing[*]}"
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2 || true
}

# has_avx512: tells whether this processor has the units. grep reads all: with -q it may end before lscpu, whose broken
# pipe would be the status under pipefail.
has_avx512() { lscpu | grep -w avx512f >/dev/null; }

# For which processor a script builds, so that rounding can be varied on one machine: options for CMake, and where.
MACHINES="native, x86-64-v3 or x86-64"
MACHINE_OPTIONS=() BUILD=$ROOT/build

# choose_machine NAME: sets MACHINE_OPTIONS and BUILD, the build folder.
choose_machine() {
  case $1 in
    native) MACHINE_OPTIONS=() ;;
    # The compiler fuses no product with a sum, by which its code rounds as on a processor that cannot.
    x86-64-v3) MACHINE_OPTIONS=(-DISOSYRK_NATIVE=OFF -DISOSYRK_KERNELS=avx2
                                "-DCMAKE_CXX_FLAGS=-march=x86-64-v3 -ffp-contract=off") ;;
    x86-64) MACHINE_OPTIONS=(-DISOSYRK_NATIVE=OFF -DISOSYRK_KERNELS=portable) ;;
    *) die 2 "--machine '$1': must be $MACHINES" ;;
  esac
  BUILD=$ROOT/build
  [ "$1" = native ] || BUILD+=-$1
}

# settle_coretype yes|no: keeps or clears an inherited choice of OpenBLAS's kernels, and says so.
settle_coretype() {
  [ -n "${OPENBLAS_CORETYPE:-}" ] || return 0
  if [ "$1" = yes ]; then
    say "Note: OPENBLAS_CORETYPE=$OPENBLAS_CORETYPE is kept; it decides which kernels OpenBLAS runs."
  else
    say "Note: cleared the inherited OPENBLAS_CORETYPE=$OPENBLAS_CORETYPE, so that OpenBLAS picks its" \
        "kernels for this processor (--keep-coretype keeps it)."
    unset OPENBLAS_CORETYPE
  fi
}

# show_kernels FOLDER: says which kernels a build runs here, by which results and counts round.
show_kernels() {
  local kernels
  kernels=$("$1/benchmarks/kernel_sets") || die 2 "$1/benchmarks/kernel_sets: cannot tell the kernels that run here"
  say "Kernels: $kernels"
}

child=  # what a script waits for, to be ended with it

# begin_lock FILE_OR_FOLDER: takes its lock, which ends with the process, however that ends. Status 1 if another has it.
# Where a file system knows no locks there is none.
LOCKS=()
begin_lock() {
  local lock busy=0
  exec {lock}<"$1"
  flock --nonblock --conflict-exit-code 75 "$lock" 2>/dev/null || busy=$?
  LOCKS+=("$lock")
  [ $busy -ne 75 ]
}

# followed LOG COMMAND ...: runs a command of a build with what it says in LOG, and shows how far it is: on a terminal
# by a line that is rewritten, elsewhere by one every 20 seconds. If this script is killed, nobody reads what the
# command says, and it ends.
followed() {
  local log=$1 pipe=$1.pipe output line percent next=$((SECONDS + 20)) terminal=no status=0
  shift
  [ ! -t 2 ] || terminal=yes
  # A named pipe and a job of its own: bash can lose the status of <(COMMAND), where a command is short.
  rm -f "$pipe"
  mkfifo "$pipe" || return
  (for lock in "${LOCKS[@]}"; do exec {lock}<&-; done; exec "$@") >"$pipe" 2>&1 &
  child=$!
  exec {output}<"$pipe"
  rm "$pipe"
  while IFS= read -r line <&"$output"; do
    printf '%s\n' "$line" >>"$log"
    [[ $line =~ ^\[\ *([0-9]+)(%|/([0-9]+))\] ]] || continue  # of make or of Ninja
    percent=$((BASH_REMATCH[3] ? 100 * BASH_REMATCH[1] / BASH_REMATCH[3] : BASH_REMATCH[1]))
    if [ $terminal = yes ]; then
      printf '\r\033[K%s' "${line:0:79}" >&2
    elif [ $SECONDS -ge $next ]; then
      say "  $percent % built"
      next=$((SECONDS + 20))
    fi
  done
  exec {output}<&-
  [ $terminal = no ] || printf '\r\033[K' >&2
  wait "$child" || status=$?
  child=
  return $status
}

# logged FOLDER COMMAND ...: runs a command of the build in a folder; its log, FOLDER/build.log, is shown only on
# failure.
logged() {
  local folder=$1 log=$1/build.log
  shift
  if ! followed "$log" "$@"; then
    tail -n 40 "$log" >&2
    die 2 "the build in $folder failed; all that it said is in $log"
  fi
}

# configure FOLDER [CMAKE_ARGUMENT ...]: waits for another build in the same folder.
configure() {
  local folder=$1
  shift
  mkdir -p "$folder" 2>/dev/null || die 2 "$folder: cannot be written"
  if ! begin_lock "$folder"; then
    say "Another build in ${folder#"$ROOT"/} is going on: waiting for its end ..."
    flock "${LOCKS[-1]}"
  fi
  { : >"$folder/build.log"; } 2>/dev/null || die 2 "$folder/build.log: cannot be written"
  logged "$folder" cmake -S "$ROOT" -B "$folder" "$@"
}

# Options of a build that is made to be checked, not to be fast or built again: the sources of the library and of programs
# are joined to few units, each of which reads headers and makes Eigen's templates once.
UNITED=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=6)

# build FOLDER TARGET [CMAKE_ARGUMENT ...]: configures and builds.
build() {
  local folder=$1 target=$2 lock
  shift 2
  say "Building in ${folder#"$ROOT"/} ..."
  configure "$folder" "$@"
  logged "$folder" cmake --build "$folder" --target "$target" --parallel "$(nproc)"
  sed -n 's/^-- \(NumPy module: .*\)/\1/p' "$folder/build.log" >&2
  lock=${LOCKS[-1]}
  exec {lock}<&-
  unset 'LOCKS[-1]'
}
