#!/usr/bin/env bash
# The Python module: builds a wheel, installs it into an environment of its own, and tests it as a user would (python/tests), with the
# command `magcomp` beside it. `tests/python.sh`, or with arguments for pytest. Needs Rust and Python 3.10 or newer with venv; the environment brings
# what python/tests/requirements.txt names. PROFILE=release builds the wheel as it ships, which takes longer. MAGCOMP_NIGHT=1 tries Spark too, whose package
# is large and which needs Java.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need python "${rust_tools[@]}" python3:python3 venv:python3-venv ${MAGCOMP_NIGHT:+jdk:default-jdk-headless}
. tests/native.sh
# --example: with the features that the tests' build has given to the crates they share
cargo build --quiet --locked --profile "$profile" "${workspace[@]}" --bin magcomp --example expected
home=$target/python
rm -rf "$home/wheels"
python3 -m venv --clear "$home/venv"
"$home/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check --requirement python/tests/requirements.txt ${MAGCOMP_NIGHT:+pyspark==4.3.0}
# the profile `dev` is `test`, which would make a test of it, and no module; `beside` takes the crates that were built above
beside=(--features beside)
[ -z "${PROFILE:-}" ] || beside=()
PATH=$home/venv/bin:$PATH maturin build --quiet --locked --profile "${PROFILE:-dev}" ${beside[@]+"${beside[@]}"} --manifest-path python/Cargo.toml --out "$home/wheels"
"$home/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check --no-deps "$home"/wheels/magcomp-*.whl
# as a user gets it: the wheel and what it asks for, nothing else
python3 -m venv --clear "$home/clean"
"$home/clean/bin/pip" install --quiet --no-compile --disable-pip-version-check "$home"/wheels/magcomp-*.whl
(cd "$home" && clean/bin/python -P -c 'import doctest, magcomp; assert doctest.testmod(magcomp) == (0, 8), "the docstring"')
# from the folder of the tests: the package must come from the wheel
cd python/tests
MAGCOMP_COMMAND=$native/magcomp "$home/venv/bin/python" -P -m pytest -q -p no:cacheprovider "$@"
"$home/venv/bin/python" -P -m mypy --config-file ../pyproject.toml --cache-dir "$home/mypy" --package magcomp
"$home/venv/bin/python" -P -m mypy --config-file ../pyproject.toml --cache-dir "$home/mypy" typed.py
# the one module whose types are written beside it
"$home/venv/bin/python" -P -m mypy.stubtest --mypy-config-file ../pyproject.toml magcomp._magcomp
