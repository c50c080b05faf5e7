/* Tests the tables of options of all commands: their names, letters, kinds and rules. */
#define _DEFAULT_SOURCE /* strsep */
#include "cli/command_table.h"
#include "cli/framework/commands.h"
#include "cli/framework/option_rules.h"
#include "support/support.h"

#include <string.h>

enum { ROWS = CLI_MAX_OPTIONS + 8 };

/* Lists a command's options, the common ones last. Returns how many there are. */
static size_t list_options(const cli_command *c, const cli_option *options[ROWS])
{
    size_t count = 0;
    for (size_t n = 0; n < c->option_count + cli_common_option_count; n++) {
        const cli_option *o =
            n < c->option_count ? &c->options[n] : &cli_common_options[n - c->option_count];
        if (o->kind != CLI_HEADING)
            options[count++] = o;
    }
    return count;
}

/* `view` has an option --config of its own, for its settings. */
static bool may_be_twice(const cli_command *c, const char *name)
{
    return strcmp(c->name, "view") == 0 && strcmp(name, "config") == 0;
}

static void no_command_has_a_name_or_a_letter_twice(void **state)
{
    const cli_option *options[ROWS];
    (void)state;
    for (size_t n = 0; cli_commands[n]; n++) {
        const cli_command *c = cli_commands[n];
        assert_true(c->option_count <= CLI_MAX_OPTIONS);
        const size_t count = list_options(c, options);
        for (size_t a = 0; a < count; a++)
            for (size_t b = a + 1; b < count; b++) {
                const bool same_name = strcmp(options[a]->name, options[b]->name) == 0 &&
                                       !may_be_twice(c, options[a]->name);
                const bool same_letter =
                    options[a]->letter && options[a]->letter == options[b]->letter;
                if (same_name || same_letter)
                    fail_msg("%s: --%s and --%s", c->name, options[a]->name, options[b]->name);
            }
    }
}

/* Returns true if an option prints a value as it was typed, so that a rule can name it. */
static bool has_value(const cli_option *o, const char *value)
{
    char field[256] = "", text[256] = "";
    assert_true(o->kind->size <= sizeof field);
    if (o->kind == CLI_CHOICE)
        return cli_value_fits(o, value);
    if (!o->kind->parse || !o->kind->print || !o->kind->parse(o, value, field))
        return false;
    o->kind->print(o, field, text, sizeof text);
    return strcmp(text, value) == 0;
}

/* Checks each name of a list: NAME, no-NAME of a flag, or NAME=VALUE. */
static void check_names(const cli_command *c, const char *names)
{
    char list[512], *next = list;
    snprintf(list, sizeof list, "%s", names ? names : "");
    for (char *name; (name = strsep(&next, " ")) != NULL;) {
        char *value = name;
        strsep(&value, "=");
        const bool is_off = !cli_find_option(c, name, NULL) && strncmp(name, "no-", 3) == 0;
        const cli_option *o = cli_find_option(c, name + (is_off ? 3 : 0), NULL);
        if (*name && !o)
            fail_msg("%s has no option '%s', which a rule names", c->name, name);
        else if (o && is_off && o->kind != CLI_FLAG)
            fail_msg("%s: '%s' is of no flag", c->name, name);
        else if (o && value && !has_value(o, value))
            fail_msg("%s: --%s has no value '%s'", c->name, name, value);
    }
}

static void rules_name_options_that_exist(void **state)
{
    size_t count = 0;
    (void)state;
    for (size_t n = 0; cli_commands[n]; n++)
        for (size_t r = 0; r < cli_commands[n]->rule_count; r++, count++) {
            check_names(cli_commands[n], cli_commands[n]->rules[r].options);
            check_names(cli_commands[n], cli_commands[n]->rules[r].others);
            assert_true(strlen(cli_commands[n]->rules[r].others) > 0);
        }
    assert_true(count > 40);
}

/* A command with each form of a rule. */
typedef struct sample_args {
    cli_common common;
    bool fast, measure;
    const char *file;
    int mode;
    cli_number width, height;
} sample_args;

static const sample_args sample_defaults = {.measure = true, .mode = 1};

static const cli_option sample_options[] = {
    {"fast", 0, CLI_FLAG, NULL, "Hurry (off)", offsetof(sample_args, fast)},
    {"measure", 0, CLI_FLAG, NULL, "Measure (on)", offsetof(sample_args, measure)},
    {"file", 0, CLI_TEXT, "FILE", "File (none)", offsetof(sample_args, file)},
    {"mode", 0, CLI_CHOICE, "low/middle/high", "Mode (middle)", offsetof(sample_args, mode)},
    {"width", 0, CLI_NUMBER, "W", "Width (1)", offsetof(sample_args, width)},
    {"height", 0, CLI_NUMBER, "H", "Height (1)", offsetof(sample_args, height)},
};

static const cli_rule sample_rules[] = {
    {NULL, CLI_NEEDS, "file fast"},
    {"width height", CLI_NEEDS, "mode=high"},
    {"fast", CLI_EXCLUDES, "no-measure height"},
    {"mode=low", CLI_EXCLUDES, "file"},
};

