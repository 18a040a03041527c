# What a collision takes at most, from machine code and the limits of the solver's loops: reads `objdump -d -C --no-show-raw-insn` of a program for Cortex-M that
# calls `hodograph::solve`, and prints for each of `budgets` the instructions that no collision exceeds.
#
# An instruction outside of loops is executed at most once per call of its function. Jumps back over at most `small` instructions are taken for loops, with as many
# passes as the loops of the source that their function may contain have at most (`limits`, else 4); jumps of the compiler's layout are among them, which only makes the
# bound larger. From loops only square roots and the blocks of the series are called. Longer ones are the loop over stretches and the one over trials, which the budget bounds:
#
#   stretches <= quadratures + 4      a stretch makes a quadrature, or compression ends at its beginning (two compressions), or it is the last
#   trials    <= quadratures
#   short steps <= 6 per trial that finds an event

BEGIN {
    FS = "\t"
    small = 300
    # sliding arc: STEPS of solve/invariant_directions.rs, before the loop over stretches; afterwards 4
    limits["sliding::arc$"] = 32
    # solve/terminal.rs
    limits["after_slip$"] = 48
    limits["input::checked$"] = 11
    # none in the source, but for those that the budget bounds
    limits["solve_real$"] = 1
    limits["EventLocation<T>>?::find$"] = 1
    # BLOCKS of solve/stop_series.rs, terms of a block, nodes of half a quadrature
    limits["::stop$"] = 12
    limits["stop_series::block$"] = 8
    limits["SlidingArc<T>>?::integrate$"] = 8
    limits["SlidingArc<T>>?::direct$"] = 8
    # the last steps of an event's size
    limits["Correction<T>>?::new$"] = 2
}
/^[0-9a-f]+ <.*>:$/ {
    at = $0
    sub(/ .*/, "", at)
    sub(/^0+/, "", at)
    title = $0
    sub(/^[0-9a-f]+ </, "", title)
    sub(/>:$/, "", title)
    name[at] = title
    next
}
at == "" || NF < 2 { next }
{
    here = $1
    gsub(/[ :]/, "", here)
    place[here] = ++size[at]
    owner[here] = at
}
$2 ~ /^(b|cbz|cbnz)/ && $2 !~ /^(bic|bfi|bfc|bkpt|bx|blx)/ {
    target = $3
    sub(/ <.*/, "", target)
    sub(/.*, /, "", target)
    if (target in owner && owner[target] == at && target != at) {
        span = size[at] - place[target] + 1
        if (span <= small) {
            back[at] = back[at] " " place[target] ":" size[at]
            in_loops[at] += span
        }
    } else if (target != at) {
        calls[at] = calls[at] " " target ":" size[at]
    }
}

# Passes of the small loops of a function.
function passes(f, pattern, most) {
    if (f == arc && in_stretch) return 4
    most = 4
    for (pattern in limits) if (name[f] ~ pattern) most = limits[pattern]
    return most
}

# The instructions of a call; nothing for what `apart` matches.
function work(f, apart, parts, part, count, k, sum, loop, loop_count, j, ends, times) {
    if (!(f in name) || (apart != "" && name[f] ~ apart)) return 0
    if ((f, in_stretch, apart) in known) return known[f, in_stretch, apart]
    sum = size[f] + (passes(f) - 1) * in_loops[f]
    count = split(calls[f], parts, " ")
    loop_count = split(back[f], loop, " ")
    for (k = 1; k <= count; k++) {
        split(parts[k], part, ":")
        times = 1
        for (j = 1; j <= loop_count; j++) {
            split(loop[j], ends, ":")
            if (part[2] + 0 >= ends[1] + 0 && part[2] + 0 <= ends[2] + 0 && name[part[1]] ~ /sqrt|stop_series::block$/) times = passes(f)
        }
        sum += times * work(part[1], apart)
    }
    known[f, in_stretch, apart] = sum
    return sum
}

# The instructions of one pass of the least loop of a function that calls another, with what it calls.
function pass(f, callee, apart, parts, part, count, k, loop, loop_count, j, ends, first, last, sum) {
    count = split(calls[f], parts, " ")
    loop_count = split(back[f], loop, " ")
    first = 1
    last = size[f]
    for (k = 1; k <= count; k++) {
        split(parts[k], part, ":")
        if (part[1] != callee) continue
        for (j = 1; j <= loop_count; j++) {
            split(loop[j], ends, ":")
            if (part[2] + 0 >= ends[1] + 0 && part[2] + 0 <= ends[2] + 0 && ends[2] - ends[1] < last - first) {
                first = ends[1] + 0
                last = ends[2] + 0
            }
        }
    }
    sum = last - first + 1
    for (k = 1; k <= count; k++) {
        split(parts[k], part, ":")
        if (part[2] + 0 >= first && part[2] + 0 <= last) sum += work(part[1], apart)
    }
    return sum
}

# The function with a name; it must be there.
function called(pattern, needed, f) {
    for (f in name) if (name[f] ~ pattern) return f
    if (needed) {
        print "no function " pattern " in the program" > "/dev/stderr"
        exit 1
    }
    return ""
}

END {
    solver = called("^hodograph::solve::collision::solve_real$", 1)
    arc = called("^hodograph::solve::sliding::arc$", 1)
    called("after_slip$", 1)
    find = called("EventLocation<T>>?::find$", 1)
    step = called("SlidingArc<T>>?::integrate$", 1)
    searches = "::(find|falling|whole)$"
    fixed = work(solver, searches "|range::rescaled$") + size[called("range::rescaled$", 1)]
    in_stretch = 1
    stretch = work(arc, searches "|perturbed|straight|deviation") + work(called("::falling$", 0), searches)
    # A trial with its quadrature; what a search does once; one of its short steps.
    trial = pass(find, step, "")
    once = work(find, "SlidingArc<T>>?::(integrate|short_step)$")
    short = pass(find, called("SlidingArc<T>>?::short_step$", 1), "")
    count = split(budgets, budget, " ")
    for (k = 1; k <= count; k++) {
        quadratures = budget[k] == "none" ? 512 * (2 * 97 + 1) : budget[k]
        printf "%s\t%.0f\n", budget[k], fixed + (quadratures + 4) * stretch + quadratures * (trial + once + 6 * short)
    }
    printf "instructions at most: %d once per collision, %d per stretch, %d per trial, %d per search, %d per short step\n", fixed, stretch, trial, once, short > "/dev/stderr"
}
