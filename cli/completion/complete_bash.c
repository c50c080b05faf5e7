/* Prints the script that completes words of the command line in bash. */
#include "cli/completion/completion.h"
#include "cli/completion/value_sets.h"
#include "cli/framework/commands.h"

#include <stdio.h>
#include <string.h>

extern const char cli_script_bash[]; /* bash.txt: what does not depend on tables */

/* Prints the name and the letter of an option as a pattern: "--output | -o". */
static void print_pattern(const cli_option *o)
{
    printf("--%s", o->name);
    if (o->letter)
        printf(" | -%c", o->letter);
}

static void print_set(cli_values values)
{
    const cli_value_set *set = cli_value_set_of(values);
    const char *name, *about;
    char extensions[CLI_EXTENSIONS_SIZE];
    printf("    %s)\n", set->name);
    for (size_t n = 0; (name = cli_value_name(values, n, &about)); n++)
        printf("%s%s", n ? " " : "        words+=(", name);
    if (cli_value_name(values, 0, &about))
        puts(")");
    cli_value_extensions(values, extensions);
    if (set->has_files)
        printf("        files=1 extensions='%s'\n", extensions);
    if (set->has_folders)
        puts("        folders=1");
    if (set->is_output)
        puts("        output=1");
    puts("        ;;");
}

static bool has_words(const cli_option *o)
{
    size_t length;
    return cli_option_word(o, 0, &length) != NULL;
}

/* Prints the case of an option whose values are known. */
static void print_known(const cli_option *o)
{
    const char *word;
    size_t length;
    fputs("    ", stdout);
    print_pattern(o);
    fputs(") takes=1", stdout);
    for (size_t n = 0; (word = cli_option_word(o, n, &length)); n++)
        printf("%s%.*s", n ? " " : " words=(", (int)length, word);
    printf("%s", has_words(o) ? ")" : "");
    if (o->values != CLI_VALUES_ANY)
        printf(" && _cubewright_values %s", cli_value_set_of(o->values)->name);
    puts(" ;;");
}

/* Prints one case for all options with values of which nothing is known. */
static void print_unknown(const cli_command *c)
{
    bool any = false;
    for (size_t n = 0; n < c->option_count; n++) {
        const cli_option *o = &c->options[n];
        if (!cli_option_takes_value(o) || o->values != CLI_VALUES_ANY || has_words(o))
            continue;
        fputs(any ? " | " : "    ", stdout);
        print_pattern(o);
        any = true;
    }
    if (any)
        puts(") takes=1 ;;");
}

static void print_names(const cli_option *options, size_t count)
{
    for (size_t n = 0; n < count; n++)
        if (options[n].kind != CLI_HEADING)
            printf(" --%s", options[n].name);
}

/* Prints the letters of options, and the rules that exclude options: "labels:iso inside". */
static void print_rules(const cli_command *c)
{
    fputs("        letters='", stdout);
    for (size_t n = 0; n < c->option_count; n++)
        if (c->options[n].letter)
            printf(" %c=%s ", c->options[n].letter, c->options[n].name);
    fputs("'\n        rules=(", stdout);
    for (size_t n = 0; n < c->rule_count; n++)
        if (c->rules[n].options && c->rules[n].relation == CLI_EXCLUDES)
            printf(" '%s:%s'", c->rules[n].options, c->rules[n].others);
    puts(" )\n        ;;");
}

static void print_command(const cli_command *c)
{
    printf("\n_cubewright_command_%s()\n{\n    case $1 in\n    options)\n        words=(",
           c->name);
    print_names(c->options, c->option_count);
    print_names(cli_common_options, cli_common_option_count);
    fputs(" )\n        negated=(", stdout);
    for (size_t n = 0; n < c->option_count; n++)
        if (cli_option_is_negated(&c->options[n]))
            printf(" --no-%s", c->options[n].name);
    puts(" )");
    print_rules(c);
    if (c->max_inputs > 0)
        printf("    inputs) _cubewright_values %s ;;\n", cli_value_set_of(c->inputs)->name);
    for (size_t n = 0; n < c->option_count; n++)
        if (cli_option_takes_value(&c->options[n]) &&
            (c->options[n].values != CLI_VALUES_ANY || has_words(&c->options[n])))
            print_known(&c->options[n]);
    print_unknown(c);
    puts("    esac\n}");
}

void cli_complete_bash(void)
{
    puts("# bash completion for cubewright, made by 'cubewright help --completion bash'.\n\n"
         "# Adds the values of a set: words, files of some extensions, folders.\n"
         "_cubewright_values()\n{\n    case $1 in");
    for (int values = CLI_VALUES_ANY + 1; values < CLI_VALUES_COUNT; values++)
        print_set((cli_values)values);
    puts("    esac\n}\n\n"
         "# A function a command: its options, its inputs, or the values of an option.");
    for (size_t n = 0; cli_commands[n]; n++)
        print_command(cli_commands[n]);
    fputs("\n_cubewright_commands()\n{\n    words=(", stdout);
    for (size_t n = 0; cli_commands[n]; n++)
        printf("%s%s", n ? " " : "", cli_commands[n]->name);
    printf(")\n}\n\n%s", cli_script_bash);
}
