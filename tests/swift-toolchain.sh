# Sourced, after need.sh: `swift_run ARGUMENTS...` runs `swift` in this folder, from PATH or in a Debian root; `swift_tool NAME
# ARGUMENTS...` any other tool of the toolchain.
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

# Swift 6 on PATH, or a Debian root that has it
if type -P swift >/dev/null; then
    swift_on_path=yes
else
    swift_on_path=no
    if [ "$(id -u)" != 0 ] || ! unshare -m true; then
        echo "swift: Swift 6 is missing; put it on PATH, or run as root on Debian, which makes $swift_root and mounts in it" >&2
        exit 1
    fi
    # made whole, then renamed
    if [ ! -d "$swift_root" ]; then
        need swift debootstrap:debootstrap /usr/share/keyrings/debian-archive-keyring.gpg:debian-archive-keyring
        echo "swift: making $swift_root"
        rm -rf "$swift_root.tmp"
        mkdir -p "$swift_root.tmp"
        debootstrap --variant=minbase --include=swiftlang,libc6-dev,libstdc++-14-dev trixie "$swift_root.tmp" \
            >"$swift_root.log" || { echo "swift: debootstrap failed, see $swift_root.log" >&2; exit 1; }
        rm -rf "$swift_root.tmp/var/cache/apt/archives/"*.deb
        mv "$swift_root.tmp" "$swift_root"
    fi
fi
