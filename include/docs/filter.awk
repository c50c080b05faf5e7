# Turns the plain comments of a public header into Doxygen's:
# awk -v usual=parameters.txt -f filter.awk HEADER, which Doxygen runs for each header.
#
# The headers are written for people. A comment at the margin belongs to the declarations below it,
# up to the next empty line. Its lists become commands:
#
#     mesh     in place                     @param mesh in place
#     Returns  CW_ERR_LIMIT  too large      @return CW_ERR_LIMIT: too large
#     Cost     one pass                     @par Cost
#
# Parameters that mean the same in every call have their text in parameters.txt.
#
# Every line stays on its line, so that Doxygen's warnings point into the header. A function that
# shares a comment with the one above it gets a copy of it, in front of it on its line.

BEGIN {
    while ((getline row < usual) > 0)
        if (row ~ /\|/ && row !~ /^#/) {
            key = row
            sub(/ *\|.*/, "", key)
            sub(/.*\| */, "", row)
            usual_text[key] = row
        }
}

{ line[NR] = $0 }

END {
    for (at = 1; at <= NR;)
        at = filter_item(at)
    for (at = 1; at <= NR; at++)
        print line[at]
}

# Filters the comment, type or line that begins at a line; returns the line after it.
function filter_item(at,   last)
{
    if (line[at] ~ /^\/\* /) {
        last = find_comment_end(at)
        if (at == 1)
            return mark_file(at, last)
        return line[last + 1] ~ /^$/ ? last + 1 : filter_group(at, last)
    }
    if (line[at] ~ /^#define CW_[A-Z_]*TABLE\(X\)/)
        return read_table(at)
    if (line[at] ~ /^(typedef )?(struct|enum).*\{/)
        return filter_type(at)
    if (line[at] ~ /^#define .*\/\* /)
        mark_after(at)
    return at + 1
}

function find_comment_end(at)
{
    while (at < NR && line[at] !~ /\*\//)
        at++
    return at
}

# The comment on line 1 is about the file.
function mark_file(first, last,   at, name)
{
    for (at = first; at <= last; at++)
        line[at] = escape_text(line[at])
    name = FILENAME
    sub(/.*\//, "", name)
    sub(/^\/\* /, "/** @file " name " @brief ", line[first])
    return last + 1
}

# Rows of a table X(NAME, ..., "text"): the strings describe the enumerator.
function read_table(at,   name, rest, text)
{
    rows = ""
    do {
        at++
        if (match(line[at], /X\(CW_[A-Z0-9_]+/)) {
            if (name != "")
                rows = rows name " /**< " text " */, "
            name = substr(line[at], RSTART + 2, RLENGTH - 2)
            text = ""
        }
        rest = line[at]
        while (match(rest, /"[^"]*"/)) {
            text = text (text == "" ? "" : ": ") escape_text(substr(rest, RSTART + 1, RLENGTH - 2))
            rest = substr(rest, RSTART + RLENGTH)
        }
    } while (line[at] ~ /\\$/)
    rows = rows name " /**< " text " */,"
    return at + 1
}

# The fields of a struct and the values of an enum have their comments behind them, or above.
function filter_type(at)
{
    if (line[at] ~ /\};/) {
        if (line[at] ~ /\/\*/)
            mark_after(at)
        return at + 1
    }
    for (at++; at < NR && line[at] !~ /^ *\} *[a-z_0-9]*;/; at++) {
        if (line[at] ~ /^#/)
            line[at] = ""
        else if (line[at] ~ /^ *CW_[A-Z_]*TABLE\(/)
            line[at] = rows
        else if (line[at] ~ /^ *\/\* /)
            at = mark_before(at)
        else if (line[at] ~ /[^ ] *\/\* /)
            at = mark_after(at)
    }
    return at + 1
}

function mark_before(at,   last)
{
    last = find_comment_end(at)
    escape_comment(at, last)
    sub(/\/\*/, "/**", line[at])
    return last
}

function mark_after(at,   last)
{
    last = find_comment_end(at)
    escape_comment(at, last)
    sub(/\/\*/, "/**<", line[at])
    if (line[at] ~ /^ *[a-z].*,.*; +\/\*/)
        split_fields(at, last)
    return last
}

# Doxygen gives a comment to the last of several fields: low, high; becomes two declarations.
function split_fields(first, last,   at, code, note, text, type, fields, count, k)
{
    at = index(line[first], ";")
    code = substr(line[first], 1, at - 1)
    note = substr(line[first], at + 1)
    if (code ~ /\(\*/ || !match(code, /^ *(const )?[a-z_0-9]+ /))
        return
    type = substr(code, 1, RLENGTH)
    count = split(substr(code, RLENGTH + 1), fields, ", *")
    text = note
    for (at = first + 1; at <= last; at++)
        text = text line[at]
    gsub(/  +/, " ", text)
    code = ""
    for (k = 1; k < count; k++)
        code = code type fields[k] ";" text
    line[first] = code type fields[count] ";" note
}

# Escapes comments in lines that may begin with code.
function escape_comment(first, last,   at, start)
{
    for (at = first; at <= last; at++) {
        start = at == first ? index(line[at], "/*") + 2 : 1
        line[at] = substr(line[at], 1, start - 1) escape_text(substr(line[at], start))
    }
}

# Hides from Doxygen's Markdown and commands what is plain text, except between backquotes.
function escape_text(text,   parts, count, k)
{
    count = split(text, parts, "`")
    text = ""
    for (k = 1; k <= count; k++) {
        if (k % 2 == 1 || count % 2 == 0) {
            gsub(/\\/, "\\\\", parts[k])
            gsub(/[@#<>&]/, "\\\\&", parts[k])
            gsub(/--/, "\\--", parts[k])
        }
        text = text (k == 1 ? "" : "`") parts[k]
    }
    return text
}

# A comment, and the declarations below it up to an empty line or another comment.
function filter_group(first, last,   at, end, count, k, names)
{
    count = 0
    for (at = last + 1; at <= NR && line[at] !~ /^$|^\/\*|^#(if|endif|ifdef|undef)|^}/; at = end + 1) {
        end = find_declaration_end(at)
        count++
        starts[count] = at
        declared[count] = read_declaration(at, end)
    }
    read_comment(first, last)
    for (k = 1; k <= count; k++)
        for_any[k] = list_parameters(declared[k])
    names = ""
    for (k = 1; k <= count; k++)
        names = names for_any[k]
    write_comment(first, last, declared[1], names)
    for (k = 1; k <= count; k++) {
        if (line[starts[k]] ~ /^#define CW_[A-Z_]*TABLE\(X\)/)
            read_table(starts[k])
        else if (line[starts[k]] ~ /^(typedef )?(struct|enum).*\{/)
            filter_type(starts[k])
        if (k > 1)
            line[starts[k]] = copy_comment(first, last, declared[k]) " " line[starts[k]]
    }
    return at
}

function find_declaration_end(at)
{
    if (line[at] ~ /^#define/) {
        while (line[at] ~ /\\$/)
            at++
        return at
    }
    if (line[at] ~ /\{/) {
        while (at < NR && line[at] !~ /^ *\} *[a-z_0-9]*;|\};/)
            at++
        return at
    }
    while (at < NR && line[at] !~ /;/)
        at++
    return at
}

# Reads a declaration as one line; replacement has what CW_DEPRECATED says about it.
function read_declaration(at, end,   text, advice)
{
    for (text = ""; at <= end; at++)
        text = text " " line[at]
    sub(/^ */, "", text)
    sub(/\/\*.*/, "", text)
    advice = ""
    if (match(text, /CW_DEPRECATED\("[^"]*"\) */)) {
        advice = substr(text, RSTART + 15, RLENGTH - 15)
        sub(/"\).*/, "", advice)
        sub(/CW_DEPRECATED\("[^"]*"\) */, "", text)
    }
    replacement[text] = advice
    return text
}

function is_function(text)
{
    return text ~ /^(CW_[A-Z]+ )+.*[ *]cw_[a-z0-9_]*\(/
}

# Lists the parameters of a function as " volume desc err ", and notes their types.
function list_parameters(text,   parts, count, k, names, name, is_free)
{
    if (!is_function(text))
        return " "
    is_free = text ~ /_free\(/
    sub(/^[^(]*\(/, "", text)
    sub(/\);.*/, "", text)
    gsub(/\[[^]]*\]|[()]/, "", text)
    count = split(text, parts, ", *")
    names = " "
    for (k = 1; k <= count; k++)
        if (parts[k] ~ /[ *]/ && match(parts[k], /[a-z_0-9]+ *$/)) {
            name = substr(parts[k], RSTART)
            names = names name " "
            gsub(/  +/, " ", parts[k])
            sub(/^ /, "", parts[k])
            types[name] = is_free && k == 1 ? "_free" : parts[k]
        }
    return names
}

# Reads a comment into texts, what each line is (kinds) and which parameters it names (subjects).
function read_comment(first, last,   at, text, kind, subject)
{
    kind = "prose"
    subject = ""
    for (at = first; at <= last; at++) {
        text = line[at]
        sub(/^(\/| )\*( |$)/, "", text)
        sub(/ *\*\/.*/, "", text)
        if (text ~ /^ *$/)
            kind = "blank"
        else if (match(text, /^(Returns|Cost|Threads|Source) +/) && (text ~ /^Returns/ || RLENGTH > 7 || text ~ /^[A-Z][a-z]+  /)) {
            kind = text
            sub(/ .*/, "", kind)
            if (at == first)
                kind = "prose"
            else
                text = substr(text, RLENGTH + 1)
            starts_entry[at] = at != first
        } else if (match(text, /^[a-z][a-z0-9_]*(, [a-z][a-z0-9_]*)*   *[^ ]/) && text ~ /^[a-z0-9_, ]*[a-z0-9_]  /) {
            kind = "parameter"
            subject = text
            sub(/  .*/, "", subject)
            text = substr(text, RLENGTH)
            starts_entry[at] = 1
        } else if (kind == "blank" || kind == "verbatim" || kind == "prose")
            kind = text ~ /^    / ? "verbatim" : "prose"
        else if (text !~ /^ /)
            kind = "prose"
        kinds[at] = kind
        subjects[at] = kind == "parameter" ? subject : ""
        texts[at] = kind == "verbatim" ? text : escape_text(text)
        if (kind == "Returns")
            sub(/^ *CW_ERR_[A-Z_]+  +/, "&: ", texts[at])
        sub(/  +: /, ": ", texts[at])
        if (kind != "verbatim")
            sub(/^ +/, "", texts[at])
    }
}

# True if one of several names, as "dropped, kept", is in a list of parameters.
function names_one_of(subject, names,   parts, count, k)
{
    count = split(subject, parts, ", ")
    for (k = 1; k <= count; k++)
        if (index(names, " " parts[k] " "))
            return 1
    return 0
}

# Tells a line of a comment in Doxygen's words, for a declaration.
function tell_line(at, declaration, names,   text)
{
    text = texts[at]
    if (kinds[at] == "verbatim")
        return text
    if (starts_entry[at]) {
        if (kinds[at] == "parameter") {
            subject = subjects[at]
            gsub(/, /, ",", subject)
            return "@param " subject " " text
        }
        if (kinds[at] == "Returns")
            return returns_value(declaration) ? "@return " tell_success(declaration) text : text
        return "@" tolower(kinds[at]) " " text
    }
    if (kinds[at] == "Returns" && text ~ /^CW_ERR_/)
        return "<br>" text
    if (kinds[at] == "prose" && returns_value(declaration))
        sub(/\. Returns /, ". @return " tell_success(declaration), text)
    return text
}

# Results that are a status are named after success.
function tell_success(declaration)
{
    return declaration ~ /^(CW_[A-Z]+ )+cw_status / ? "CW_OK, or " : ""
}

function returns_value(declaration)
{
    return is_function(declaration) && declaration !~ /^CW_API void [^*]/
}

# Tells a comment for a declaration, line by line (told) and what ends it (ending). Usual parameters
# stand where the declaration has them, before the result.
function tell_comment(first, last, declaration,   at, own, text, usual, names, documented)
{
    own = list_parameters(declaration)
    waiting = own
    documented = 0
    for (at = first; at <= last; at++) {
        text = tell_line(at, declaration)
        if (starts_entry[at] && kinds[at] == "parameter") {
            if (names_one_of(subjects[at], own))
                text = tell_usual(first, last, subjects[at]) text
        } else if (text ~ /@return/) {
            documented = 1
            usual = tell_usual(first, last, "")
            sub(/@return/, usual "@return", text)
        } else if (starts_entry[at])
            text = tell_usual(first, last, "") text
        told[at] = text
    }
    ending = " " tell_usual(first, last, "")
    if (returns_value(declaration) && !documented && texts[first] ~ /^Returns /)
        ending = ending "@return " tell_first_sentence(first, last) " "
    if (replacement[declaration] != "")
        ending = ending "@deprecated " escape_text(replacement[declaration]) " "
}

# Tells the usual parameters that wait, up to one of a subject.
function tell_usual(first, last, subject,   text, name)
{
    text = ""
    while (match(waiting, /[a-z_0-9]+/)) {
        name = substr(waiting, RSTART, RLENGTH)
        if (subject != "" && names_one_of(subject, " " name " "))
            return text
        waiting = substr(waiting, RSTART + RLENGTH)
        if (!is_told(name, first, last) && types[name] in usual_text)
            text = text "@param " name " " usual_text[types[name]] " "
    }
    return text
}

function is_told(name, first, last,   at)
{
    for (at = first; at <= last; at++)
        if (starts_entry[at] && kinds[at] == "parameter" && names_one_of(subjects[at], " " name " "))
            return 1
    return 0
}

function tell_first_sentence(first, last,   at, text)
{
    for (at = first; at <= last && kinds[at] == "prose"; at++)
        text = text " " texts[at]
    sub(/^ *Returns /, "", text)
    sub(/\. .*/, ".", text)
    return text
}

# Writes the comment for the first declaration in its place. Parameters that only the others of
# the group have are left out; those that none has stay, so that Doxygen reports them.
function write_comment(first, last, declaration, all_names,   at, own, text, head)
{
    own = list_parameters(declaration)
    tell_comment(first, last, declaration)
    for (at = first; at <= last; at++) {
        text = told[at]
        if (kinds[at] == "parameter" && !names_one_of(subjects[at], own) && names_one_of(subjects[at], all_names))
            text = ""
        if (kinds[at] == "verbatim" && (at == first || kinds[at - 1] != "verbatim"))
            text = "@verbatim " text
        if (kinds[at] == "verbatim" && (at == last || kinds[at + 1] != "verbatim"))
            text = text " @endverbatim"
        head = at == first ? "/** " : " * "
        line[at] = head text
    }
    line[last] = line[last] ending "*/"
}

# The same comment in one line, for another declaration of the group.
function copy_comment(first, last, declaration,   at, own, text, piece)
{
    own = list_parameters(declaration)
    tell_comment(first, last, declaration)
    text = "/**"
    for (at = first; at <= last; at++) {
        if (kinds[at] == "parameter" && !names_one_of(subjects[at], own))
            continue
        piece = told[at]
        if (kinds[at] == "blank")
            piece = "<p>"
        if (kinds[at] == "verbatim")
            piece = "`" piece "`"
        text = text " " piece
    }
    return text ending "*/"
}
