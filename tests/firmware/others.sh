# What runs beside the tables: the juggler, the exported library in C, the frameworks' programs.

# The juggler under its controller in an interrupt of 1 kHz. One instruction takes 8 ns: a processor of 125 MHz that does one per cycle.
juggling() {
    local firmware
    (cd "$here" && cargo run --quiet --locked --release --bin juggling --features "std,$3") >"$work/here" || wrong "juggling does not run on this machine"
    firmware=$(build "$1" juggling "$3")
    qemu -M "$2" -nographic -monitor none -serial none -icount shift=3,align=off,sleep=off -semihosting-config enable=on,target=native \
        -kernel "$firmware" >"$work/there" || wrong "juggling stopped with an error on $1"
    diff "$work/here" <(grep -v '^deadlines' "$work/there") || wrong "$1 juggles otherwise than this machine (above: <, this machine)"
    printf '\nThe juggler on %s (%s), the bits of this machine: %s\n\n' "$1" "${3:-single}" "$(sed -n 's/^deadlines\t\(.*\)\t/deadlines \1, /p' "$work/there")"
    awk -F'\t' 'BEGIN { print "| t (s) | top (m) | asked for (m) | beside the middle: x, y (mm) |\n| ---: | ---: | ---: | ---: |" }
        NF == 5 { printf "| %s | %s | %s | %s, %s |\n", $1, $2, $3, $4, $5 }' "$work/there"
    grep -q '^deadlines.0 of ' "$work/there" || wrong "the controller misses deadlines on $1"
}

# The exported library of the two sleds, called by the same C program here and on a board: build_c PROCESSOR FEATURES prints the two programs' paths.
build_c() {
    local folder=$here/target/c/${2:-single} root=$here/../.. cargo=cargo options=() number=() unit
    case $1 in
        cortex-m7) unit=fpv5-d16 ;;
        *) unit=fpv4-sp-d16 ;;
    esac
    [ "$2" = double ] || options=(--single) number=(-DSINGLE)
    (cd "$root" && cargo build --quiet --locked --workspace --bin hodograph) >&2 || wrong "the tool does not build"
    rm -rf "$folder"
    mkdir -p "$folder"
    "${CARGO_TARGET_DIR:-$root/target}/debug/hodograph" export --c "$root/models/two_sleds.mech" -o "$folder/two_sleds" --hodograph "$root/runtime" \
        "${options[@]}" >&2 || wrong "the model cannot be exported"
    cp "$root/Cargo.lock" "$folder/two_sleds/"
    has_target || cargo=$tools/rust/bin/cargo
    (
        cd "$folder/two_sleds"
        unset CARGO_BUILD_TARGET
        cargo build --quiet --release --target-dir "$here/target/c/desktop"
        RUSTFLAGS="-Ctarget-cpu=$1" "$cargo" build --quiet --release --no-default-features --target $target --target-dir "$here/target/c/$1"
    ) >&2 || wrong "the exported library does not build"
    local common=(-std=c99 -O2 -Wall -Wextra -Werror "${number[@]}" -I "$folder/two_sleds/include" "$here/c/main.c")
    cc "${common[@]}" "$here/c/desktop.c" "$here/target/c/desktop/release/libtwo_sleds.a" -lm -lpthread -ldl -o "$folder/here" >&2 ||
        wrong "the C program does not build for this machine"
    c_compile "${common[@]}" "$here/c/board.c" "$here/target/c/$1/$target/release/libtwo_sleds.a" -ffreestanding -nostdlib "-mcpu=$1" -mthumb \
        -mfloat-abi=hard "-mfpu=$unit" -Wl,-z,noexecstack -T "$here/c/memory.ld" -o "$folder/there" >&2 || wrong "the C program does not build for $1"
    echo "$folder/here" "$folder/there"
}

in_c() {
    local programs
    command -v cc >/dev/null || cannot "no C compiler for this machine"
    c_compiler
    read -r -a programs <<<"$(build_c "$1" "$3")"
    [ "${#programs[@]}" = 2 ] || wrong "the C program does not build"
    "${programs[0]}" >"$work/here" || wrong "the C program fails on this machine"
    qemu -M "$2" -nographic -monitor none -serial none -semihosting-config enable=on,target=native -kernel "${programs[1]}" >"$work/there" ||
        wrong "the C program fails on $1"
    diff "$work/here" "$work/there" || wrong "the C program gets other bits on $1 than on this machine (above: <, this machine)"
    printf '\nIn C on %s (%s): %d lines, the bits of this machine in all\n' "$1" "${3:-single}" "$(wc -l <"$work/there")"
}

# The frameworks' programs build, and hold neither a panic's message nor an allocator.
shapes() {
    local cargo=cargo folder=$here/target/shapes name
    has_target || cargo=$tools/rust/bin/cargo
    (cd "$here/shapes" && env -u CARGO_BUILD_TARGET RUSTFLAGS="-Ctarget-cpu=cortex-m4" "$cargo" build --quiet --locked --release --target $target \
        --target-dir "$folder") >&2 || wrong "the programs of shapes do not build"
    printf '\n| shape | flash (bytes) |\n| --- | ---: |\n'
    for name in rtic embassy; do
        size -A -d "$folder/$target/release/$name" | awk -v name="$name" '$1 ~ /^\.(text|rodata|data|vector_table)$/ { sum += $2 } END { printf "| %s | %d |\n", name, sum }'
        if nm "$folder/$target/release/$name" | grep -qE '__rust_alloc|__rdl_alloc'; then wrong "an allocator is in $name"; fi
    done
}
