# Stack from machine code: reads `objdump -d -C --no-show-raw-insn` of a program for Cortex-M and prints, for each function whose name matches
# `roots`, the bytes of the deepest way of calls from it, the function's name, and the frames on that way.
#
# A frame is all that the function pushes or takes off the stack pointer anywhere in it. What cannot be bounded so - a call or jump through a
# register, recursion, any other way to move the stack pointer down - is named, and the exit status is 1.

BEGIN { FS = "\t" }

# "00000400 <name>:"
/^[0-9a-f]+ <.*>:$/ {
    at = $0
    sub(/ .*/, "", at)
    sub(/^0+/, "", at)
    title = $0
    sub(/^[0-9a-f]+ </, "", title)
    sub(/>:$/, "", title)
    name[at] = title
    order[++functions] = at
    next
}
at == "" || NF < 2 { next }
{
    operation = $2
    sub(/ +$/, "", operation)
    operands = $3
    size[at]++
}
operation ~ /^(push|stmdb)/ && (operation ~ /^push/ || operands ~ /^sp!/) { frame[at] += 4 * registers(operands); next }
operation ~ /^vpush/ || (operation ~ /^vstmdb/ && operands ~ /^sp!/) { frame[at] += (operands ~ /d[0-9]/ ? 8 : 4) * registers(operands); next }
operands ~ /\[sp, #-[0-9]+\]!/ { frame[at] += number(operands, /\[sp, #-/); next }
operation ~ /^subw?(\.w)?$/ && operands ~ /^sp, (sp, )?#/ { frame[at] += number(operands, /#/); next }
# Back up from a frame pointer, and the end of a function, need no room.
(operation ~ /^sub/ || operation ~ /^(mov|bic|bfc|and)/) && operands ~ /^sp/ { trouble[at] = operation " " operands; next }
operation ~ /^blx/ && operands ~ /^(r[0-9]+|ip|sl|fp|lr)/ { trouble[at] = operation " " operands; next }
operation ~ /^bx/ && operands !~ /^lr/ { trouble[at] = operation " " operands; next }
operation ~ /^ldr/ && operands ~ /^pc/ { trouble[at] = operation " " operands; next }
operation ~ /^(b|cbz|cbnz)/ && operation !~ /^(bic|bfi|bfc|bkpt)/ {
    target = operands
    sub(/ <.*/, "", target)
    sub(/.*, /, "", target)
    if (target != at) calls[at] = calls[at] " " target
    else if (operation ~ /^bl/) trouble[at] = "recursion"
}

# How many registers a list in braces has: {r4, r5-r8, lr}.
function registers(text, parts, ends, count, k, sum) {
    sub(/^[^{]*\{/, "", text)
    sub(/\}.*/, "", text)
    count = split(text, parts, /, */)
    for (k = 1; k <= count; k++) {
        if (split(parts[k], ends, "-") == 2) {
            gsub(/[a-z]/, "", ends[1])
            gsub(/[a-z]/, "", ends[2])
            sum += ends[2] - ends[1]
        }
        sum++
    }
    return sum
}

function number(text, after) {
    if (match(text, /#-?[0-9]+/)) return substr(text, RSTART + 1, RLENGTH - 1) * (text ~ /#-/ ? -1 : 1)
    return 0
}

# The most bytes below the beginning of a function; sets deepest_callee.
function depth(function_at, parts, count, k, below, most) {
    if (function_at in known) return known[function_at]
    if (function_at in on) {
        print "recursion through " name[function_at] > "/dev/stderr"
        failed = 1
        return 0
    }
    if (function_at in trouble) {
        print name[function_at] ": " trouble[function_at] > "/dev/stderr"
        failed = 1
    }
    on[function_at] = 1
    count = split(calls[function_at], parts, " ")
    most = 0
    for (k = 1; k <= count; k++) {
        if (!(parts[k] in name)) continue
        below = depth(parts[k])
        if (below > most) {
            most = below
            next_on_way[function_at] = parts[k]
        }
    }
    delete on[function_at]
    known[function_at] = most + frame[function_at]
    return known[function_at]
}

END {
    for (k = 1; k <= functions; k++) {
        root = order[k]
        if (name[root] !~ roots) continue
        bytes = depth(root)
        way = ""
        for (step = root; step != ""; step = next_on_way[step]) way = way (way == "" ? "" : ", ") name[step] " " frame[step] + 0
        print bytes "\t" name[root] "\t" way
    }
    exit failed
}
