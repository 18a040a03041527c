# The tables of `run`: instructions and stack of routines, flash of programs.

# build PROCESSOR PROGRAM FEATURES [alone]: prints the path of the firmware; with `alone` the features name the models.
build() {
    local cargo=cargo folder=$here/target/$1 options=()
    has_target || cargo=$tools/rust/bin/cargo
    [ -z "${4:-}" ] || options=(--no-default-features)
    (cd "$here" && env -u CARGO_BUILD_TARGET RUSTFLAGS="-Ctarget-cpu=$1" "$cargo" build --quiet --locked --release --target $target \
        --target-dir "$folder" --bin "$2" "${options[@]}" --features "$3") >&2 || wrong "$2 does not build for $1"
    echo "$folder/$target/release/$2"
}

# emulate BOARD FIRMWARE: its output; instructions per measured call go to the file counts.
emulate() {
    local begin end options=()
    if [ -e "$tools/count.so" ]; then
        begin=$(nm "$2" | awk '$3 == "mark_begin" { print $1 }') end=$(nm "$2" | awk '$3 == "mark_end" { print $1 }')
        options=(-plugin "$tools/count.so,begin=$begin,end=$end,counts=$work/counts")
    fi
    : >"$work/counts"
    qemu -M "$1" -nographic -monitor none -serial none -semihosting-config enable=on,target=native "${options[@]}" -kernel "$2"
}

# The deepest way of calls from each routine of a program, in bytes of stack: model, routine, bytes.
stack_bounds() {
    objdump -d -C --no-show-raw-insn "$1" >"$work/code" || wrong "the machine code of $1 cannot be read"
    awk -v roots='Contacts<T>>::(collide|contact_mode)$|Mechanism<T>>::accelerations$|^hodograph::solve::collision::solve_real$' \
        -f "$here/stack.awk" "$work/code" >"$work/ways" || wrong "the stack of $1 has no bound (above: where, and why)"
    # What the measurement itself takes.
    awk -v roots='::apart$' -f "$here/stack.awk" "$work/code" 2>/dev/null | sed 's/.*::apart \([0-9]*\).*/\1/' | sort -n | tail -n 1 |
        sed 's/^/apart\t\t/' || true
    sed -nE -e 's/^([0-9]+)\t<hodograph_models::[a-z0-9_]+::([A-Za-z0-9]+)<T> as [^>]*<T>>::([a-z_]+)\t.*/\2\t\3\t\1/p' \
        -e 's/^([0-9]+)\thodograph::solve::collision::solve_real\t.*/reference collisions\tsolve\t\1/p' "$work/ways"
}

# routines OUTPUT FIRMWARE: the rows of a program with the instructions of their calls - the first row's come first, then three rows take turns - and with
# the stack: what was written to, which must be within the bound.
routines() {
    stack_bounds "$2" >"$work/bounds"
    awk -F'\t' -v counts="$work/counts" -v bounds="$work/bounds" '
        BEGIN { while ((getline line < bounds) > 0) { split(line, part, "\t"); bound[part[1], part[2]] = part[3]; if (part[3] > deepest[part[2]]) deepest[part[2]] = part[3] } }
        { calls[NR] = $7; stack[NR] = $8; name[NR] = $1 ": " $2; type = $1; gsub(/_/, "", type); limit[NR] = bound[type, $2]
            # The compiler keeps one of several routines of the same code, under one of their names.
            if (limit[NR] == 0) limit[NR] = deepest[$2] }
        function take(row) { if ((getline count < counts) <= 0) return; sum[row] += count; if (count > most[row]) most[row] = count }
        END {
            for (k = 0; k < calls[1]; k++) take(1)
            for (row = 2; row <= NR; row += 3) for (k = 0; k < calls[row]; k++) for (j = 0; j < 3; j++) take(row + j)
            print "| routine | instructions, mean | most | stack (bytes): painted | bound |\n| --- | ---: | ---: | ---: | ---: |"
            for (row = 1; row <= NR; row++) {
                printf "| %s | %.0f | %d | %d | %d |\n", name[row], sum[row] / calls[row], most[row], stack[row], limit[row]
                if (limit[row] == 0 || stack[row] > limit[row] + bound["apart", ""]) {
                    print "firmware: " name[row] " writes to more stack than its bound" > "/dev/stderr"
                    failed = 1
                }
            }
            exit failed
        }' "$1" || wrong "the bound of the stack does not hold"
}