static const cli_command sample = {
    .name = "sample",
    .usage = "",
    .options = sample_options,
    .option_count = sizeof sample_options / sizeof *sample_options,
    .rules = sample_rules,
    .rule_count = sizeof sample_rules / sizeof *sample_rules,
    .size = sizeof(sample_args),
    .defaults = &sample_defaults,
};

static void rules_are_checked_and_told(void **state)
{
    static const struct {
        const char *words[4];
        const char *message; /* NULL: the rules are kept */
    } rows[] = {
        {{NULL}, "sample needs --file FILE or --fast"},
        {{"--no-fast"}, "sample needs --file FILE or --fast"},
        {{"--fast"}, NULL},
        {{"--file=a", "--mode=middle"}, NULL},
        {{"--file=a", "--width=2"}, "--width needs --mode high"},
        {{"--file=a", "--height=2", "--mode=high"}, NULL},
        {{"--fast", "--no-measure"}, "--fast cannot be combined with --no-measure"},
        {{"--fast", "--measure"}, NULL},
        {{"--fast", "--mode=high", "--height=2"}, "--fast cannot be combined with --height"},
        {{"--file=a", "--mode=low"}, "--mode low cannot be combined with --file"},
    };
    (void)state;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        sample_args args = sample_defaults;
        const char *inputs[4];
        int count = 0;
        cw_error err = {0};
        while (count < 4 && rows[n].words[count])
            count++;
        assert_ok(cli_parse(&sample, count, (char **)rows[n].words, &args, inputs, &err), err);
        const cw_status st = cli_check_rules(&sample, &args, &err);
        assert_int_equal(st, rows[n].message ? CW_ERR_ARGUMENT : CW_OK);
        if (rows[n].message)
            assert_string_equal(err.message, rows[n].message);
    }
}

static void help_tells_the_rules(void **state)
{
    (void)state;
    assert_string_equal(cli_option_about(&sample, &sample_options[0]),
                        "Hurry (off); not with --no-measure, --height");
    assert_string_equal(cli_option_about(&sample, &sample_options[4]),
                        "Width (1); needs --mode high");
    assert_string_equal(cli_option_about(&sample, &sample_options[5]),
                        "Height (1); needs --mode high; not with --fast");
}

/* Texts with a bare number where a length, an area or a volume is due. */
static void no_quantity_takes_a_bare_number(void **state)
{
    static const char *const bare[] = {"2",       "0.5",         "1x1x2",       "1mm,1mm,2",
                                       "gauss:1", "bilateral:1", "fair:4",      "z=10",
                                       "-x=0.5",  "4@-z",        "4mm@-z,3@+x", "iso:1",
                                       "1:cubic", "-1",          "10%x"};
    const cli_option *options[ROWS];
    size_t count_of_quantities = 0;
    (void)state;
    for (size_t n = 0; cli_commands[n]; n++) {
        const size_t count = list_options(cli_commands[n], options);
        for (size_t o = 0; o < count; o++) {
            const cli_kind *kind = options[o]->kind;
            if (!kind->unit_rule || kind == CLI_RANGES || kind == CLI_CROP)
                continue; /* numbers of voxels */
            count_of_quantities++;
            for (size_t b = 0; b < sizeof bare / sizeof *bare; b++)
                if (cli_value_fits(options[o], bare[b]) && !(kind == CLI_REDUCTION && b == 0))
                    fail_msg("%s --%s takes '%s'", cli_commands[n]->name, options[o]->name,
                             bare[b]);
        }
    }
    assert_true(count_of_quantities > 50);
}

static void lengths_take_their_units_alone(void **state)
{
    static const struct {
        const cli_kind *kind;
        bool mm, percent, voxels, negative;
    } rows[] = {
        {CLI_LENGTH, true, true, true, false},
        {CLI_MESH_LENGTH, true, true, false, false},
        {CLI_VOXEL_LENGTH, true, false, true, false},
        {CLI_PRINT_LENGTH, true, false, false, false},
        {CLI_SHIFT, true, true, false, true},
        {CLI_REDUCTION, true, false, true, false},
    };
    (void)state;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cli_option o = {"length", 0, rows[n].kind, "off/L", "", 0};
        assert_int_equal(cli_value_fits(&o, "12um"), rows[n].mm);
        assert_int_equal(cli_value_fits(&o, "1%"), rows[n].percent);
        assert_int_equal(cli_value_fits(&o, "0.5vox"), rows[n].voxels);
        assert_int_equal(cli_value_fits(&o, "-2mm"), rows[n].negative);
        assert_int_equal(cli_value_fits(&o, "0mm"), rows[n].negative);
        assert_int_equal(cli_value_fits(&o, "off"), rows[n].kind != CLI_REDUCTION);
        assert_false(cli_value_fits(&o, "1mm3"));
        assert_false(cli_value_fits(&o, "1 mm x"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_command_has_a_name_or_a_letter_twice),
        cmocka_unit_test(rules_name_options_that_exist),
        cmocka_unit_test(rules_are_checked_and_told),
        cmocka_unit_test(help_tells_the_rules),
        cmocka_unit_test(no_quantity_takes_a_bare_number),
        cmocka_unit_test(lengths_take_their_units_alone),
    };
    cli_commands = cli_command_table;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
