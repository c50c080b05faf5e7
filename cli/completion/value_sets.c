/* Lists the values that options and inputs may have, from the tables of the libraries. */
#include "cli/completion/value_sets.h"

#include "cli/framework/commands.h"
#include "cli/inputs/synthetic_input.h"

#include <cubewright/camera.h>
#include <cubewright/formats.h>
#include <cubewright/transfer.h>

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* --- formats ------------------------------------------------------------------------------ */

static bool reads_volume(const cw_format *f)
{
    return f->in_this_build && f->reads_volume;
}

static bool reads_mesh(const cw_format *f)
{
    return f->in_this_build && f->reads_mesh;
}

static bool reads_any(const cw_format *f)
{
    return reads_volume(f) || reads_mesh(f);
}

static bool writes_volume(const cw_format *f)
{
    return f->in_this_build && f->writes_volume;
}

static bool writes_mesh(const cw_format *f)
{
    return f->in_this_build && f->writes_mesh;
}

/* --- names -------------------------------------------------------------------------------- */

static const char *name_format(size_t n, const char **about, bool (*fits)(const cw_format *))
{
    size_t count;
    const cw_format *formats = cw_formats(&count);
    for (size_t i = 0; i < count; i++)
        if (fits(&formats[i]) && n-- == 0) {
            *about = formats[i].about;
            return formats[i].name;
        }
    return NULL;
}

static const char *name_reader(size_t n, const char **about)
{
    return name_format(n, about, reads_any);
}

static const char *name_mesh_reader(size_t n, const char **about)
{
    return name_format(n, about, reads_mesh);
}

static const char *name_mesh_writer(size_t n, const char **about)
{
    return name_format(n, about, writes_mesh);
}

static const char *name_transfer(size_t n, const char **about)
{
    *about = n == 0 ? "fitted to the values" : cw_transfer_preset_about(n - 1);
    return n == 0 ? "auto" : cw_transfer_preset_name(n - 1);
}

static const char *name_view(size_t n, const char **about)
{
    *about = "";
    return cw_view_name(n);
}

static const char *name_field(size_t n, const char **about)
{
    *about = n < CW_FIELD_COUNT ? cw_field_about((cw_field)n) : "";
    return n < CW_FIELD_COUNT ? cw_field_name((cw_field)n) : NULL;
}

static const char *name_made_field(size_t n, const char **about)
{
    cli_made_field s;
    if (!cli_made_field_at(n, &s))
        return NULL;
    *about = s.about;
    return s.name;
}

static const char *name_command(size_t n, const char **about)
{
    *about = cli_commands[n] ? cli_commands[n]->about : "";
    return cli_commands[n] ? cli_commands[n]->name : NULL;
}

/* Names the commands, then what `extra` lists. */
static const char *name_topic(size_t n, const char **about)
{
    for (size_t c = 0; cli_commands[c]; c++)
        if (n-- == 0)
            return name_command(c, about);
    *about = cli_topics[n].about;
    return cli_topics[n].name;
}

/* The page of the program, then those of the commands and the library. */
static const char *name_manual(size_t n, const char **about)
{
    if (n == 0) {
        *about = "the program";
        return "cubewright";
    }
    for (size_t c = 0; cli_commands[c]; c++)
        if (n-- == 1)
            return name_command(c, about);
    *about = "the library";
    return n == 1 ? "library" : NULL;
}

/* --- the sets ----------------------------------------------------------------------------- */

typedef struct value_row {
    cli_value_set set;
    const char *extensions;          /* of files that have no format */
    bool (*fits)(const cw_format *); /* whose extensions count; NULL: no formats */
    const char *(*name_at)(size_t n, const char **about);
} value_row;

