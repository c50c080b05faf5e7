/* Prints text as roff: escaped words, and the paragraphs, headings, lists and literal blocks of
 * a page of the help. */
#include "cli/help/roff_text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum {
    FILLED = 76,      /* columns that a line of a paragraph has at least, with the next word */
    MAX_HEADING = 60, /* columns */
    INDENT = 2        /* columns of a list or a literal block */
};

/* Characters that roff would read, or show as others. */
static const struct {
    char letter;
    const char *escape;
} escapes[] = {
    {'\\', "\\e"},  {'-', "\\-"},   {'\'', "\\(aq"}, {'`', "\\(ga"},
    {'^', "\\(ha"}, {'~', "\\(ti"}, {'"', "\\(dq"},
};

static const char *find_escape(char letter)
{
    for (size_t n = 0; n < sizeof escapes / sizeof *escapes; n++)
        if (escapes[n].letter == letter)
            return escapes[n].escape;
    return NULL;
}

void cli_roff_text(const char *text, size_t length, bool begins_line)
{
    if (begins_line && length && *text == '.')
        fputs("\\&", stdout);
    for (size_t n = 0; n < length; n++) {
        const char *escape = find_escape(text[n]);
        if (escape)
            fputs(escape, stdout);
        else
            putchar(text[n]);
    }
}

void cli_roff_heading(const char *text, size_t length, bool is_part)
{
    printf(is_part ? ".SS " : ".SH ");
    putchar('"');
    for (size_t n = 0; n < length; n++) {
        const char c = is_part ? text[n] : (char)toupper((unsigned char)text[n]);
        cli_roff_text(&c, 1, false);
    }
    puts("\"");
}

/* --- lines of a page ---------------------------------------------------------------------- */

static size_t line_length(const char *line)
{
    return strcspn(line, "\n");
}

/* The line behind this one; the end of the text after the last. */
static const char *next_line(const char *line)
{
    line += line_length(line);
    return line + (*line == '\n');
}

static bool is_blank(const char *line)
{
    return *line == '\n' || *line == '\0';
}

static size_t count_indent(const char *line)
{
    return strspn(line, " ");
}

/* A short first line of a block is its heading: the next word would have fitted in it. */
static bool is_heading(const char *line)
{
    const size_t length = line_length(line);
    const char *next = next_line(line);
    if (is_blank(line) || *line == ' ' || length > MAX_HEADING || is_blank(next) ||
        strchr(".:,;", line[length - 1]))
        return false;
    return *next == ' ' || length + 1 + strcspn(next, " \n") < FILLED;
}

/* Where the text of a list's line begins, behind two blanks or more; 0: it is no such line. */
static size_t find_gap(const char *line)
{
    const size_t indent = count_indent(line), length = line_length(line);
    for (size_t n = indent; n + 2 < length; n++)
        if (line[n] == ' ' && line[n + 1] == ' ') {
            n += count_indent(line + n);
            return n < length ? n : 0;
        }
    return 0;
}

/* --- blocks ------------------------------------------------------------------------------- */

static const char *print_literal(const char *line, bool follows)
{
    puts(follows ? ".PP\n.RS 4\n.nf" : ".RS 4\n.nf");
    while (!is_blank(line) && *line == ' ') {
        const size_t off = count_indent(line) < INDENT ? count_indent(line) : INDENT;
        cli_roff_text(line + off, line_length(line) - off, true);
        putchar('\n');
        line = next_line(line);
    }
    puts(".fi\n.RE");
    return line;
}

/* Prints the text of a list's line; a third column stands in parentheses. */
static void print_item(const char *text, size_t length)
{
    size_t end = 0, begin;
    while (end + 2 < length && (text[end] != ' ' || text[end + 1] != ' '))
        end++;
    begin = end + count_indent(text + end);
    if (end + 2 >= length)
        begin = end = length;
    cli_roff_text(text, end, true);
    if (begin < length) {
        fputs(" (", stdout);
        cli_roff_text(text + begin, length - begin, false);
        putchar(')');
    }
    putchar('\n');
}

/* Prints lines "  name  text"; what is indented as the text goes on with it. */
static const char *print_list(const char *line)
{
    const size_t column = find_gap(line);
    while (!is_blank(line) && *line == ' ') {
        const size_t indent = count_indent(line), length = line_length(line);
        const size_t gap = indent < column ? find_gap(line) : 0;
        size_t end = gap ? gap : length;
        if (indent < column) {
            while (end > indent && line[end - 1] == ' ')
                end--;
            fputs(".TP\n\\fB", stdout);
            cli_roff_text(line + indent, end - indent, false);
            puts("\\fP");
            if (gap)
                print_item(line + gap, length - gap);
        } else {
            print_item(line + indent, length - indent);
        }
        line = next_line(line);
    }
    return line;
}

static const char *print_paragraph(const char *line, bool follows)
{
    if (follows)
        puts(".PP");
    while (!is_blank(line) && *line != ' ') {
        cli_roff_text(line, line_length(line), true);
        putchar('\n');
        line = next_line(line);
    }
    return line;
}

static bool begins_examples(const char *line)
{
    return strncmp(line, "Examples\n", 9) == 0;
}

/* Prints a block up to the empty line behind it. follows: it does not stand under a heading. */
static const char *print_block(const char *line, bool is_literal, bool follows)
{
    for (; !is_blank(line); follows = true)
        line = *line != ' '                    ? print_paragraph(line, follows)
               : is_literal || !find_gap(line) ? print_literal(line, follows)
                                               : print_list(line);
    return line;
}

void cli_roff_page(const char *page, cli_roff_part part, bool has_parts)
{
    bool in_examples = false, follows = false;
    for (const char *line = page; *line;) {
        if (is_blank(line)) {
            line = next_line(line);
            continue;
        }
        const bool has_heading = is_heading(line);
        in_examples = has_heading ? begins_examples(line) : in_examples;
        if (in_examples != (part == CLI_ROFF_EXAMPLES)) {
            while (!is_blank(line))
                line = next_line(line);
            continue;
        }
        if (has_heading) {
            cli_roff_heading(line, line_length(line), has_parts && !in_examples);
            line = next_line(line);
        }
        line = print_block(line, in_examples, follows && !has_heading);
        follows = true;
    }
}
