# Sourced by run and test: puts everything in place on first use and is silent afterwards.
#
#   validation   this folder
#   python       the interpreter of the virtual environment, set here
#
# All talk goes to standard error; standard output belongs to the program.

validation=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cache=${BOKEH_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/bokeh-validation}
packages=(glslang-tools spirv-tools spirv-cross mesa-vulkan-drivers libvulkan1 libosmesa6 libgl1-mesa-dri libegl1 libgl1)

say() {
    printf 'set-up: %s\n' "$*" >&2
}

# Each package of the list that dpkg does not know as installed. Elsewhere than on Debian and Ubuntu: nothing, and doctor
# tells what is missing.
missing_packages() {
    command -v dpkg-query >/dev/null || return 0
    local installed name
    installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null | awk '$2 == "installed" { print $1 }')
    for name in "$@"; do
        grep -qxF "$name" <<<"$installed" || printf '%s\n' "$name"
    done
}

install_packages() {
    local missing
    mapfile -t missing < <(missing_packages "$@")
    [ "${#missing[@]}" -gt 0 ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        say "missing system packages; run: sudo apt-get install -y --no-install-recommends ${missing[*]}"
        return 0
    fi
    say "installing ${missing[*]}"
    local log="$cache/apt.log"
    mkdir -p "$cache"
    if ! { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"; } \
        >"$log" 2>&1; then
        # one package that this release lacks must not keep the others out
        local name
        for name in "${missing[@]}"; do
            DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$name" >>"$log" 2>&1 \
                || say "$name could not be installed (see $log); what needs it will be reported as missing"
        done
    fi
}

# The first interpreter of 3.11 or later.
find_python() {
    local candidate
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            command -v "$candidate"
            return 0
        fi
    done
    return 1
}

make_environment() {
    local base=$1 target=$2
    say "making the virtual environment $target"
    # Debian ships Python without the module that makes environments
    if ! "$base" -c 'import ensurepip, venv' 2>/dev/null; then
        install_packages "$("$base" -c 'import sys; print("python3.%d-venv" % sys.version_info[1])')"
    fi
    rm -rf "$target"
    "$base" -m venv "$target" || { say "$base cannot make virtual environments; install its venv package"; return 1; }
    "$target/bin/python" -m pip install --quiet --disable-pip-version-check --require-hashes \
        -r "$validation/requirements.txt" >&2 || { say "the Python packages could not be installed (see above)"; return 1; }
    touch "$target/complete"
}

set_up() {
    local base key
    base=$(find_python) || {
        # a fresh machine may have no Python at all
        install_packages python3 python3-venv
        base=$(find_python) || { say "needs Python 3.11 or later: apt-get install -y python3 python3-venv"; return 1; }
    }
    key=$({ cat "$validation/requirements.txt"; "$base" -c 'import sys; print(sys.version, sys.executable)'; } | sha256sum)
    local environment="$cache/venv-${key:0:16}"
    if [ ! -e "$environment/complete" ]; then
        mkdir -p "$cache" || { say "cannot write to the cache folder $cache; set BOKEH_CACHE to another place"; return 1; }
        # one set-up at a time: a second one waits and finds the work done
        (
            flock 9
            [ -e "$environment/complete" ] || make_environment "$base" "$environment"
        ) 9>"$cache/lock" || return 1
    fi
    install_packages "${packages[@]}"
    python=$environment/bin/python
}

set_up || exit 1

export PYTHONPATH="$validation${PYTHONPATH:+:$PYTHONPATH}"
export PYTHONPYCACHEPREFIX="$cache/pycache"
export MPLCONFIGDIR="$cache/matplotlib"
# Mesa complains where this is not set
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-$cache}"
