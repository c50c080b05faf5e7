/* Prints the help of a command from its table of options and their rules. */
#include "cli/framework/option_rules.h"

#include <stdio.h>
#include <string.h>

/* Width of the help, and the column where the texts of options begin. */
enum { HELP_WIDTH = 96, TEXT_COLUMN = 32 };

void cli_print_wrapped(FILE *out, const char *text, size_t from)
{
    size_t column = from;
    for (bool first = true; *text; first = false) {
        const size_t length = strcspn(text, " ");
        if (!first && column + 1 + length > HELP_WIDTH) {
            fprintf(out, "\n%*s", (int)from, "");
            column = from;
        } else if (!first) {
            fputc(' ', out);
            column++;
        }
        fprintf(out, "%.*s", (int)length, text);
        column += length;
        text += length + (text[length] == ' ');
    }
    fputc('\n', out);
}

/* Prints "--mode a/b/c", after a '/' in a new line where it would be too long; returns its
 * length, or HELP_WIDTH where it took several lines. */
static size_t print_head(const cli_option *o)
{
    const int start =
        printf("  %c%c%s--%s%s", o->letter ? '-' : ' ', o->letter ? o->letter : ' ',
               o->letter ? ", " : "  ", o->name, o->value ? " " : "");
    size_t column = (size_t)start;
    bool broken = false;
    for (const char *v = o->value ? o->value : ""; *v;) {
        const size_t length = strcspn(v, "/") + (strchr(v, '/') != NULL);
        if (column + length > HELP_WIDTH) {
            printf("\n%*s", start, "");
            column = (size_t)start;
            broken = true;
        }
        printf("%.*s", (int)length, v);
        column += length;
        v += length;
    }
    return broken ? HELP_WIDTH : column;
}

static void print_option(const cli_command *command, const cli_option *o)
{
    if (o->kind == CLI_HEADING) {
        printf("\n%s\n", o->name);
        return;
    }
    const size_t length = print_head(o);
    if (length > TEXT_COLUMN - 2)
        printf("\n%*s", TEXT_COLUMN, "");
    else
        printf("%*s", (int)(TEXT_COLUMN - length), "");
    cli_print_wrapped(stdout, cli_option_about(command, o), TEXT_COLUMN);
}

void cli_print_help(const cli_command *command, bool long_form)
{
    const cli_option *o;
    printf("cubewright %s%s%s\n", command->name, *command->usage ? " " : "", command->usage);
    if (long_form)
        printf("\n%s", command->page);
    else
        printf("%s\n", command->about);
    puts("\nOptions (the default in brackets)");
    for (size_t n = 0; (o = cli_option_at(command, n)); n++)
        print_option(command, o);
    if (long_form && command->print_more)
        command->print_more(stdout);
    if (!long_form)
        printf("\n'cubewright help %s' explains more, with examples.\n", command->name);
}
