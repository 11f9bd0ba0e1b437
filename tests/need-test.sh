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
    stand_in python3 ''
    stand_in id "echo $1"
    stand_in apt-get "[ \$1 = update ] || {
        echo \"\$*\" | sed 's/.* --no-remove [^ ]* [^ ]* //' >>$work/log
        case \"\$*\" in *package-*-two*) touch $work/bin/two; chmod +x $work/bin/two ;; esac
        case \"\$*\" in *package-one*) touch $work/bin/one; chmod +x $work/bin/one ;; esac
        case \"\$*\" in *package-three*) touch $work/bin/three; chmod +x $work/bin/three ;; esac
        case \"\$*\" in *package-file*) touch $work/file-1 ;; esac
        case \"\$*\" in *package-jdk*) echo 'echo javac 21' >$work/bin/javac ;; esac
        case \"\$*\" in *package-venv*) echo >$work/bin/python3 ;; esac
    }"
    touch "$work/file-1" "$work/log"
}
pairs=(one:package-one two:package-of-two three:package-three "$work/file-*:package-file" jdk:package-jdk venv:package-venv)
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
        package-venv) stand_in python3 'exit 1' ;; # Debian's python3 without python3-venv
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

machine 0 # nor do its parts
stand_in cargo 'case "$1" in fmt) exit 1 ;; esac'
run cargo: fmt:rustfmt clippy:clippy && fail "rustfmt is missing, and it went on"
[ "$(grep -c missing: "$work/out")" = 1 ] && grep -q 'missing: rustfmt; rustup component add rustfmt' "$work/out" && [ ! -s "$work/log" ] ||
    fail "does not name rustfmt alone"
rm "$work/bin/cargo"

machine 0 # LLVM: the newest that is there or that apt knows, never one before the compiler's
llvm() { # INSTALLED... -> runs need_llvm with a compiler of LLVM 19, where apt knows 16, 19 and 22 and $known
    local number
    for number; do stand_in "llvm-nm-$number" ''; done
    PATH=$work/bin bash -euc '. tests/need.sh
        need() { shift; echo "$*"; }
        compiler() { printf "binary: rustc\nrelease: 1.85.0\nLLVM version: 19.1.7\n"; }
        eval "$(declare -f need_llvm | sed "s:/usr/bin/rustc:compiler:")"
        need_llvm part llvm-nm:llvm ld64.lld:lld | tail -n 1' >"$work/out" 2>&1
}
for tool in sort tail; do ln -s "$(type -P $tool)" "$work/bin/"; done
llvm && [ "$(cat "$work/out")" = 'llvm-nm-19:llvm-19 ld64.lld-19:lld-19' ] || fail "no LLVM is known: that of the compiler"
llvm 14 && grep -q '^llvm-nm-19:' "$work/out" || fail "one that is too old was taken"
stand_in apt-cache 'for number in 9 16 22 19; do echo "llvm-$number - Modular compiler and toolchain technologies"; done'
llvm 14 && grep -q '^llvm-nm-22:' "$work/out" || fail "not the newest that apt knows"
llvm 20 23 && [ "$(cat "$work/out")" = 'llvm-nm-23:llvm-23 ld64.lld-23:lld-23' ] || fail "not the newest that is there"
LLVM='' llvm && [ "$(cat "$work/out")" = 'llvm-nm:llvm ld64.lld:lld' ] || fail "LLVM is not the suffix"

# Swift 6 where there is none. Without root:
swift() { # COMMAND... -> tests/swift-toolchain.sh, started by COMMAND
    MAGCOMP_SWIFT_ROOT=$work "$@" bash -euc '. tests/need.sh; . tests/swift-toolchain.sh; echo "on PATH: $swift_on_path"' >"$work/out" 2>&1
}
for tool in mktemp mkdir rmdir; do ln -s "$(type -P $tool)" "$work/bin/"; done
stand_in id 'echo 1000'
! swift env PATH="$work/bin" && grep -q 'missing: Swift 6.*needs root' "$work/out" || fail "does not say that a root is needed"
stand_in swift 'echo "usage: swift [--version] <subcommand>"; exit 2' # OpenStack's
! swift env PATH="$work/bin" && grep -q 'missing: Swift 6' "$work/out" || fail "takes another swift for Swift 6"
stand_in swift 'echo "Swift version 5.10.1"'
! swift env PATH="$work/bin" && grep -q 'missing: Swift 6' "$work/out" || fail "takes Swift 5 for Swift 6"
stand_in swift 'echo "Apple Swift version 6.1.2"'
swift env PATH="$work/bin" && grep -q 'on PATH: yes' "$work/out" || fail "does not see Swift 6"

# every tool of a package that is not always there is asked for by the script that calls it
tools='[a-z0-9.]+(-[a-z]+)*-19|readelf|nm|ar|unzip|zip|git|python3|mvn|javac|valgrind|debootstrap|cmake|pkg-config|chromium'
for script in tests/*.sh bindings/*.sh ios/*.sh web/*.sh; do
    case "$script" in tests/need*.sh) continue ;; esac
    called=$(sed -E 's/^ *#.*//; s/(^| )need .*//' "$script" | grep -oE "(^|[ ({])($tools) " | tr -d ' ({' | sort -u || true)
    for tool in $called; do
        grep -E '(^| )need ' "$script" | sed "s/\"\${java_tools\[@\]}\"/mvn: javac:/; s/^/ /" | grep -qE "[ +]$tool:" ||
            { echo "need-test: $script calls $tool and does not ask for it with 'need'" >&2; exit 1; }
    done
