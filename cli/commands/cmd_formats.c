/* The commands formats and version: list what this build can read, write and use. */
#include "cli/commands/command_rows.h"
#include "cli/framework/console.h"
#include "cli/framework/json_writer.h"

#include "core/base/features.h"
#include "core/base/module.h"

#include <cubewright/formats.h>

#include <stdio.h>
#include <string.h>

typedef struct formats_args {
    cli_common common;
    bool json, features, licences;
} formats_args;

static void print_row(const cw_format *f)
{
    char does[32], *d = does;
    *d++ = f->reads_volume || f->reads_mesh ? 'r' : '-';
    *d++ = f->writes_volume || f->writes_mesh ? 'w' : '-';
    *d = '\0';
    const bool volume = f->reads_volume || f->writes_volume;
    printf("%-13s%-8s%-4s%-22s%s%s\n", f->name, volume ? "volume" : "mesh", does, f->extensions,
           f->about, f->in_this_build ? "" : " (not in this build)");
}

static void print_json(const cw_format *formats, size_t count)
{
    cli_json j = {.out = stdout};
    cli_json_open(&j, NULL, '{');
    cli_json_text(&j, "schema", "cubewright-formats-1");
    cli_json_text(&j, "version", cw_version());
    cli_json_open(&j, "formats", '[');
    for (size_t i = 0; i < count; i++) {
        const cw_format *f = &formats[i];
        cli_json_open(&j, NULL, '{');
        cli_json_text(&j, "name", f->name);
        cli_json_text(&j, "extensions", f->extensions);
        cli_json_text(&j, "about", f->about);
        cli_json_bool(&j, "reads_volume", f->reads_volume);
        cli_json_bool(&j, "writes_volume", f->writes_volume);
        cli_json_bool(&j, "reads_mesh", f->reads_mesh);
        cli_json_bool(&j, "writes_mesh", f->writes_mesh);
        cli_json_bool(&j, "in_this_build", f->in_this_build);
        cli_json_text(&j, "reason", f->reason);
        cli_json_text(&j, "lost", f->lost);
        cli_json_close(&j, '}');
    }
    cli_json_close(&j, ']');
    cli_json_open(&j, "features", '[');
    const cw_feature *features = cw_features(&count);
    for (size_t i = 0; i < count; i++) {
        cli_json_open(&j, NULL, '{');
        cli_json_text(&j, "name", features[i].name);
        cli_json_text(&j, "about", features[i].about);
        cli_json_bool(&j, "available", features[i].available);
        cli_json_text(&j, "reason", features[i].reason);
        cli_json_close(&j, '}');
    }
    cli_json_close(&j, ']');
    cli_json_close(&j, '}');
}

static cw_status run_formats(void *p, cw_error *err)
{
    const formats_args *args = p;
    size_t count;
    const cw_format *formats = cw_formats(&count);
    (void)err;
    if (args->json) {
        print_json(formats, count);
        return CW_OK;
    }
    printf("%-13s%-8s%-4s%-22s%s\n", "name", "holds", "", "extensions", "what");
    for (size_t i = 0; i < count; i++)
        print_row(&formats[i]);
    puts("r: read, w: written; 'cubewright formats --json' also says what writing loses");
    return CW_OK;
}

static void print_availability(const char *name, bool available, const char *reason)
{
    if (available)
        printf("%-13syes\n", name);
    else
        printf("%-13sno: %s\n", name, reason);
}

/* Prints features and formats. A feature that is one format has the format's name and is
 * printed once. */
static void print_features(const cw_format *formats, size_t format_count)
{
    size_t count;
    const cw_feature *features = cw_features(&count);
    for (size_t i = 0; i < count; i++) {
        bool is_format = false;
        for (size_t k = 0; k < format_count; k++)
            is_format |= strcmp(features[i].name, formats[k].name) == 0;
        if (!is_format)
            print_availability(features[i].name, features[i].available, features[i].reason);
    }
    for (size_t k = 0; k < format_count; k++)
        print_availability(formats[k].name, formats[k].in_this_build, formats[k].reason);
}

/* Prints a name, and the licences of the features in a module; "": those in the library itself,
 * after those that no build is without. */
static void print_module_licences(const char *name, const char *module)
{
    char text[1024] = "";
    size_t used = 0;
    if (!*module)
        used = (size_t)snprintf(text, sizeof text, "%s", cwi_needed_licences);
    for (size_t i = 0; i < cwi_feature_row_count && used < sizeof text; i++) {
        const cwi_feature_row *row = &cwi_feature_rows[i];
        if (!*row->reason && strcmp(row->module, module) == 0)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s",
                                     used > 0 ? ", " : "", row->licences);
    }
    printf("%-13s", name);
    cli_print_wrapped(stdout, text, 13);
}

/* Prints the libraries that this build links, with their licences: a line for the library, and
 * one for each module. */
static void print_licences(void)
{
    print_module_licences("library", "");
    for (size_t i = 0; i < cwi_feature_row_count; i++) {
        const cwi_feature_row *row = &cwi_feature_rows[i];
        if (!*row->reason && *row->module && cwi_find_module_row(row->module) == row)
            print_module_licences(row->module, row->module);
    }
}

static cw_status run_version(void *p, cw_error *err)
{
    const formats_args *args = p;
    size_t count;
    const cw_format *formats = cw_formats(&count);
    (void)err;
    if (args->json) {
        print_json(formats, count);
        return CW_OK;
    }
    printf("cubewright %s\n", cw_version());
    if (args->features)
        print_features(formats, count);
    if (args->licences)
        print_licences();
    return CW_OK;
}

static const cli_option formats_options[] = {
    {"json", 0, CLI_FLAG, NULL, "Print one JSON object (off)", offsetof(formats_args, json)},
};

const cli_command cli_formats = {
    .name = "formats",
    .usage = "",
    .about = "List the file formats that this build reads and writes",
    .page = cli_page_formats,
    .options = formats_options,
    .option_count = sizeof formats_options / sizeof *formats_options,
    .size = sizeof(formats_args),
    .run = run_formats,
};

static const cli_option version_options[] = {
    {"features", 0, CLI_FLAG, NULL,
     "List the optional parts of this build, and why any is missing (off)",
     offsetof(formats_args, features)},
    {"licences", 0, CLI_FLAG, NULL,
     "List the libraries that this build links, with their licences (off)",
     offsetof(formats_args, licences)},
    {"json", 0, CLI_FLAG, NULL, "Print one JSON object, with formats and features (off)",
     offsetof(formats_args, json)},
};

const cli_command cli_version = {
    .name = "version",
    .usage = "",
    .about = "Print the version and the parts of this build",
    .page = cli_page_version,
    .options = version_options,
    .option_count = sizeof version_options / sizeof *version_options,
    .size = sizeof(formats_args),
    .run = run_version,
};
