/* Prints manual pages: of each command, of the program and of the library. */
#define _GNU_SOURCE /* open_memstream */
#include "cli/help/man_page.h"

#include "cli/framework/commands.h"
#include "cli/framework/option_rules.h"
#include "cli/help/help_search.h"
#include "cli/help/roff_text.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_text(const char *text)
{
    cli_roff_text(text, strlen(text), true);
}

/* Prints the title line, which has no date, so that the page is the same in every build.
 * Words are not divided: that would add hyphens to options. */
static void print_title(const char *command, int section)
{
    fputs(".\\\" Made by 'cubewright help --man'.\n.TH CUBEWRIGHT", stdout);
    if (command)
        fputs("\\-", stdout);
    for (const char *c = command ? command : ""; *c; c++)
        putchar(toupper((unsigned char)*c));
    printf(" %d \"\" \"cubewright %s\" \"%s\"\n.nh\n.ad l\n.SH NAME\ncubewright", section,
           cw_version(), section == 1 ? "User Commands" : "Library");
    if (command)
        printf("\\-%s", command);
    fputs(" \\- ", stdout);
}

/* Prints a line of help as the line of a name: it begins with a small letter. */
static void print_about(const char *about)
{
    const char first = (char)tolower((unsigned char)*about);
    cli_roff_text(&first, 1, false);
    cli_roff_text(about + 1, strlen(about + 1), false);
    putchar('\n');
}

static void print_option(const cli_command *c, const cli_option *o)
{
    if (o->kind == CLI_HEADING) {
        cli_roff_heading(o->name, strlen(o->name), true);
        return;
    }
    puts(".TP");
    if (o->letter)
        printf("\\fB\\-%c\\fP, ", o->letter);
    fputs("\\fB\\-\\-", stdout);
    cli_roff_text(o->name, strlen(o->name), false);
    fputs("\\fP", stdout);
    if (o->value)
        fputs(" \\fI", stdout);
    for (const char *v = o->value ? o->value : ""; *v;) { /* lines may end behind a '/' */
        const size_t length = strcspn(v, "/") + (strchr(v, '/') != NULL);
        cli_roff_text(v, length, false);
        v += length;
        fputs(*v ? "\\:" : "", stdout);
    }
    puts(o->value ? "\\fP" : "");
    print_text(cli_option_about(c, o));
    putchar('\n');
}

static void print_exit_status(void)
{
    static const struct {
        int code;
        const char *text;
    } rows[] = {
#define ROW(name, code, json, text) {code, text},
        CW_STATUS_TABLE(ROW)
#undef ROW
    };
    puts(".SH EXIT STATUS");
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        if (n > 0 && rows[n - 1].code == rows[n].code)
            puts(".br");
        else
            printf(".TP\n.B %d\n", rows[n].code);
        print_text(rows[n].text);
        putchar('\n');
    }
}

/* Returns true if a page names a command: 'NAME', 'NAME ... or 'cubewright NAME. */
static bool names_command(const char *page, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = strstr(page, name); at; at = strstr(at + 1, name)) {
        const char end = at[length];
        const bool begins = at > page && at[-1] == '\'';
        const bool follows = at - page > 12 && strncmp(at - 12, "'cubewright ", 12) == 0;
        if ((begins || follows) && (end == '\'' || end == ' '))
            return true;
    }
    return false;
}

/* --- the pages ---------------------------------------------------------------------------- */

/* Prints what the long help has behind the options. */
static cw_status print_more(const cli_command *c, cw_error *err)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = c->print_more ? open_memstream(&text, &size) : NULL;
    if (!c->print_more)
        return CW_OK;
    if (!out)
        return cwi_fail_memory(err);
    c->print_more(out);
    const bool is_whole = fclose(out) == 0;
    if (is_whole)
        cli_roff_page(text, CLI_ROFF_TEXT, false);
    free(text);
    return is_whole ? CW_OK : cwi_fail_memory(err);
}

static bool has_flags(const cli_command *c)
{
    for (size_t n = 0; n < c->option_count; n++)
        if (c->options[n].kind == CLI_FLAG)
            return true;
    return false;
}

/* Prints which units the quantities of a command may have. */
static void print_units(const cli_command *c)
{
    bool has_any = false;
    for (size_t n = 0; n < c->option_count; n++) {
        const cli_option *o = &c->options[n];
        if (!o->kind->unit_rule)
            continue;
        if (!has_any)
            puts(
                ".SH UNITS\nUnits of length are mm, um, nm, cm, m, in and ft; vox stands for the side, or the volume, of a "
                "voxel.\nA quantity without its unit is refused.");
        has_any = true;
        puts(".TP");
        fputs("\\fB\\-\\-", stdout);
        cli_roff_text(o->name, strlen(o->name), false);
        puts("\\fP");
        print_text(o->kind->unit_rule);
        putchar('\n');
    }
}