# flash_of FIRMWARE: bytes of code, constants and initial values.
flash_of() { size -A -d "$1" | awk '$1 ~ /^\.(text|rodata|data|vector_table)$/ { sum += $2 } END { print sum }'; }

# image PROCESSOR FEATURES CONTENT: the flash of a least program, whose symbols must be those of its content: nothing, accelerations, closed (collisions in
# closed form) or solver.
image() {
    local firmware symbols
    firmware=$(build "$1" least "$2" alone)
    symbols=$(nm -C "$firmware")
    if grep -qE 'panicking|__rust_alloc|__rdl_alloc' <<<"$symbols"; then wrong "a panic or an allocator is in the image ($1, $2)"; fi
    case $3 in
        nothing) if grep -qE 'hodograph' <<<"$symbols"; then wrong "something of Hodograph is in an image that does not call it ($1)"; fi ;;
        accelerations) if grep -qE 'hodograph.*(solve|structure|sliding|gauss)' <<<"$symbols"; then wrong "the solver is in an image that does not collide ($1, $2)"; fi ;;
        closed) if grep -qE 'hodograph.*(gauss16|sliding::arc|sliding_arc)' <<<"$symbols"; then wrong "the solver is in an image that collides in closed form ($1, $2)"; fi ;;
        solver) grep -qE 'hodograph.*gauss16' <<<"$symbols" || wrong "the solver's symbols have other names: the other checks see nothing ($1)" ;;
    esac
    if [ "$3" != nothing ] && grep -E 'hodograph_models::' <<<"$symbols" | grep -qvE "hodograph_models::($(tr ',' '|' <<<"$2"))"; then
        wrong "a model that is not named is in the image ($1, $2)"
    fi
    flash_of "$firmware"
}

# images PROCESSOR FEATURES [tables]: the flash of least programs; on the M4F all of them for the tables, else those only whose symbols tell something.
images() {
    local label features content
    printf '\n| program | flash (bytes) |\n| --- | ---: |\n'
    while IFS='|' read -r label features content; do
        [ "$1,${3:-}" = cortex-m4,tables ] || case $label in *'*') ;; *) continue ;; esac
        echo "| ${label%\*} | $(image "$1" "$2${2:+,}$features" "$content") |"
    done <<'ROWS'
start-up and vectors alone*||nothing
two sleds: accelerations*|two_sleds|accelerations
and collisions, Newton's law alone|two_sleds,newton|solver
and collisions, Poisson's law alone|two_sleds,poisson|solver
and collisions, Stronge's law alone|two_sleds,stronge|solver
and collisions, any law*|two_sleds,collide|solver
and collisions, any law, and modes of contact|two_sleds,collide,mode|solver
and collisions, any law, in singles and in doubles|two_sleds,both|solver
planar double pendulum: accelerations and collisions, in closed form*|planar_double_pendulum,collide|closed
rolling disc: accelerations|rolling_disc|accelerations
and collisions of one contact|rolling_disc,collide|solver
and collisions of a second contact|rolling_disc,second|solver
two sleds and rolling disc: accelerations and collisions|two_sleds,rolling_disc,collide|solver
arm of seven joints: accelerations|arm_7dof|accelerations
and collisions|arm_7dof,collide|solver
two sleds: accelerations, and collisions as one routine, Stronge's law|two_sleds,one_routine|solver
planar double pendulum: accelerations, and collisions as one routine|planar_double_pendulum,one_routine|closed
arm of seven joints: accelerations, and collisions as one routine|arm_7dof,one_routine|solver
ROWS
}
