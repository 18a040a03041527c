# The tools of `run`: those that the machine lacks are unpacked from Debian's packages into $tools.

# apt-get with folders of its own.
apt_get() {
    apt-get -qq -o Dir::State="$tools/apt" -o Dir::State::status=/var/lib/dpkg/status -o Dir::Cache="$tools/apt" \
        -o Dir::Log="$tools/apt" -o Debug::NoLocking=true -o APT::Sandbox::User=root "$@"
}

# unpack FOLDER PACKAGE..: packages and what they need and the machine has not.
unpack() {
    local folder=$1 downloads
    shift
    command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || cannot "no apt-get here, and no compiler or emulator for $target"
    mkdir -p "$folder" "$tools/apt/lists/partial" "$tools/apt/archives/partial"
    apt_get update >"$tools/apt/log" 2>&1 || true
    downloads=$(mktemp -d "$tools/packages.XXXXXX")
    { apt_get install --simulate --no-install-recommends "$@" 2>>"$tools/apt/log" || cannot "apt has no $*"; } |
        awk '/^Inst/ { print $2 }' >"$downloads/names"
    printf '%s\n' "$@" >>"$downloads/names"
    (cd "$downloads" && sort -u names | xargs apt-get -qq -o Dir::State="$tools/apt" -o Dir::State::status=/var/lib/dpkg/status \
        -o Dir::Cache="$tools/apt" -o Debug::NoLocking=true -o APT::Sandbox::User=root download >>"$tools/apt/log" 2>&1) ||
        cannot "the packages $* could not be fetched: $tools/apt/log"
    for package in "$downloads"/*.deb; do
        dpkg-deb --fsys-tarfile "$package" | tar -x -C "$folder" --anchored --no-wildcards-match-slash --exclude './usr/share/doc' --exclude './usr/share/man' \
            --exclude './usr/src/rustc-*/src' --exclude './usr/src/rustc-*/tests' --exclude './usr/src/rustc-*/compiler'
    done
    rm -rf "$downloads"
}

# Folders with the libraries of unpacked programs.
libraries() { find "$1/usr/lib" "$1/lib" -maxdepth 2 \( -name '*-linux-gnu' -o -name pulseaudio \) 2>/dev/null | paste -sd: -; }

has_target() { ls "$(rustc --print target-libdir --target $target 2>/dev/null)"/libcore-*.rlib >/dev/null 2>&1; }

compiler() {
    local root=$tools/rust version host program
    [ -e "$root/complete" ] && return
    echo "firmware: unpacking a compiler that has its library's sources (once)" >&2
    rm -rf "$root"
    unpack "$root" rustc-web cargo-web rust-web-src
    version=$(basename "$(ls "$root"/usr/lib/*/libLLVM.so.* /usr/lib/*/libLLVM.so.* 2>/dev/null | sort -V | tail -n 1)")
    version=${version#libLLVM.so.}
    unpack "$root" "lld-${version%%.*}"
    mkdir -p "$root/bin"
    for program in rustc rustdoc cargo; do
        printf '%s\n' '#!/bin/sh' "export LD_LIBRARY_PATH='$(libraries "$root")'" "export RUSTC='$root/bin/rustc'" \
            "exec '$root/usr/bin/$program' \"\$@\"" >"$root/bin/$program"
        chmod +x "$root/bin/$program"
    done
    host=$("$root/bin/rustc" -vV | sed -n 's/^host: //p') || cannot "the unpacked compiler does not run"
    mkdir -p "$root/usr/lib/rustlib/$host/bin"
    ln -sf "$(ls -d "$root"/usr/lib/llvm-*/bin/lld | tail -n 1)" "$root/usr/lib/rustlib/$host/bin/rust-lld"
    touch "$root/complete"
}

# The core library for the target, from the sources beside the compiler.
library() {
    local root=$tools/rust place=$tools/rust/usr/lib/rustlib/$target/lib sources package
    [ -e "$place/complete" ] && return
    echo "firmware: building the core library for $target (once)" >&2
    sources=$(ls -d "$root"/usr/src/rustc-*/library)
    package=$(mktemp -d "$tools/library.XXXXXX")
    mkdir -p "$package/src" "$place"
    echo '#![no_std]' >"$package/src/lib.rs"
    printf '%s\n' '[package]' 'name = "nothing"' 'edition = "2024"' '[workspace]' '[profile.release]' 'panic = "abort"' >"$package/Cargo.toml"
    (cd "$package" && env -u CARGO_TARGET_DIR -u CARGO_BUILD_TARGET RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Cembed-bitcode=yes" "$root/bin/cargo" build \
        --offline --release --target $target -Zbuild-std=core,alloc -Zbuild-std-features=compiler-builtins-mem \
        --config 'source.crates-io.replace-with="beside"' --config "source.beside.directory=\"$sources/vendor\"") >"$tools/library.log" 2>&1 ||
        cannot "the core library could not be built: $tools/library.log"
    find "$package/target/$target/release/deps" -name '*.rlib' ! -name 'libnothing-*' -exec cp {} "$place" \;
    rm -rf "$package"
    touch "$place/complete"
}

emulator() {
    command -v qemu-system-arm >/dev/null && return
    if [ ! -e "$tools/qemu/complete" ]; then
        echo "firmware: unpacking the emulator (once)" >&2
        rm -rf "$tools/qemu"
        unpack "$tools/qemu" qemu-system-arm
        touch "$tools/qemu/complete"
    fi
}

# The compiler for C, and what it needs.
c_compiler() {
    command -v arm-none-eabi-gcc >/dev/null && return
    if [ ! -e "$tools/gcc/complete" ]; then
        echo "firmware: unpacking a C compiler (once)" >&2
        rm -rf "$tools/gcc"
        unpack "$tools/gcc" gcc-arm-none-eabi
        touch "$tools/gcc/complete"
    fi
}

objdump() {
    if command -v arm-none-eabi-objdump >/dev/null; then
        arm-none-eabi-objdump "$@"
    else
        LD_LIBRARY_PATH=$(libraries "$tools/gcc") "$tools/gcc/usr/bin/arm-none-eabi-objdump" "$@"
    fi
}

c_compile() {
    if command -v arm-none-eabi-gcc >/dev/null; then
        arm-none-eabi-gcc "$@"
    else
        LD_LIBRARY_PATH=$(libraries "$tools/gcc") "$tools/gcc/usr/bin/arm-none-eabi-gcc" "$@"
    fi
}

# The emulator of this machine's processor, for programs.
own_emulator() {
    command -v qemu-x86_64 >/dev/null && return
    if [ ! -e "$tools/qemu-user/complete" ]; then
        echo "firmware: unpacking the emulator of x86-64 (once)" >&2
        rm -rf "$tools/qemu-user"
        unpack "$tools/qemu-user" qemu-user
        touch "$tools/qemu-user/complete"
    fi
}

own_qemu() {
    if command -v qemu-x86_64 >/dev/null; then
        qemu-x86_64 "$@"
    else
        LD_LIBRARY_PATH=$(libraries "$tools/qemu-user") "$tools/qemu-user/usr/bin/qemu-x86_64" "$@"
    fi
}

qemu() {
    if command -v qemu-system-arm >/dev/null; then
        timeout "$patience" qemu-system-arm "$@"
    else
        LD_LIBRARY_PATH=$(libraries "$tools/qemu") timeout "$patience" "$tools/qemu/usr/bin/qemu-system-arm" "$@"
    fi
}
