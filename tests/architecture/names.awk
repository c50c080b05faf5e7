# Prints "NAME FILE:LINE" for each internal name that a source defines: types, functions, macros,
# enumerators. A type and its tag of one name are one definition.
FNR == 1 { last = "" }
function define(name) {
    if (!((name, FILENAME) in seen))
        print name, FILENAME ":" FNR
    seen[name, FILENAME] = 1
}
function name_in(text) {
    match(text, /[cC][wW][iI]_[A-Za-z0-9_]+/)
    return substr(text, RSTART, RLENGTH)
}
/^#define CWI_[A-Z0-9_]+/ { define(name_in($0)) }
/^(typedef )?(struct|enum|union) cwi_[a-z0-9_]+ \{/ { define(name_in($0)) }
/^} cwi_[a-z0-9_]+;/ { define(name_in($0)) }
/^typedef [^({]*cwi_[a-z0-9_]+;/ && !/^typedef (struct|enum|union) (cwi_[a-z0-9_]+) cwi_/ { define(name_in($NF)) }
/^ +CWI_[A-Z0-9_]+( = [^,;]*)?,?( \/\*.*)?$/ { define(name_in($0)) }
/^enum \{ *CWI_/ { text = $0; while (match(text, /CWI_[A-Z0-9_]+ *[=,}]/)) { define(name_in(substr(text, RSTART))); text = substr(text, RSTART + RLENGTH); sub(/^[^,}]*/, "", text) } }
# A function: its name stands at the start of a line that ends without a semicolon; of one that
# goes on, the last line of the list of parameters decides.
/^[a-z][A-Za-z0-9_ *]*[ *]cwi_[a-z0-9_]+\(/ && !/^typedef|^extern|^return/ {
    match($0, /cwi_[a-z0-9_]+\(/)
    last = substr($0, RSTART, RLENGTH - 1)
    at = FNR
}
last != "" && /;$/ { last = "" }
last != "" && /^\{/ { print last, FILENAME ":" at; last = "" }
