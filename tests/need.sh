# Sourced. `need PART TOOL:PACKAGE...` checks each tool by itself and installs the Debian packages of the missing ones. Where
# it may not (not root, no apt-get) or apt-get fails, it names what is missing and ends the script.
# TOOL is a command, an absolute path (with wildcards), `jdk`: a Java compiler, 17 or newer, `venv`: Python that makes environments, or
# `fmt` or `clippy`: a part of Rust that rustup has under the name PACKAGE.

# `cc` and the C library's headers: cargo links with them
rust_tools=(cargo: cc:gcc '/usr/include/stdio.h:libc6-dev')
case "${OSTYPE:-}" in darwin* | msys*) rust_tools=(cargo:) ;; esac # theirs come with Xcode's and Visual Studio's tools
rust_checks=(fmt:rustfmt clippy:clippy)
# Debian's own Rust brings the source of std, which the mobile targets are built from
debian_rust=(/usr/bin/cargo:cargo-web /usr/bin/rustc:rustc-web '/usr/lib/rustlib/src/rust/library:rust-web-src' "${rust_tools[@]:1}")
java_tools=(jdk:default-jdk-headless mvn:maven)

# `workspace`: what cargo selects in every part. With fewer packages it picks other features of the crates that they share and
# builds these again; so it does without dependencies of tests, which `cargo test`, `--all-targets` and `--example expected` take in.
# Not the generator of the bindings, 5 lines on a large library: its features would put that library into the one that is tested.
# test-hooks: the library is the one that the other languages test.
# Nor the Python module, which only an interpreter links.
# `lean` is the same without the importers of Parquet, Arrow and bags, whose dependencies are most of all.
lean=(--workspace --exclude uniffi-bindgen --exclude magcomp-python --features magcomp-ffi/test-hooks)
# Windows: its files would have the names of the command's
case "${OSTYPE:-}" in msys*) lean+=(--exclude magcomp-c) ;; esac
workspace=("${lean[@]}" --features magcomp-lab/formats)

there() { # TOOL
    case "$1" in
        /*) compgen -G "$1" >/dev/null ;;
        jdk)
            local version
            version=$("${JAVA_HOME:+$JAVA_HOME/bin/}javac" -version 2>&1 | sed -n 's/^javac \([0-9]*\).*/\1/p')
            [ "${version:-0}" -ge 17 ]
            ;;
        venv) python3 -c 'import ensurepip, venv' 2>/dev/null ;;
        # rustup has a command of this name even where the part is missing; without cargo that is what is said
        fmt | clippy) ! type -P cargo >/dev/null || cargo "$1" --version >/dev/null 2>&1 ;;
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

debian_part() { # of Rust: rustup's name
    [ "$1" = rustfmt ] && echo "apt-get install rustfmt" || echo "apt-get install rust-$1"
}

install_packages() ( # PACKAGE...: one at a time, since parts run beside each other and apt-get refuses a second one
    exec 9>"${TMPDIR:-/tmp}/magcomp-apt.lock"
    ! type -P flock >/dev/null || flock 9
    apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends --no-remove \
        -o DPkg::Lock::Timeout=600 "$@" >/dev/null
)

need() { # PART TOOL:PACKAGE...
    local part=$1 lacking pair packages=() why='run this as root where there is apt-get, or install them'
    shift
    missing "$@"
    for pair in ${lacking[@]+"${lacking[@]}"}; do
        case "$pair: ${packages[*]:-} " in
            fmt:* | clippy:*) ;; # of the Rust that is here, not of apt
            *" ${pair#*:} "*) ;;
            *) packages+=(${pair#*:}) ;;
        esac
    done
    if [ ${#packages[@]} -gt 0 ] && [ "$(id -u)" = 0 ] && type -P apt-get >/dev/null; then
        echo "$part: installing ${packages[*]}"
        # --no-remove: Debian's Rust conflicts with Debian's rustup, which is not ours to remove
        if install_packages "${packages[@]}"; then
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
            fmt:* | clippy:*) echo "$part: missing: ${pair#*:}; rustup component add ${pair#*:}, or, with Debian's Rust, $(debian_part "${pair#*:}")" ;;
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

# `need_std PART TRIPLE [FEATURES]`: sets `std`, what cargo needs to build for TRIPLE. Nothing where its Rust has the standard library or rustup brings it.
# Else Debian's Rust builds it from its source, with FEATURES, in a folder beside CARGO_TARGET_DIR; so it does with PROFILE=ship.
need_std() {
    local libraries
    std=()
    if [ "${PROFILE:-}" != ship ] && libraries=$(rustc --print target-libdir --target "$2" 2>/dev/null); then
        [ -d "$libraries" ] || rustup --quiet target add "$2" 2>/dev/null || true
        if [ -d "$libraries" ]; then
            need "$1" "${rust_tools[@]}"
            return
        fi
    fi
    need "$1" "${debian_rust[@]}"
    std=(-Zbuild-std=std,panic_abort ${3:+"-Zbuild-std-features=$3"})
    export PATH=/usr/bin:$PATH RUSTC_BOOTSTRAP=1 CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}
    CARGO_TARGET_DIR=${CARGO_TARGET_DIR%-debian}-debian
    unset RUSTUP_TOOLCHAIN RUSTFLAGS
}

# `need_llvm PART TOOL:PACKAGE...` asks for LLVM's tools, each without its suffix, such as -22, which it sets as `llvm`. Debian has
# several; one that is older than the LLVM of the compilers can't read what these write. So: the newest from there on, of
# those that are here and those that apt knows. LLVM, where it is set, is the suffix instead.
need_llvm() {
    local part=$1 least pair pairs=() rustc
    shift
    if [ -n "${LLVM+set}" ]; then
        llvm=$LLVM
    else
        type -P rustc >/dev/null || need "$part" "${debian_rust[@]}"
        least=$(for rustc in rustc /usr/bin/rustc; do $rustc -vV 2>/dev/null || true; done |
            sed -n 's/^LLVM version: \([0-9]*\).*/\1/p' | sort -n | tail -n 1)
        llvm=-$({
            echo "$least"
            compgen -c llvm-nm- || true
            apt-cache search --names-only '^llvm-[0-9]+$' || true
        } 2>/dev/null | sed -n 's/^\(llvm-\(nm-\)\?\)\?\([0-9]\+\)\( .*\)\?$/\3/p' | sort -n | tail -n 1)
    fi
    for pair; do pairs+=("${pair%%:*}$llvm:${pair#*:}$llvm"); done
    need "$part" "${pairs[@]}"
}
