# The costliest calls: all states are counted on this machine, in singles and in doubles; the costliest of each routine are counted on the boards, where the same bits
# take the same ways.

# So many of the costliest states of each routine are called on a board.
readonly costliest=300

# Reads the rows of `worst` and the file counts: routine by routine, in the order of the calls.
readonly by_rows='
    { for (k = 0; k < $3; k++) { if ((getline count < counts) <= 0) { print "firmware: counts are missing" > "/dev/stderr"; exit 1 } call($1, $2, k, count + 0) } }'

# summary OUTPUT: of every routine its mean and its most.
summary() {
    awk -F'\t' -v OFS='\t' -v counts="$work/counts" "$by_rows"'
        function call(a, b, k, count) { if (!((a, b) in sum)) row[++rows] = a OFS b; sum[a, b] += count; calls[a, b]++; if (count > most[a, b]) most[a, b] = count }
        END { for (r = 1; r <= rows; r++) { split(row[r], part, OFS); print row[r], int(sum[part[1], part[2]] / calls[part[1], part[2]] + 0.5), most[part[1], part[2]] } }' "$1"
}

# choose OUTPUT: the numbers of the costliest states of every routine, as Rust.
choose() {
    awk -F'\t' -v OFS='\t' -v counts="$work/counts" "$by_rows"'
        function call(a, b, k, count) { print a, b, k, count }' "$1" |
        sort -t"$(printf '\t')" -k1,2 -k4,4nr -k3,3n |
        awk -F'\t' -v costliest=$costliest '
            BEGIN { print "&[" }
            $1 FS $2 != last { if (last != "") print "])," ; last = $1 FS $2; printf "(\"%s\", \"%s\", &[", $1, $2; many = 0 }
            ++many <= costliest { printf "%d,", $3 }
            END { if (last != "") print "]),"; print "]" }'
}

# here_counted FEATURES: the output of all states on this machine, with counts.
here_counted() {
    local program begin end
    # Where it stands is where it runs; procedural macros may not be built so, hence the target.
    (cd "$here" && RUSTFLAGS="-Crelocation-model=static" cargo build --quiet --locked --release --target x86_64-unknown-linux-gnu \
        --target-dir target/counted --bin worst --features "std,$1") >&2 || wrong "worst does not build for this machine"
    program=$here/target/counted/x86_64-unknown-linux-gnu/release/worst
    begin=$(nm "$program" | awk '$3 == "mark_begin" { print $1 }') end=$(nm "$program" | awk '$3 == "mark_end" { print $1 }')
    own_qemu -plugin "$tools/count.so,begin=$begin,end=$end,counts=$work/counts" "$program" || wrong "worst stopped with an error here"
}

worst() {
    local row processor features title
    [ "$(uname -m)" = x86_64 ] || cannot "all states are counted on x86-64"
    export HODOGRAPH_STATES=$1
    own_emulator
    patience=86400
    for row in "cortex-m4||singles" "cortex-m7|double|doubles"; do
        IFS='|' read -r processor features title <<<"$row"
        here_counted "$features" >"$work/all"
        summary "$work/all" >"$work/$title.here"
        choose "$work/all" >"$work/chosen.rs"
        HODOGRAPH_CHOSEN=$work/chosen.rs build "$processor" worst "$features" >"$work/program"
        emulate "$(board "$processor")" "$(cat "$work/program")" >"$work/some" || wrong "worst stopped with an error on $processor"
        summary "$work/some" >"$work/$title.board"
        objdump -d -C --no-show-raw-insn "$(cat "$work/program")" >"$work/code" || wrong "the machine code of worst cannot be read"
        awk -v budgets="$(awk -F'\t' '$1 == "solve" { print $2 }' "$work/all" | paste -sd' ')" -f "$here/work.awk" "$work/code" >"$work/$title.bound" ||
            wrong "the instructions of a collision have no bound"
    done
    sed "s/STATES/$1/; s/DEAREST/$costliest/" "$here/worst.md"
    budgets
    models
}

# The solver within budgets: the most that was found beside the bound, which must hold.
budgets() {
    printf '\n| budget, quadratures | M4F, singles: most found | bound | M7, doubles: most found | bound | x86-64, doubles: mean | most found |\n'
    printf '| ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n'
    paste <(grep '^solve' "$work/singles.board") "$work/singles.bound" <(grep '^solve' "$work/doubles.board") "$work/doubles.bound" \
        <(grep '^solve' "$work/doubles.here") | awk -F'\t' '
        $2 != $5 || $2 != $8 || $2 != $11 || $2 != $14 || $4 > $6 || $10 > $12 { print "firmware: rows differ, or a bound does not hold: " $0 > "/dev/stderr"; exit 1 }
        { printf "| %s | %d | %.0f | %d | %.0f | %d | %d |\n", $2, $4, $6, $10, $12, $15, $16 }' || wrong "the bound of collisions does not hold"
}

# Every routine of every model.
models() {
    printf '\n| routine | M4F, singles: most | M7, doubles: most | x86-64, doubles: mean | most |\n| --- | ---: | ---: | ---: | ---: |\n'
    paste "$work/singles.board" "$work/doubles.board" "$work/doubles.here" | awk -F'\t' '
        $1 != $5 || $2 != $6 || $1 != $9 || $2 != $10 { print "firmware: rows differ" > "/dev/stderr"; exit 1 }
        $1 != "solve" { printf "| %s: %s | %d | %d | %d | %d |\n", $1, $2, $4, $8, $11, $12 }' || wrong "counts are missing"
}
