/* Prints the script that completes words of the command line in zsh. */
#include "cli/completion/completion.h"
#include "cli/completion/value_sets.h"
#include "cli/framework/commands.h"
#include "cli/framework/option_rules.h"

#include <stdio.h>
#include <string.h>

extern const char cli_script_zsh[]; /* zsh.txt: what does not depend on tables */

/* Prints a text inside of '...', with a backslash before some characters. */
static void print_quoted(const char *text, size_t length, const char *special)
{
    for (size_t n = 0; n < length && text[n]; n++) {
        if (strchr(special, text[n]))
            putchar('\\');
        if (text[n] == '\'')
            fputs("'\\''", stdout);
        else
            putchar(text[n]);
    }
}

/* Prints the files of a set as a pattern: '(#i)*.(nii.gz|nii)(-.)'. */
static void print_files(const cli_value_set *set, const char *extensions)
{
    if (!*extensions) {
        puts(set->has_files ? "    _files && ret=0" : "    _files -/ && ret=0");
        return;
    }
    fputs("    _files -g '(#i)*.(", stdout);
    for (const char *c = extensions; *c; c++)
        if (*c == ' ')
            putchar('|');
        else if (c != extensions && (*c != '.' || c[-1] != ' '))
            putchar(*c);
    puts(")(-.)' && ret=0");
}

static void print_set(cli_values values)
{
    const cli_value_set *set = cli_value_set_of(values);
    const char *name, *about;
    char extensions[CLI_EXTENSIONS_SIZE];
    printf("\n_cubewright_%s()\n{\n    local ret=1\n", set->name);
    if (cli_value_name(values, 0, &about)) {
        puts("    local -a names=(");
        for (size_t n = 0; (name = cli_value_name(values, n, &about)); n++) {
            printf("        '%s", name);
            if (*about)
                putchar(':');
            print_quoted(about, strlen(about), "\\");
            puts("'");
        }
        printf("    )\n    _describe -t names '%s' names && ret=0\n", set->what);
    }
    cli_value_extensions(values, extensions);
    if (set->has_files || set->has_folders)
        print_files(set, extensions);
    if (set->is_output)
        printf("    _cubewright_outputs %s && ret=0\n", extensions);
    puts("    return ret\n}");
}

/* Prints what follows an option: the name of its value, and how to complete it. */
static void print_value(const cli_option *o)
{
    const char *word;
    size_t length;
    putchar(':');
    print_quoted(o->value, strlen(o->value), "\\:[]");
    putchar(':');
    if (o->values != CLI_VALUES_ANY)
        printf("_cubewright_%s", cli_value_set_of(o->values)->name);
    else if (cli_option_word(o, 0, &length)) {
        for (size_t n = 0; (word = cli_option_word(o, n, &length)); n++)
            printf("%s%.*s", n ? " " : "(", (int)length, word);
        putchar(')');
    } else {
        putchar(' ');
    }
}

static void print_option(const cli_command *c, const cli_option *o)
{
    const char *about = cli_option_about(c, o);
    const bool takes = cli_option_takes_value(o);
    if (o->kind == CLI_HEADING)
        return;
    printf("        '");
    if (o->kind == CLI_LOUDER)
        printf("*'{-%c,--%s}'[", o->letter, o->name);
    else if (o->letter)
        printf("(-%c --%s)'{-%c%s,--%s%s}'[", o->letter, o->name, o->letter, takes ? "+" : "",
               o->name, takes ? "=" : "");
    else
        printf("--%s%s[", o->name, takes ? "=" : "");
    print_quoted(about, strlen(about), "\\[]:");
    putchar(']');
    if (takes)
        print_value(o);
    puts("'");
}

static void print_command(const cli_command *c)
{
    printf("\n_cubewright_command_%s()\n{\n    local -a specs=(\n", c->name);
    for (size_t n = 0; n < c->option_count; n++)
        print_option(c, &c->options[n]);
    for (size_t n = 0; n < cli_common_option_count; n++)
        print_option(c, &cli_common_options[n]);
    puts("    )\n    [[ $PREFIX == --no* ]] && specs+=(");
    for (size_t n = 0; n < c->option_count; n++)
        if (cli_option_is_negated(&c->options[n]))
            printf("        '--no-%s[Switch --%s off]'\n", c->options[n].name,
                   c->options[n].name);
    fputs("    )\n    _arguments -s -S : $specs", stdout);
    if (c->max_inputs > 0)
        printf(" '%s:%s:_cubewright_%s'", c->max_inputs > 1 ? "*" : "",
               cli_value_set_of(c->inputs)->what, cli_value_set_of(c->inputs)->name);
    puts("\n}");
}

void cli_complete_zsh(void)
{
    puts("#compdef cubewright\n"
         "# zsh completion for cubewright, made by 'cubewright help --completion zsh'.");
    for (int values = CLI_VALUES_ANY + 1; values < CLI_VALUES_COUNT; values++)
        print_set((cli_values)values);
    for (size_t n = 0; cli_commands[n]; n++)
        print_command(cli_commands[n]);
    puts("\n_cubewright_commands()\n{\n    local -a names=(");
    for (size_t n = 0; cli_commands[n]; n++) {
        printf("        '%s:", cli_commands[n]->name);
        print_quoted(cli_commands[n]->about, strlen(cli_commands[n]->about), "\\");
        puts("'");
    }
    printf("    )\n    _describe -t commands 'command' names\n}\n\n%s", cli_script_zsh);
}
