#!/usr/bin/env bash
# Builds the package into a virtual environment below target/ and runs its tests; --torch runs those of PyTorch, too (some GB);
# --wheel builds the release wheel and measures it. Other arguments go to pytest. Exit status 77: no Python with venv.
set -euo pipefail
cd "$(dirname "$0")"

root=$(cd ../.. && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
python3 -c 'import venv, ensurepip' 2>/dev/null || { echo "python3 with venv is missing" >&2; exit 77; }

# The packages that are pinned name the environment, so that other pins get another.
venv=$target/python-package-$(sha256sum python_tests/requirements.txt | cut -c1-16)
if [ ! -e "$venv/complete" ]; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check -r python_tests/requirements.txt
    touch "$venv/complete"
fi

wheels=$target/wheels
build() {
    rm -rf "$wheels"
    CARGO_TARGET_DIR=$target "$venv/bin/maturin" build --quiet --interpreter "$venv/bin/python" --out "$wheels" "$@"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps "$wheels"/*.whl
}

if [ "${1:-}" = --torch ]; then
    shift
    "$venv/bin/pip" install --quiet --disable-pip-version-check -r python_tests/requirements-torch.txt
fi
if [ "${1:-}" = --wheel ]; then
    build --release
    "$venv/bin/python" python_tests/measure_wheel.py "$wheels"/*.whl
else
    build --profile dev
    MPLBACKEND=agg "$venv/bin/python" -m pytest -q --durations=5 "$@"
fi
