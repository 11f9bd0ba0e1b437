#!/usr/bin/env bash
# tests/need.sh: a probe finds exactly the tool that is missing, wherever others are there, and installs or names it. Works on
# a PATH of its own with stand-ins of `id` and `apt-get`; installs nothing on the machine.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "need-test: $*" >&2; sed 's/^/    /' "$work/out" >&2; exit 1; }
stand_in() { # NAME TEXT
    printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}
machine() { # UID: a machine with the tools one, two and three, a JDK 17, one file and an apt-get that brings what is asked
    rm -rf "$work/bin" "$work/log" "$work/file-1"
    mkdir "$work/bin"
    for tool in bash sh sed touch chmod; do ln -s "$(type -P $tool)" "$work/bin/"; done
    for tool in one two three; do stand_in $tool ''; done
    stand_in javac 'echo javac 17.0.15'
    stand_in id "echo $1"
    stand_in apt-get "[ \$1 = update ] || {
        echo \"\$*\" | sed 's/.* --no-remove [^ ]* [^ ]* //' >>$work/log
        case \"\$*\" in *package-*-two*) touch $work/bin/two; chmod +x $work/bin/two ;; esac
        case \"\$*\" in *package-one*) touch $work/bin/one; chmod +x $work/bin/one ;; esac
        case \"\$*\" in *package-three*) touch $work/bin/three; chmod +x $work/bin/three ;; esac
        case \"\$*\" in *package-file*) touch $work/file-1 ;; esac
        case \"\$*\" in *package-jdk*) echo 'echo javac 21' >$work/bin/javac ;; esac
    }"
    touch "$work/file-1" "$work/log"
}
pairs=(one:package-one two:package-of-two three:package-three "$work/file-*:package-file" jdk:package-jdk)
run() { # PAIR...
    PATH=$work/bin JAVA_HOME='' bash -euc '. tests/need.sh; need part "$@"; echo went on' need "$@" >"$work/out" 2>&1
}
hide() { # PACKAGE
    case "$1" in
        package-one) rm "$work/bin/one" ;;
        package-of-two) rm "$work/bin/two" ;;
        package-three) rm "$work/bin/three" ;;
        package-file) rm "$work/file-1" ;;
        package-jdk) stand_in javac 'echo javac 11.0.2' ;; # too old
    esac
}

machine 0
run "${pairs[@]}" || fail "nothing is missing"
[ ! -s "$work/log" ] || fail "nothing is missing, and it installed $(cat "$work/log")"

for pair in "${pairs[@]}"; do
    package=${pair##*:}
    machine 0 # root: installs that one
    hide "$package"
    run "${pairs[@]}" || fail "$package was not installed"
    [ "$(cat "$work/log")" = "$package" ] || fail "for $package it installed '$(cat "$work/log")'"

    machine 1000 # not root: names that one
    hide "$package"
    ! run "${pairs[@]}" || fail "$package is missing, and it went on"
    [ "$(grep -c missing: "$work/out")" = 1 ] && grep -q "missing: .*$package" "$work/out" || fail "names not just $package"
    [ ! -s "$work/log" ] || fail "it installed without being root"

    machine 0 # no apt-get: names that one
    hide "$package"
    rm "$work/bin/apt-get"
    ! run "${pairs[@]}" || fail "$package is missing, and it went on"
    grep -q "missing: .*$package" "$work/out" || fail "does not name $package"

    machine 0 # apt-get that fails, or brings something else
    for end in 'exit 100' 'exit 0'; do
        hide "$package" 2>/dev/null || true
        stand_in apt-get "[ \$1 = update ] || $end"
        ! run "${pairs[@]}" || fail "$package is still missing, and it went on"
        grep -q "missing: .*$package.*apt-get" "$work/out" || fail "does not name $package"
    done
done

machine 0 # two at once
rm "$work/bin/one" "$work/bin/three"
run "${pairs[@]}" && [ "$(cat "$work/log")" = "package-one package-three" ] || fail "installed '$(cat "$work/log")'"

machine 0 # Rust does not come from apt
run cargo: one:package-one && fail "cargo is missing, and it went on"
grep -q 'missing: cargo; install Rust' "$work/out" && [ ! -s "$work/log" ] || fail "does not name cargo"

# every tool of a package that is not always there is asked for by the script that calls it
tools='[a-z0-9.]+(-[a-z]+)*-19|readelf|nm|ar|unzip|zip|python3|mvn|javac|valgrind|debootstrap'
for script in tests/*.sh bindings/*.sh ios/*.sh; do
    case "$script" in tests/need*.sh) continue ;; esac
    called=$(sed -E 's/^ *#.*//; s/(^| )need .*//' "$script" | grep -oE "(^|[ ({])($tools) " | tr -d ' ({' | sort -u || true)
    for tool in $called; do
        grep -E '(^| )need ' "$script" | sed "s/\"\${java_tools\[@\]}\"/mvn: javac:/; s/^/ /" | grep -qE "[ +]$tool:" ||
            { echo "need-test: $script calls $tool and does not ask for it with 'need'" >&2; exit 1; }
    done
done
echo "need-test: every probe names exactly what is missing"
