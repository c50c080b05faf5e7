/* Checks rules between options, and puts them into words. */
#include "cli/framework/option_rules.h"

#include "core/base/status.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 64, TEXT_BYTES = 1024 };

/* A name of a rule: "smooth", "no-measure", "method=fair". */
typedef struct term {
    const cli_option *option; /* NULL: the command has none of that name */
    bool is_off;              /* a flag that is off */
    char name[NAME_BYTES];
    const char *value; /* in name; NULL: any */
} term;

/* Reads the next of some names parted by blanks. Returns false at the end. */
static bool next_term(const cli_command *c, const char **names, term *t)
{
    *names += strspn(*names, " ");
    const size_t length = strcspn(*names, " ");
    if (length == 0 || length >= sizeof t->name)
        return false;
    *t = (term){0};
    memcpy(t->name, *names, length);
    *names += length;
    char *equals = strchr(t->name, '=');
    if (equals) {
        *equals = '\0';
        t->value = equals + 1;
    }
    t->option = cli_find_option(c, t->name, NULL);
    t->is_off = !t->option && strncmp(t->name, "no-", 3) == 0;
    if (t->is_off)
        t->option = cli_find_option(c, t->name + 3, NULL);
    return true;
}

/* Returns whether the field differs from its default, and has the value of the term. */
static bool is_met(const cli_command *c, const void *args, const term *t)
{
    char text[256];
    const cli_option *o = t->option;
    if (!o)
        return false;
    const char *field = (const char *)args + o->offset;
    if (o->kind == CLI_FLAG)
        return *(const bool *)field != t->is_off;
    if (t->value)
        return cli_option_text(o, args, text, sizeof text) && strcmp(text, t->value) == 0;
    const char *initial = c->defaults ? (const char *)c->defaults + o->offset : NULL;
    for (size_t n = 0; n < o->kind->size; n++)
        if (field[n] != (initial ? initial[n] : 0))
            return true;
    return false;
}

/* Prints "--smooth METHOD", "--no-measure" or "--method fair". */
static size_t print_term(const term *t, bool with_value, char *text, size_t size)
{
    const char *value = t->value ? t->value : t->option ? t->option->value : NULL;
    const bool shows = value && (t->value || (with_value && t->option->kind != CLI_CHOICE));
    const int length =
        snprintf(text, size, "--%s%s%s", t->name, shows ? " " : "", shows ? value : "");
    return length > 0 && (size_t)length < size ? (size_t)length : size;
}

/* Prints names with a text between: "--source VOLUME or --reference MESH". */
static void print_terms(const cli_command *c, const char *names, const char *between,
                        bool with_values, char *text, size_t size)
{
    term t;
    size_t used = 0;
    *text = '\0';
    while (used < size && next_term(c, &names, &t)) {
        if (used)
            used += (size_t)snprintf(text + used, size - used, "%s", between);
        if (used < size)
            used += print_term(&t, with_values, text + used, size - used);
    }
}

/* Checks a rule for one option, or for the command itself: who says which. */
static cw_status check_rule(const cli_command *c, const void *args, const cli_rule *rule,
                            const char *who, cw_error *err)
{
    term other;
    char text[TEXT_BYTES];
    for (const char *names = rule->others; next_term(c, &names, &other);) {
        const bool met = is_met(c, args, &other);
        if (met && rule->relation == CLI_NEEDS)
            return CW_OK;
        if (met) {
            print_term(&other, false, text, sizeof text);
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s cannot be combined with %s", who, text);
        }
    }
    if (rule->relation == CLI_EXCLUDES)
        return CW_OK;
    print_terms(c, rule->others, " or ", true, text, sizeof text);
    return cwi_fail(err, CW_ERR_ARGUMENT, "%s needs %s", who, text);
}

cw_status cli_check_rules(const cli_command *command, const void *args, cw_error *err)
{
    term t;
    char who[2 * NAME_BYTES];
    for (size_t n = 0; n < command->rule_count; n++) {
        const cli_rule *rule = &command->rules[n];
        cw_status st = CW_OK;
        if (!rule->options)
            st = check_rule(command, args, rule, command->name, err);
        for (const char *names = rule->options;
             st == CW_OK && names && next_term(command, &names, &t);) {
            print_term(&t, false, who, sizeof who);
            if (is_met(command, args, &t))
                st = check_rule(command, args, rule, who, err);
        }
        if (st != CW_OK)
            return st;
    }
    return CW_OK;
}

const char *cli_find_given(const cli_command *command, const void *args, const char *names)
{
    static char text[2 * NAME_BYTES];
    term t;
    while (next_term(command, &names, &t))
        if (is_met(command, args, &t)) {
            print_term(&t, false, text, sizeof text);
            return text;
        }
    return NULL;
}

/* --- words -------------------------------------------------------------------------------- */

/* Returns true if one of the names is that of an option. */
static bool names_option(const cli_command *c, const char *names, const cli_option *o)
{
    term t;
    while (names && next_term(c, &names, &t))
        if (t.option == o)
            return true;
    return false;
}

/* Appends "; needs --smooth". */
static void add_words(char *text, const char *relation, const char *names)
{
    const size_t used = strlen(text);
    if (used < TEXT_BYTES)
        snprintf(text + used, TEXT_BYTES - used, "; %s %s", relation, names);
}

/* Returns true if a list "--a, --b" holds a name of `length` characters. */
static bool holds_name(const char *list, const char *name, size_t length)
{
    for (const char *at = list; *at; at += strcspn(at, ","), at += strspn(at, ", "))
        if (strcspn(at, ",") == length && memcmp(at, name, length) == 0)
            return true;
    return false;
}

/* Appends the names of a list that another one does not hold yet. */
static void add_names(char *list, size_t size, const char *names)
{
    for (const char *at = names; *at;) {
        const size_t length = strcspn(at, ","), used = strlen(list);
        if (!holds_name(list, at, length))
            snprintf(list + used, size - used, "%s%.*s", used ? ", " : "", (int)length, at);
        at += length;
        at += strspn(at, ", ");
    }
}

const char *cli_option_about(const cli_command *command, const cli_option *option)
{
    static char text[TEXT_BYTES];
    char names[256], not_with[512] = "";
    snprintf(text, sizeof text, "%s", option->about);
    for (size_t n = 0; n < command->rule_count; n++) {
        const cli_rule *rule = &command->rules[n];
        const bool is_first = names_option(command, rule->options, option),
                   is_other = names_option(command, rule->others, option);
        if (rule->relation == CLI_NEEDS && is_first) {
            print_terms(command, rule->others, " or ", false, names, sizeof names);
            add_words(text, "needs", names);
        } else if (rule->relation == CLI_EXCLUDES && (is_first || is_other)) {
            print_terms(command, is_first ? rule->others : rule->options, ", ", false, names,
                        sizeof names);
            add_names(not_with, sizeof not_with, names);
        }
    }
    if (*not_with)
        add_words(text, "not with", not_with);
    return text;
}
