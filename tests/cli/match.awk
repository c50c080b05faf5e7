# Compares two texts line by line; a '*' in the first stands for any run of characters.
# awk -f match.awk EXPECTED ACTUAL
function matches(pattern, text,    pieces, n, i, at) {
    n = split(pattern, pieces, "*")
    if (pattern == "")
        return text == ""
    if (index(text, pieces[1]) != 1)
        return 0
    text = substr(text, length(pieces[1]) + 1)
    if (n == 1)
        return text == ""
    for (i = 2; i < n; i++) {
        if (pieces[i] == "")
            continue
        at = index(text, pieces[i])
        if (at == 0)
            return 0
        text = substr(text, at + length(pieces[i]))
    }
    return length(text) >= length(pieces[n]) && \
        substr(text, length(text) - length(pieces[n]) + 1) == pieces[n]
}
BEGIN {
    for (line = 1;; line++) {
        more = (getline wanted < ARGV[1]) > 0
        has = (getline got < ARGV[2]) > 0
        if (!more && !has)
            exit bad
        if (more != has || !matches(wanted, got)) {
            printf "line %d\n  expected: %s\n  got:      %s\n", line, \
                more ? wanted : "(nothing)", has ? got : "(nothing)"
            bad = 1
        }
        if (more != has)
            exit 1
    }
}
