#!/usr/bin/env bash
# Instructions per sample, counted by valgrind: the same on every run and every load of the machine. `tests/instructions.sh rates` counts those of a
# hand-held phone by method and rate instead, beside VQF, `tests/instructions.sh borders` those of a sample with its gyroscope's and accelerometer's from C
# and from Python; docs/dev/COST.md has them.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need instructions "${rust_tools[@]}" valgrind:valgrind
cargo build -q --release -p magcomp --example instructions
run=${CARGO_TARGET_DIR:-target}/release/examples/instructions

counted() { # COMMAND... -> instructions of the whole run
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 | sed -n 's/.*I *refs: *//p' | tr -d ,
}
count() { # CASE COUNT RATE -> instructions of the whole run
    counted "$run" "$1" "$2" "$3"
}
per_sample() { # CASE FEW MANY [RATE]
    local few many
    few=$(count "$1" "$2" "${4:-100}")
    many=$(count "$1" "$3" "${4:-100}")
    echo $(((many - few) / ($3 - $2)))
}
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.2f", a / b }'; }

if [ "${1:-}" = rates ]; then
    echo "| samples a second | with the gyroscope | times VQF | magnetometer alone | paper's method | VQF |"
    echo "|---|---|---|---|---|---|"
    for rate in 25 50 100 200; do # 40 s each, after 30
        aided=$(per_sample aided 10 $((40 * rate + 10)) $rate)
        vqf=$(per_sample vqf 10 $((40 * rate + 10)) $rate)
        echo "| $rate | $aided | $(ratio "$aided" "$vqf") | $(per_sample adaptive 10 $((40 * rate + 10)) $rate) |" \
            "$(per_sample windowed 10 $((40 * rate + 10)) $rate) | $vqf |"
    done
    exit
fi

if [ "${1:-}" = borders ]; then
    home=$(realpath -m "${CARGO_TARGET_DIR:-target}")/borders
    need instructions cc:gcc cmake:cmake make:make pkg-config:pkg-config
    cmake -S c -B "$home/c" >/dev/null
    cmake --build "$home/c" >/dev/null
    cmake --install "$home/c" --prefix "$home/prefix" >/dev/null
    # shellcheck disable=SC2046 # its words are options
    cc -O2 -std=c99 -Wall -Wextra -Werror c/tests/cost.c -o "$home/cost" \
        $(PKG_CONFIG_PATH=$home/prefix/lib/pkgconfig pkg-config --cflags --libs magcomp)
    # what tests/python.sh leaves
    python=$(dirname "$home")/python/venv/bin/python
    "$python" -c 'import magcomp' 2>/dev/null || tests/python.sh
    "$run" events 4000 100 >"$home/events.txt"
    between() { # COMMAND... -> instructions a sample, of 4000 after 3000
        local few many
        few=$(counted "$@" 3000 <"$home/events.txt")
        many=$(counted "$@" 7000 <"$home/events.txt")
        echo $(((many - few) / 4000))
    }
    export LD_LIBRARY_PATH=$home/prefix/lib PYTHONHASHSEED=0
    echo "| method | Rust | C | times | Python, arrays | times | Python, one by one | times |"
    echo "|---|---|---|---|---|---|---|---|"
    for method in Auto:aided Windowed:windowed Constant:constant; do
        rust=$(per_sample "${method#*:}" 0 4000)
        row="| ${method%:*} | $rust |"
        for border in "$home/cost" "$python python/tests/cost.py process" "$python python/tests/cost.py push"; do
            # shellcheck disable=SC2086 # its words are arguments
            here=$(between $border "${method%:*}")
            row+=" $here | $(ratio "$here" "$rust") |"
        done
        echo "$row"
    done
    exit
fi

fit_100=$(per_sample fit-100 100 1100)
fit_2000=$(per_sample fit-2000 100 1100)
direct=$(per_sample direct-2000 1 11)
push_100=$(per_sample push-100 100 1100)
push_2000=$(per_sample push-2000 100 1100)
aided=$(per_sample aided 10 4010)
adaptive=$(per_sample adaptive 10 4010)
vqf=$(per_sample vqf 10 4010)
echo "instructions per sample"
echo "  fitting part (moments and iterations), window 100    $fit_100"
echo "  fitting part (moments and iterations), window 2000   $fit_2000   $(ratio "$fit_2000" "$fit_100") times that of 100"
echo "  direct per-sample fit to convergence, window 2000    $direct   $(ratio "$direct" "$fit_2000") times the fitting part"
echo "  whole push, window 100                               $push_100"
echo "  whole push, window 2000                              $push_2000   $(ratio "$push_2000" "$push_100") times that of 100"
echo "  whole push, hand-held, aided, a step every 10 s      $aided"
echo "  the same, adaptive                                   $adaptive"
echo "  the same, VQF (the crate vqf-rs)                     $vqf   aided takes $(ratio "$aided" "$vqf") times that"
