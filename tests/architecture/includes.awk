# Holds every #include "..." against the rooms that rooms.txt allows: awk -v rooms=FILE.
function room_of(path) {
    sub(/\/[^\/]*$/, "", path)
    return path
}
function rule_of(room,    top) {
    if (room in allowed)
        return allowed[room]
    top = room
    sub(/\/.*/, "", top)
    return top "/*" in allowed && room != top ? allowed[top "/*"] : ""
}
function is_allowed(from, to,    n, count, names) {
    if (from == to)
        return 1
    count = split(rule_of(from), names, " ")
    for (n = 1; n <= count; n++) {
        if (names[n] == to || (names[n] == "core" && index(to, "core/") == 1))
            return 1
        if (names[n] ~ /\/\*$/ && index(to, substr(names[n], 1, length(names[n]) - 1)) == 1)
            return 1
    }
    return 0
}
BEGIN {
    while ((getline line < rooms) > 0) {
        sub(/#.*/, "", line)
        if (split(line, parts, ":") < 2)
            continue
        gsub(/^ +| +$/, "", parts[1])
        allowed[parts[1]] = parts[2]
        known = 1
    }
    if (!known) {
        print rooms ": no rooms"
        exit failed = 1
    }
}
FNR == 1 {
    room = room_of(FILENAME)
    top = room
    sub(/\/.*/, "", top)
    if (!(room in allowed) && !(room != top && top "/*" in allowed) && !(room in told)) {
        print FILENAME ": the folder " room " is no room of rooms.txt"
        told[room] = failed = 1
    }
}
/^[ \t]*#[ \t]*include "/ {
    split($0, quoted, "\"")
    if (!is_allowed(room, room_of(quoted[2]))) {
        print FILENAME ":" FNR ": the room " room " may not include " quoted[2]
        failed = 1
    }
}
END { exit failed }