static const value_row rows[CLI_VALUES_COUNT] = {
    [CLI_VALUES_ANY] = {{"any", "value"}},
    [CLI_VALUES_FILE] = {{"file", "file", .has_files = true}},
    [CLI_VALUES_FOLDER] = {{"folder", "folder", .has_folders = true}},
    [CLI_VALUES_VOLUME] = {{"volume", "volume", .has_files = true, .has_folders = true},
                           .fits = reads_volume},
    [CLI_VALUES_MESH] = {{"mesh", "mesh", .has_files = true}, .fits = reads_mesh},
    [CLI_VALUES_SCENE] = {{"scene", "volume or mesh", .has_files = true, .has_folders = true},
                          .fits = reads_any},
    [CLI_VALUES_STUDY] = {{"study", "volume, field or mesh", .has_files = true,
                           .has_folders = true},
                          .fits = reads_any,
                          .name_at = name_field},
    [CLI_VALUES_VOLUME_OUTPUT] = {{"volume_output", "volume", .has_files = true,
                                   .is_output = true},
                                  .fits = writes_volume},
    [CLI_VALUES_MESH_OUTPUT] = {{"mesh_output", "mesh", .has_files = true, .is_output = true},
                                .fits = writes_mesh},
    [CLI_VALUES_DEFECTS] = {{"defects", "mesh", .has_files = true, .is_output = true},
                            .extensions = ".ply .glb .gltf"},
    [CLI_VALUES_JSON] = {{"json", "JSON file", .has_files = true, .is_output = true},
                         .extensions = ".json"},
    [CLI_VALUES_JSON_INPUT] = {{"json_input", "JSON file", .has_files = true},
                               .extensions = ".json"},
    [CLI_VALUES_JSON_LINES] = {{"json_lines", "file of JSON lines", .has_files = true,
                                .is_output = true},
                               .extensions = ".jsonl"},
    [CLI_VALUES_CSV] = {{"csv", "CSV file", .has_files = true, .is_output = true},
                        .extensions = ".csv"},
    [CLI_VALUES_HTML] = {{"html", "page", .has_files = true, .is_output = true},
                         .extensions = ".html"},
    [CLI_VALUES_PNG] = {{"png", "picture", .has_files = true, .is_output = true},
                        .extensions = ".png"},
    [CLI_VALUES_PVD] = {{"pvd", "list", .has_files = true, .is_output = true},
                        .extensions = ".pvd"},
    [CLI_VALUES_READER] = {{"reader", "format"}, .name_at = name_reader},
    [CLI_VALUES_MESH_READER] = {{"mesh_reader", "format"}, .name_at = name_mesh_reader},
    [CLI_VALUES_MESH_WRITER] = {{"mesh_writer", "format"}, .name_at = name_mesh_writer},
    [CLI_VALUES_TRANSFER] = {{"transfer", "transfer function", .has_files = true},
                             .extensions = ".json",
                             .name_at = name_transfer},
    [CLI_VALUES_VIEW] = {{"view", "view", .has_files = true},
                         .extensions = ".json",
                         .name_at = name_view},
    [CLI_VALUES_FIELD] = {{"field", "field"}, .name_at = name_field},
    [CLI_VALUES_MADE_FIELD] = {{"made_field", "field"}, .name_at = name_made_field},
    [CLI_VALUES_TOPIC] = {{"topic", "topic"}, .name_at = name_topic},
    [CLI_VALUES_MANUAL] = {{"manual", "manual page"}, .name_at = name_manual},
};

const cli_value_set *cli_value_set_of(cli_values values)
{
    return &rows[values].set;
}

const char *cli_value_name(cli_values values, size_t n, const char **about)
{
    *about = "";
    return rows[values].name_at ? rows[values].name_at(n, about) : NULL;
}

/* A writer of volumes may use only some of its format's extensions. */
static bool is_used(cli_values values, const char *file)
{
    return values != CLI_VALUES_VOLUME_OUTPUT || cw_volume_format(file, NULL);
}

/* Adds those of ".nrrd .nhdr" that are used, and returns the length of all. */
static size_t add_extensions(cli_values values, const char *list, size_t used,
                             char text[CLI_EXTENSIONS_SIZE])
{
    while (*list) {
        char name[32];
        const size_t length = strcspn(list, " ");
        snprintf(name, sizeof name, "x%.*s", (int)length, list);
        if (is_used(values, name) && used < CLI_EXTENSIONS_SIZE)
            used += (size_t)snprintf(text + used, CLI_EXTENSIONS_SIZE - used, "%s%s",
                                     used ? " " : "", name + 1);
        list += length + (list[length] == ' ');
    }
    return used;
}

void cli_value_extensions(cli_values values, char text[CLI_EXTENSIONS_SIZE])
{
    const value_row *row = &rows[values];
    size_t count, used = 0;
    const cw_format *formats = cw_formats(&count);
    snprintf(text, CLI_EXTENSIONS_SIZE, "%s", row->extensions ? row->extensions : "");
    for (size_t n = 0; n < count && row->fits; n++)
        if (row->fits(&formats[n]))
            used = add_extensions(values, formats[n].extensions, used, text);
}

/* --- words of options --------------------------------------------------------------------- */

bool cli_option_takes_value(const cli_option *o)
{
    return o->kind->parse != NULL;
}

bool cli_option_is_negated(const cli_option *o)
{
    return o->kind == CLI_FLAG && strncmp(o->name, "no-", 3) != 0;
}

/* Capitals and brackets stand for something; a word of small letters stands for itself. */
static bool is_fixed_word(const char *word, size_t length)
{
    for (size_t n = 0; n < length; n++)
        if (!islower((unsigned char)word[n]) && word[n] != '-')
            return false;
    return length > 0;
}

const char *cli_option_word(const cli_option *o, size_t n, size_t *length)
{
    const bool is_choice = o->kind == CLI_CHOICE;
    if (!o->value || !cli_option_takes_value(o) || o->kind == CLI_WEIGHTS)
        return NULL;
    for (const char *word = o->value; *word;) {
        *length = strcspn(word, is_choice ? "/" : "/|");
        if ((is_choice || is_fixed_word(word, *length)) && n-- == 0)
            return word;
        word += *length + (word[*length] != '\0');
    }
    return NULL;
}
