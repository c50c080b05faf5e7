/* Prints the script that completes words of the command line in fish. */
#include "cli/completion/completion.h"
#include "cli/completion/value_sets.h"
#include "cli/framework/commands.h"
#include "cli/framework/option_rules.h"

#include <stdio.h>
#include <string.h>

extern const char cli_script_fish[]; /* fish.txt: what does not depend on tables */

/* Prints a text in '...', where fish knows \' and \\. */
static void print_quoted(const char *text)
{
    putchar('\'');
    for (; *text; text++) {
        if (*text == '\'' || *text == '\\')
            putchar('\\');
        putchar(*text);
    }
    putchar('\'');
}

/* Prints a function that lists the values of a set, each with its description. */
static void print_set(cli_values values)
{
    const cli_value_set *set = cli_value_set_of(values);
    const char *name, *about;
    char extensions[CLI_EXTENSIONS_SIZE];
    printf("\nfunction __cubewright_%s\n", set->name);
    for (size_t n = 0; (name = cli_value_name(values, n, &about)); n++) {
        printf("    printf '%%s\\t%%s\\n' '%s' ", name);
        print_quoted(about);
        putchar('\n');
    }
    cli_value_extensions(values, extensions);
    if (set->has_files)
        printf("    __cubewright_files %s\n", extensions);
    else if (set->has_folders)
        puts("    __cubewright_folders");
    if (set->is_output)
        printf("    __cubewright_outputs %s\n", extensions);
    puts("end");
}

static void print_option(const cli_command *c, const cli_option *o)
{
    const char *word;
    size_t length;
    if (o->kind == CLI_HEADING)
        return;
    printf("complete -c cubewright -n '__cubewright_is %s' -l %s", c->name, o->name);
    if (o->letter)
        printf(" -s %c", o->letter);
    if (cli_option_takes_value(o))
        fputs(" -x", stdout);
    if (o->values != CLI_VALUES_ANY)
        printf(" -k -a '(__cubewright_%s)'", cli_value_set_of(o->values)->name);
    else if (cli_option_word(o, 0, &length)) {
        for (size_t n = 0; (word = cli_option_word(o, n, &length)); n++)
            printf("%s%.*s", n ? " " : " -a '", (int)length, word);
        putchar('\'');
    }
    fputs(" -d ", stdout);
    print_quoted(cli_option_about(c, o));
    putchar('\n');
    if (cli_option_is_negated(o) && o >= c->options && o < c->options + c->option_count)
        printf("complete -c cubewright -n '__cubewright_negates %s' -l no-%s -d 'Switch --%s "
               "off'\n",
               c->name, o->name, o->name);
}

static void print_command(const cli_command *c)
{
    putchar('\n');
    for (size_t n = 0; n < c->option_count; n++)
        print_option(c, &c->options[n]);
    for (size_t n = 0; n < cli_common_option_count; n++)
        print_option(c, &cli_common_options[n]);
    if (c->max_inputs > 0)
        printf("complete -c cubewright -n '__cubewright_is %s' -k -a '(__cubewright_%s)'\n",
               c->name, cli_value_set_of(c->inputs)->name);
}

void cli_complete_fish(void)
{
    printf("# fish completion for cubewright, made by 'cubewright help --completion "
           "fish'.\n\n%s",
           cli_script_fish);
    for (int values = CLI_VALUES_ANY + 1; values < CLI_VALUES_COUNT; values++)
        print_set((cli_values)values);
    puts("\ncomplete -c cubewright -f\n"
         "complete -c cubewright -n __cubewright_has_no_command -l help -d 'Print the "
         "commands'\n"
         "complete -c cubewright -n __cubewright_has_no_command -l version -d 'Print the "
         "version'");
    for (size_t n = 0; cli_commands[n]; n++) {
        printf("complete -c cubewright -n __cubewright_has_no_command -a %s -d ",
               cli_commands[n]->name);
        print_quoted(cli_commands[n]->about);
        putchar('\n');
    }
    for (size_t n = 0; cli_commands[n]; n++)
        print_command(cli_commands[n]);
}
