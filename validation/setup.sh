# Sourced by run and test: puts everything in place on first use and is silent afterwards.
#
#   validation   this folder
#   cache        the one folder outside the checkout that is written to
#   python       the interpreter of the virtual environment
#
# All talk goes to standard error; standard output belongs to the program.

validation=$(CDPATH='' cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
cache=${BOKEH_CACHE:-${XDG_CACHE_HOME:-${HOME:-~}/.cache}/bokeh-validation}
[[ $cache == /* ]] || cache=$PWD/$cache

# System packages by what needs them. Ubuntu has Chromium as a snap; there google-chrome will do, or what
# $BOKEH_CHROMIUM names. Node.js from elsewhere brings its own npm, which the system's would not go with.
opengl="libosmesa6 libgl1-mesa-dri libegl1 libgl1"
vulkan="mesa-vulkan-drivers libvulkan1 libatomic1"
compilers="glslang-tools spirv-tools spirv-cross"
windows="wine wine64 g++-mingw-w64-x86-64-posix xvfb xauth"
browser=""
if [ "$(. /etc/os-release 2>/dev/null && printf '%s' "${ID:-}")" = debian ]; then browser="chromium"; fi
command -v npm >/dev/null || browser+=" npm"
engines="mono-mcs love default-jre-headless ivy g++ pkg-config libogre-1.12-dev vkbasalt vulkan-tools"
engines+=" libvulkan-dev vulkan-validationlayers"
everything="$opengl $vulkan $compilers $windows $browser $engines"

# The packages that a command line of validation/run needs, in $@: nobody gets Wine who asks for the version.
packages_for() {
    local argument command=''
    case " $* " in *" --help "* | *" -h "* | *" --version "*) return 0 ;; esac
    for argument in "$@"; do
        case $argument in
        d3d9 | d3d11 | --driver=d3d*) printf '%s ' "$windows" ;;
        webgl2 | webgpu | --driver=web*) printf '%s ' "$browser" ;;
        --full) printf '%s ' "$everything" ;;
        -*) ;;
        *) command=${command:-$argument} ;;
        esac
    done
    case $command in
    parity | plan | generate | aperture | doctor) ;;
    demo) printf '%s ' "$opengl $browser" ;;
    peers) printf '%s ' "$opengl $vulkan $browser" ;;
    compile) printf '%s ' "$opengl $vulkan $compilers $windows $browser" ;;
    engines) printf '%s ' "$everything" ;;
    render | truth | pictures | shapes | compare) printf '%s ' "$opengl" ;;
    isa) printf '%s ' "$opengl $vulkan $compilers" ;;
    bench | check | mutants | probes) printf '%s ' "$opengl $vulkan $compilers" ;;
    *) printf '%s ' "$opengl $vulkan $compilers $windows" ;;
    esac
}

say() {
    printf 'set-up: %s\n' "$*" >&2
}

# Those of the packages that are not installed, one a line. Elsewhere than on Debian and Ubuntu: none, and doctor tells
# what is missing.
missing_packages() {
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null || return 0
    local installed name
    installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null)
    for name in "$@"; do
        [[ $'\n'$installed$'\n' == *$'\n'"$name installed"$'\n'* ]] || printf '%s\n' "$name"
    done
}

# Those of the packages that the package lists offer, one a line.
offered_packages() {
    [ "$#" -eq 0 ] || LC_ALL=C apt-cache policy "$@" 2>/dev/null |
        awk '/^[^ ]/ { name = $1; sub(/:.*/, "", name) } $1 == "Candidate:" && $2 != "(none)" { print name }'
}

# File with the names of what this release of the system does not have at all, as an earlier run found out.
absent_file() {
    local release
    release=$(. /etc/os-release 2>/dev/null && printf '%s' "${ID:-}-${VERSION_ID:-}")
    printf '%s\n' "$cache/not-in-${release:-this-release}"
}

# missing_packages without those that are known not to be had: not asked for again and again.
wanted_packages() {
    local missing absent
    mapfile -t missing < <(missing_packages "$@")
    [ "${#missing[@]}" -gt 0 ] || return 0
    absent=$(absent_file)
    if [ -e "$absent" ]; then
        printf '%s\n' "${missing[@]}" | grep -vxFf "$absent"
    else
        printf '%s\n' "${missing[@]}"
    fi
}

install_packages() {
    local wanted
    mapfile -t wanted < <(wanted_packages "$@")
    [ "${#wanted[@]}" -gt 0 ] || return 0
    if [ "$EUID" -ne 0 ]; then
        say "missing system packages; run: sudo apt-get install -y --no-install-recommends ${wanted[*]}"
        return 0
    fi
    # one at a time: a second set-up waits, and finds the work done
    (
        flock 8
        mapfile -t wanted < <(wanted_packages "$@")
        [ "${#wanted[@]}" -eq 0 ] || apt_install "${wanted[@]}"
    ) 8>"$cache/apt.lock"
}

