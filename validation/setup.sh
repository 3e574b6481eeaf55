# Sourced by run and test: finds a Python and has bokeh_validation/setup.py put the rest in place, which on first use
# installs by the table in bokeh_validation/needs.py and is silent afterwards. Gives the script:
#
#   validation   this folder
#   cache        the one folder outside the checkout that is written to
#   python       the interpreter of the virtual environment

validation=$(CDPATH='' cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
cache=${BOKEH_CACHE:-${XDG_CACHE_HOME:-${HOME:-~}/.cache}/bokeh-validation}
[[ $cache == /* ]] || cache=$PWD/$cache
export BOKEH_CACHE="$cache"

# Only this package and what the lock files pin: other folders could shadow either.
export PYTHONPATH="$validation"
# Everything that is written on the way goes to the cache folder.
export PYTHONPYCACHEPREFIX="$cache/pycache"
# Images of containers set this against files beside the sources. There are none, and every start would compile all.
unset PYTHONDONTWRITEBYTECODE
export PIP_CACHE_DIR="$cache/pip"
export MESA_SHADER_CACHE_DIR="$cache/mesa"
# Mesa complains where this is not set
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-$cache}"

# Path of the first Python of 3.11 or later that can make virtual environments: Debian ships the module for that apart.
find_python() {
    local candidate probe='
import importlib.util, sys
sys.exit(sys.version_info < (3, 11) or importlib.util.find_spec("ensurepip") is None)'
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        "$candidate" -I -S -c "$probe" 2>/dev/null && command -v "$candidate" && return
    done
    return 1
}

if [ -z "${BOKEH_SET_UP:-}" ]; then
    base=$(find_python) || {
        # Debian has the module apart, and an older release may have a later Python beside its own
        install="apt-get install -y --no-install-recommends"
        [ "$EUID" -eq 0 ] && { apt-get update && { $install python3 python3-venv || true; }; } >/dev/null 2>&1
        base=$(find_python) || {
            [ "$EUID" -eq 0 ] && $install python3.11 python3.11-venv >/dev/null 2>&1
            base=$(find_python) ||
                { echo "error: needs Python 3.11 or later: sudo $install python3.11 python3.11-venv" >&2; exit 2; }
        }
    }
    exec "$base" -S -P -m bokeh_validation.setup "$validation/${BASH_SOURCE[1]##*/}" "$@"
fi
# shellcheck disable=SC2034  # used by run and test
python=$BOKEH_SET_UP
unset BOKEH_SET_UP