static cw_status print_command(const cli_command *c, cw_error *err)
{
    print_title(c->name, 1);
    print_about(c->about);
    printf(".SH SYNOPSIS\n\\fBcubewright %s\\fP%s", c->name, *c->usage ? " " : "");
    print_text(c->usage);
    puts("\n.SH DESCRIPTION");
    cli_roff_page(c->page, CLI_ROFF_TEXT, true);
    puts(".SH OPTIONS\nThe default of an option is in brackets.");
    if (has_flags(c))
        puts("A flag \\fB\\-\\-\\fP\\fINAME\\fP is switched off by "
             "\\fB\\-\\-no\\-\\fP\\fINAME\\fP.");
    for (size_t n = 0; n < c->option_count; n++)
        print_option(c, &c->options[n]);
    for (size_t n = 0; n < cli_common_option_count; n++)
        print_option(c, &cli_common_options[n]);
    const cw_status st = print_more(c, err);
    print_units(c);
    cli_roff_page(c->page, CLI_ROFF_EXAMPLES, true);
    print_exit_status();
    fputs(".SH SEE ALSO\n.BR cubewright (1)", stdout);
    for (size_t n = 0; cli_commands[n]; n++)
        if (cli_commands[n] != c && names_command(c->page, cli_commands[n]->name))
            printf(",\n.BR cubewright\\-%s (1)", cli_commands[n]->name);
    putchar('\n');
    return st;
}

static void print_program(void)
{
    print_title(NULL, 1);
    puts("turn volumes into surfaces\n"
         ".SH SYNOPSIS\n"
         "\\fBcubewright\\fP \\fICOMMAND\\fP [options] \\fIINPUT\\fP... \\fB\\-o\\fP "
         "\\fIOUTPUT\\fP\n"
         ".SH DESCRIPTION\n"
         "Turns volumes (CT, MR, micro\\-CT, simulations) into surfaces.\n"
         "Results go to the standard output, messages to the standard error.\n"
         "Each command has a manual page, and \\fBcubewright help\\fP \\fICOMMAND\\fP prints "
         "the same text.\n"
         "\\fBcubewright help \\-\\-search\\fP \\fIWORD\\fP finds options and commands for a "
         "word.\n"
         ".SH COMMANDS");
    for (size_t n = 0; cli_commands[n]; n++) {
        printf(".TP\n.BR cubewright\\-%s (1)\n", cli_commands[n]->name);
        print_text(cli_commands[n]->about);
        putchar('\n');
    }
    puts(".SH OPTIONS\nEvery command has these options.");
    for (size_t n = 0; n < cli_common_option_count; n++)
        print_option(&cli_help, &cli_common_options[n]);
    print_exit_status();
    const char *headings = strstr(cli_page_environment, "\n\n"); /* behind its introduction */
    cli_roff_page(headings ? headings : cli_page_environment, CLI_ROFF_TEXT, false);
    puts(".SH EXAMPLES\nMake a volume, and extract its surface:\n.PP\n.RS 4\n.nf\n"
         "cubewright make ct\\-head \\-o head.nrrd\n"
         "cubewright extract head.nrrd \\-\\-iso 300 \\-o skull.glb\n.fi\n.RE\n"
         ".SH SEE ALSO\n.BR cubewright (3)");
}

static void print_library(void)
{
    print_title(NULL, 3);
    puts("library that turns volumes into surfaces\n"
         ".SH SYNOPSIS\n"
         "\\fB#include <cubewright/cubewright.h>\\fP\n"
         ".PP\n"
         "\\fBcc program.c $(pkg\\-config \\-\\-cflags \\-\\-libs cubewright)\\fP\n"
         ".SH DESCRIPTION");
    cli_roff_page(cli_page_library, CLI_ROFF_TEXT, false);
    puts(".SH SEE ALSO\n.BR cubewright (1)");
}

cw_status cli_print_manual(const char *name, cw_error *err)
{
    static const char prefix[] = "cubewright-";
    const bool has_prefix = strncmp(name, prefix, sizeof prefix - 1) == 0;
    if (strcmp(name, "cubewright") == 0)
        print_program();
    else if (strcmp(name, "library") == 0)
        print_library();
    else {
        const cli_command *c =
            cli_find_command(name + (has_prefix ? sizeof prefix - 1 : 0), err);
        return c ? print_command(c, err) : CW_ERR_ARGUMENT;
    }
    return CW_OK;
}
