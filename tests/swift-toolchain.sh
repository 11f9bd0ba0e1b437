# Sourced, after need.sh: `swift_run ARGUMENTS...` runs `swift` in this folder, from PATH or in a Debian root; `swift_tool NAME
# ARGUMENTS...` any other tool of the toolchain. `target` has to be set before they run.
swift_root=${MAGCOMP_SWIFT_ROOT:-${XDG_CACHE_HOME:-$HOME/.cache}/magcomp/swift}

swift_run() { swift_tool swift "$@"; }

swift_tool() {
    if [ "$swift_on_path" = yes ]; then
        "$@"
        return
    fi
    # a mount namespace of its own, so that nothing stays mounted
    swift_root=$swift_root swift_source=$PWD swift_target=$target unshare -m bash -euc '
        mount -t proc proc "$swift_root/proc"
        for folder in "$swift_source" "$swift_target"; do
            mkdir -p "$swift_root$folder"
            mount --bind "$folder" "$swift_root$folder"
        done
        exec chroot "$swift_root" env HOME=/root LANG=C.UTF-8 PATH=/usr/libexec/swift/bin:/usr/bin:/bin sh -c "cd \"\$0\" && exec \"\$@\"" "$swift_source" "$@"
    ' swift "$@"
}

# why the Debian root can't be used here: what `swift_tool` does is tried with an empty folder. Empty where it can.
swift_obstacle() {
    local folder why
    [ "$(id -u)" = 0 ] || { echo "it needs root, this is user $(id -u)"; return; }
    folder=$(mktemp -d)
    mkdir "$folder/proc" "$folder/bound"
    why=$(LC_ALL=C unshare -m sh -euc 'mount -t proc proc "$0/proc"; mount --bind "$0/proc" "$0/bound"; chroot / true' "$folder" 2>&1) || true
    rmdir "$folder"/{proc,bound} "$folder"
    why=${why%%$'\n'*}
    case "$why" in
        "") ;;
        *"root filesystem propagation"*)
            echo "this is a chroot whose root is no mount point ($why); outside, 'mount --bind ROOT ROOT' before 'chroot ROOT'"
            ;;
        *)
            echo "this container may not mount or change its root ($why); it needs CAP_SYS_ADMIN, CAP_SYS_CHROOT and a /proc that is not masked, as 'docker run --privileged' gives"
            ;;
    esac
}

# Swift 6 on PATH (OpenStack's client is called swift too), or a Debian root that has it
swift_found=$(swift --version 2>&1 | sed -n 's/.*Swift version \([0-9]*\).*/\1/p' || true)
if [ "${swift_found:-0}" -ge 6 ]; then
    swift_on_path=yes
else
    swift_on_path=no
    swift_why=$(swift_obstacle)
    if [ -n "$swift_why" ]; then
        echo "swift: missing: Swift 6. Put it on PATH, or let this script run it in a Debian root, $swift_root. That fails here: $swift_why" >&2
        exit 1
    fi
    # made whole, then renamed
    if [ ! -d "$swift_root" ]; then
        need swift debootstrap:debootstrap /usr/share/keyrings/debian-archive-keyring.gpg:debian-archive-keyring
        echo "swift: making $swift_root"
        rm -rf "$swift_root.tmp"
        mkdir -p "$swift_root.tmp"
        debootstrap --variant=minbase --include=swiftlang,libc6-dev,libstdc++-14-dev trixie "$swift_root.tmp" >"$swift_root.log" || {
            echo "swift: debootstrap failed: $(tail -n 1 "$swift_root.log"); the whole of it is in $swift_root.log" >&2
            exit 1
        }
        rm -rf "$swift_root.tmp/var/cache/apt/archives/"*.deb
        mv "$swift_root.tmp" "$swift_root"
    fi
fi
