# Prints the comments of C and C++ sources, each line as FILE:LINE: TEXT.
FNR == 1 { inside = 0 }
{
    rest = $0
    text = ""
    while (rest != "") {
        if (inside) {
            end = index(rest, "*/")
            text = text " " (end ? substr(rest, 1, end - 1) : rest)
            rest = end ? substr(rest, end + 2) : ""
            inside = !end
        } else if (match(rest, /^"([^"\\]|\\.)*"|^'([^'\\]|\\.)*'/)) {
            rest = substr(rest, RLENGTH + 1)
        } else if (substr(rest, 1, 2) == "/*") {
            inside = 1
            rest = substr(rest, 3)
        } else if (substr(rest, 1, 2) == "//") {
            text = text " " substr(rest, 3)
            rest = ""
        } else {
            rest = substr(rest, 2)
        }
    }
    if (text != "") print FILENAME ":" FNR ":" text
}
