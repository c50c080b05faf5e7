# Prints the sentences of Markdown and help texts, one a line, without code, tables and headings.
function finish_paragraph(    count, n, parts) {
    gsub(/\]\([^)]*\)/, "]", text)
    gsub(/[.!?]["')\]]* +/, "&\n", text)
    count = split(text, parts, "\n")
    for (n = 1; n <= count; n++)
        if (parts[n] ~ /[[:alpha:]]/)
            print parts[n]
    text = ""
}
/^ *```/ { finish_paragraph(); code = !code; next }
code { next }
/^ *$/ || /^#/ || /^\|/ || /^</ || /^!\[/ { finish_paragraph(); next }
/^ *cubewright / { finish_paragraph(); next } # an example, or how a command is called
/^ +(-[[:alnum:]], )?--[[:alnum:]]/ { # an option of help: its text stands in column 33
    finish_paragraph()
    text = substr($0, 33)
    next
}
/^ *([-*]|[0-9]+\.) / { finish_paragraph(); sub(/^ *([-*]|[0-9]+\.) +/, "") } # an item of a list
/^  [^ ]/ { finish_paragraph() } # a term and what it means
{ sub(/^ +/, ""); text = text " " $0 }
END { finish_paragraph() }
