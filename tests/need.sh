# Sourced. `need PART TOOL:PACKAGE...` checks each tool by itself and installs the Debian packages of the missing ones. Where
# it may not (not root, no apt-get) or apt-get fails, it names what is missing and ends the script.
# TOOL is a command, an absolute path (with wildcards), `jdk`: a Java compiler, 17 or newer, or `venv`: Python that makes environments.

# `cc` and the C library's headers: cargo links with them
rust_tools=(cargo: cc:gcc '/usr/include/stdio.h:libc6-dev')
# Debian's own Rust brings the source of std, which the mobile targets are built from
debian_rust=(/usr/bin/cargo:cargo-web /usr/bin/rustc:rustc-web '/usr/lib/rustlib/src/rust/library:rust-web-src' "${rust_tools[@]:1}")
java_tools=(jdk:default-jdk-headless mvn:maven)

# `workspace`: what cargo selects in every part. With fewer packages it picks other features of the crates that they share and
# builds these again; so it does without dependencies of tests, which `cargo test`, `--all-targets` and `--example expected` take in.
# Not the generator of the bindings, 5 lines on a large library: its features would put that library into the one that is tested.
# test-hooks: the library is the one that the other languages test. formats: the lab with all its importers.
workspace=(--workspace --exclude uniffi-bindgen --features magcomp-ffi/test-hooks,magcomp-lab/formats)

there() { # TOOL
    case "$1" in
        /*) compgen -G "$1" >/dev/null ;;
        jdk)
            local version
            version=$("${JAVA_HOME:+$JAVA_HOME/bin/}javac" -version 2>&1 | sed -n 's/^javac \([0-9]*\).*/\1/p')
            [ "${version:-0}" -ge 17 ]
            ;;
        venv) python3 -c 'import ensurepip, venv' 2>/dev/null ;;
        *) type -P "$1" >/dev/null ;; # one at a time: with several, `command -v` is content with any
    esac
}

missing() { # TOOL:PACKAGE... -> sets `lacking` to the pairs whose tool is missing
    local pair
    lacking=()
    for pair; do
        there "${pair%%:*}" || lacking+=("$pair")
    done
}

need() { # PART TOOL:PACKAGE...
    local part=$1 lacking pair packages=() why='run this as root where there is apt-get, or install them'
    shift
    missing "$@"
    for pair in ${lacking[@]+"${lacking[@]}"}; do
        case " ${packages[*]:-} " in
            *" ${pair#*:} "*) ;;
            *) packages+=(${pair#*:}) ;;
        esac
    done
    if [ ${#packages[@]} -gt 0 ] && [ "$(id -u)" = 0 ] && type -P apt-get >/dev/null; then
        echo "$part: installing ${packages[*]}"
        # --no-remove: Debian's Rust conflicts with Debian's rustup, which is not ours to remove
        if apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends --no-remove \
            -o DPkg::Lock::Timeout=600 "${packages[@]}" >/dev/null; then
            why='apt-get installed the packages, which did not bring them'
        else
            why='apt-get could not install them, see above'
        fi
        hash -r
        missing "$@"
    fi
    [ ${#lacking[@]} -gt 0 ] || return 0
    for pair in "${lacking[@]}"; do
        case "$pair" in
            cargo:) echo "$part: missing: cargo; install Rust 1.89 or newer" ;;
            jdk:*) echo "$part: missing: a JDK 17 or newer (Debian package ${pair#*:}), on PATH or in JAVA_HOME; $why" ;;
            *) echo "$part: missing: ${pair%%:*} (Debian package ${pair#*:}); $why" ;;
        esac
    done >&2
    exit 1
}

# `need_cargo PART CRATE@VERSION...`: commands of the Rust registry, built once into target/tools, with which PATH then begins.
need_cargo() {
    local part=$1 tools crate
    tools=$(realpath -m "${CARGO_TARGET_DIR:-target}")/tools
    shift
    for crate; do
        grep -qsF "\"${crate%@*} ${crate#*@} " "$tools/.crates.toml" && continue
        echo "$part: building $crate"
        CARGO_TARGET_DIR=$tools/build cargo install --quiet --locked --root "$tools" "$crate"
    done
    export PATH=$tools/bin:$PATH
}

# `need_llvm PART TOOL:PACKAGE...` asks for LLVM's tools, each without its suffix, such as -22, which it sets as `llvm`. Debian has
# several; one that is older than the LLVM of the compiler can't read what that compiler writes. So: the newest from there on, of
# those that are here and those that apt knows. LLVM, where it is set, is the suffix instead.
need_llvm() {
    local part=$1 least pair pairs=()
    shift
    if [ -n "${LLVM+set}" ]; then
        llvm=$LLVM
    else
        need "$part" "${debian_rust[@]}"
        least=$(/usr/bin/rustc -vV | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')
        llvm=-$({
            echo "$least"
            compgen -c llvm-nm- || true
            apt-cache search --names-only '^llvm-[0-9]+$' || true
        } 2>/dev/null | sed -n 's/^\(llvm-\(nm-\)\?\)\?\([0-9]\+\)\( .*\)\?$/\3/p' | sort -n | tail -n 1)
    fi
    for pair; do pairs+=("${pair%%:*}$llvm:${pair#*:}$llvm"); done
    need "$part" "${pairs[@]}"
}