apt_install() {
    local log="$cache/apt.log" updated='' offered name
    : >"$log"
    mapfile -t offered < <(offered_packages "$@")
    if [ "${#offered[@]}" -lt "$#" ]; then
        say "updating the package lists"
        apt-get update >>"$log" 2>&1 && updated=yes
        mapfile -t offered < <(offered_packages "$@")
    fi
    if [ "${#offered[@]}" -lt "$#" ]; then
        for name in "$@"; do
            [[ " ${offered[*]} " == *" $name "* ]] && continue
            say "$name is not to be had here; what needs it will be reported as missing"
            # an update that failed is no proof
            [ -z "$updated" ] || printf '%s\n' "$name" >>"$(absent_file)"
        done
    fi
    [ "${#offered[@]}" -gt 0 ] || return 0
    say "installing ${offered[*]} ($(LC_ALL=C apt-get install --assume-no --no-install-recommends "${offered[@]}" 2>/dev/null |
        sed -n 's/^Need to get \(.*\) of archives.*/\1 to fetch/p; s/^After this operation, \(.*\) of additional.*/\1 on disk/p' |
        paste -sd, - | sed 's/,/, /'))"
    local install=(env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install -y
        --no-install-recommends "${offered[@]}")
    "${install[@]}" >>"$log" 2>&1 && return 0
    # lists that are too old name files that are gone
    if [ -z "$updated" ]; then
        say "updating the package lists"
        apt-get update >>"$log" 2>&1 && "${install[@]}" >>"$log" 2>&1 && return 0
    fi
    say "apt-get install failed (see $log); what needs the packages will be reported as missing"
}

# "key interpreter" of the first Python of 3.11 or later that can make virtual environments (Debian ships the module for
# that apart). The key names the environment: the lock file and the Python decide what is in it.
find_python() {
    local candidate key probe='
import hashlib, importlib.util, sys
if sys.version_info < (3, 11) or importlib.util.find_spec("ensurepip") is None:
    sys.exit(1)
lock = open(sys.argv[1], "rb").read()
print(hashlib.sha256(lock + sys.version.encode() + sys.base_prefix.encode()).hexdigest()[:16])'
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        if key=$("$candidate" -I -S -c "$probe" "$validation/requirements.txt" 2>/dev/null); then
            printf '%s %s\n' "$key" "$(command -v "$candidate")"
            return 0
        fi
    done
    return 1
}

make_environment() {
    local base=$1 target=$2
    say "making the virtual environment $target (about 100 MB to fetch, 400 MB on disk)"
    rm -rf "$target"
    "$base" -m venv "$target" >&2 || { say "$base cannot make virtual environments"; return 1; }
    # the line of each package is the sign of progress
    "$target/bin/python" -I -m pip install --progress-bar off --disable-pip-version-check --no-input --require-hashes \
        -r "$validation/requirements.txt" | sed -un 's/^Collecting \([^ ]*\).*/set-up:   \1/p' >&2 ||
        { say "the Python packages could not be installed (see above)"; return 1; }
    # last of all: what has no such file was interrupted, and is made again
    touch "$target/complete"
}

set_up() {
    local found base environment
    install_packages "$@"
    found=$(find_python) || {
        # Debian has the module for virtual environments apart, and an older release may have a later Python beside its own
        [ "$EUID" -ne 0 ] || install_packages python3-venv python3.11 python3.11-venv
        found=$(find_python) ||
            { say "needs Python 3.11 or later: sudo apt-get install -y python3.11 python3.11-venv"; return 1; }
    }
    base=${found#* }
    environment="$cache/venv-${found%% *}"
    if [ ! -e "$environment/complete" ]; then
        (
            flock 9
            [ -e "$environment/complete" ] || make_environment "$base" "$environment"
        ) 9>"$cache/lock" || return 1
    fi
    # shellcheck disable=SC2034  # used by run and test
    python=$environment/bin/python
}

mkdir -p -- "$cache" && [ -w "$cache" ] || { say "cannot write to the cache folder $cache; set BOKEH_CACHE"; exit 1; }
# shellcheck disable=SC2046
case ${BASH_SOURCE[1]##*/} in
test) set_up $everything ;;
*) set_up $(packages_for "$@") ;;
esac || exit 1

# Only this package and what the lock file pins: other folders could shadow either.
export PYTHONPATH="$validation"
# Everything that is written on the way goes to the cache folder.
export PYTHONPYCACHEPREFIX="$cache/pycache"
# Images of containers set this against files beside the sources. There are none, and every start would compile all.
unset PYTHONDONTWRITEBYTECODE
export PIP_CACHE_DIR="$cache/pip"
export MESA_SHADER_CACHE_DIR="$cache/mesa"
# Mesa complains where this is not set
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-$cache}"