done

# the rest as root alone, who may change the root
if [ "$(id -u)" != 0 ] || ! chroot / true 2>/dev/null; then
    echo "need-test: every probe names exactly what is missing; no root here may be changed, so the scripts themselves were not tried"
    exit 0
fi

# a small root with what every Debian has, as far as the scripts use it before they know what is missing
root=$work/root
copy() { # COMMAND...: with the libraries they load
    local command file
    for command; do
        command=$(type -P "$command")
        for file in "$command" $(ldd "$command" 2>/dev/null | grep -oE '/[^ ]+' || true); do
            [ -e "$root$file" ] || install -D "$(realpath "$file")" "$root$file"
        done
    done
}
mkdir -p "$root"/{usr/{bin,sbin,lib,lib64},tmp,dev,project,given}
for folder in bin sbin lib lib64; do ln -s "usr/$folder" "$root/$folder"; done
touch "$root/dev/null"
copy true bash sh env dirname basename realpath id sed grep tr mkdir rm rmdir mktemp cat sort tail uname chroot mount unshare
cp -r --parents tests/*.sh bindings/*.sh ios/*.sh web/*.sh "$root/project/"
ln -sf /bin/true "$root/project/tests/need-test.sh" # not this script in itself
within() { # COMMAND...: in that root
    chroot "$root" env -i HOME=/root PATH=/given:/usr/bin:/usr/sbin "$@" >"$work/out" 2>&1
}

# Swift where nothing may be mounted, for real
! swift setpriv --bounding-set -sys_admin --inh-caps -sys_admin || fail "mounts without CAP_SYS_ADMIN"
grep -q 'missing: Swift 6.*may not mount.*CAP_SYS_ADMIN' "$work/out" || fail "does not say that it may not mount"
! within bash /project/tests/swift.sh || fail "goes on without cargo"
for tool in cargo cc python3 zip; do printf '#!/bin/sh\n' >"$root/given/$tool" && chmod +x "$root/given/$tool"; done
install -D /dev/null "$root/usr/include/stdio.h"
! within bash /project/tests/swift.sh || fail "mounts in a chroot"
if unshare -m true 2>/dev/null; then
    grep -q 'missing: Swift 6.*is a chroot.*mount --bind' "$work/out" || fail "does not say what a chroot needs"
fi

# every script with every tool that it asks for hidden in turn: it installs that package, or names that tool
file_of() { # TOOL
    case "$1" in
        /*) echo "$root${1//\*/any}" ;;
        jdk) echo "$root/given/javac" ;;
        *) echo "$root/given/$1" ;;
    esac
}
give() { # TOOL
    local file text=''
    file=$(file_of "$1")
    case "$1" in
        jdk) text='echo javac 17.0.15' ;;
        /usr/bin/rustc) text='echo "LLVM version: 22.1.8"' ;;
    esac
    mkdir -p "${file%/*}"
    printf '#!/bin/sh\n%s\n' "$text" >"$file"
    chmod +x "$file"
}
asked() { # the pairs that the last run named as missing
    sed -n -E 's/.*missing: cargo;.*/cargo:/p; s/.*missing: a JDK .*\(Debian package (.*)\).*/jdk:\1/p
        s/.*missing: ([^ ]+) \(Debian package (.*)\).*/\1:\2/p' "$work/out"
}
tried=0
for call in 'tests/run.sh rust' bindings/generate.sh tests/kotlin.sh tests/swift.sh tests/c.sh tests/mobile.sh tests/aar.sh tests/xcframework.sh \
    ios/build-xcframework.sh 'ios/build-xcframework.sh --pack URL' tests/instructions.sh web/build.sh; do
    rm -rf "$root"/{given,usr/include,usr/share,usr/lib/{rustlib,jvm,any}} "$root"/usr/bin/{cargo,rustc}
    give unshare # mounts are not what is tried here
    pairs=()
    while :; do # a script may ask more than once
        ! within bash /project/$call || [ ${#pairs[@]} -gt 0 ] || fail "$call needs nothing"
        mapfile -t more < <(asked)
        [ ${#more[@]} -gt 0 ] || break
        for pair in "${more[@]}"; do give "${pair%%:*}"; done
        pairs+=("${more[@]}")
    done
    [ ${#pairs[@]} -gt 0 ] || fail "$call asks for nothing"
    # it has nothing to install with, or nothing that brings it
    for apt in '' '[ "$1" = update ] || echo "$*" >>/log'; do
        for pair in "${pairs[@]}"; do
            rm "$(file_of "${pair%%:*}")"
            rm -f "$root/log" "$root/given/apt-get"
            if [ -n "$apt" ]; then printf '#!/bin/sh\n%s\n' "$apt" >"$root/given/apt-get" && chmod +x "$root/given/apt-get"; fi
            ! within bash /project/$call || fail "$call goes on without ${pair%%:*}"
            [ "$(asked)" = "$pair" ] || fail "$call names '$(asked)' where $pair is missing"
            [ -z "$apt" ] || [ "$pair" = cargo: ] || grep -q " ${pair#*:}\$" "$root/log" || fail "$call does not install ${pair#*:}"
            give "${pair%%:*}"
            tried=$((tried + 1))
        done
    done
done
echo "need-test: every probe names exactly what is missing, and so do the scripts, tried $tried times with one tool hidden"
