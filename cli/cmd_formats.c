/* formats and version: what this build can do. */
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/json.h"
#include "core/module.h"

#include <cubewright/formats.h>
#include <cubewright/level_set.h>
#include <cubewright/quality.h>
#include <cubewright/simplify.h>

#include <stdio.h>

typedef struct formats_args {
    cli_common common;
    bool json, features;
} formats_args;

static void print_row(const cw_format *f)
{
    char does[32], *d = does;
    *d++ = f->reads_volume || f->reads_mesh ? 'r' : '-';
    *d++ = f->writes_volume || f->writes_mesh ? 'w' : '-';
    *d = '\0';
    const bool volume = f->reads_volume || f->writes_volume;
    printf("%-11s%-8s%-4s%-22s%s%s\n", f->name, volume ? "volume" : "mesh", does, f->extensions,
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
        cli_json_text(&j, "lost", f->lost);
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
    printf("%-11s%-8s%-4s%-22s%s\n", "name", "holds", "", "extensions", "what");
    for (size_t i = 0; i < count; i++)
        print_row(&formats[i]);
    puts("r: read, w: written; 'cubewright formats --json' also says what writing loses");
    return CW_OK;
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
    if (args->features) {
        printf("%-11s%s\n", "cgal", cw_quality_has_cgal() ? "yes" : "no");
        printf("%-11s%s\n", "simplify", cw_simplify_available() ? "yes" : "no");
        printf("%-11s%s\n", "level-set", cw_level_set_available() ? "yes" : "no");
        printf("%-11s%s\n", "gl", cwi_module_present("gl") ? "yes" : "no");
        printf("%-11s%s\n", "window", cwi_module_present("window") ? "yes" : "no");
    }
    for (size_t i = 0; i < count && args->features; i++)
        printf("%-11s%s\n", formats[i].name, formats[i].in_this_build ? "yes" : "no");
    return CW_OK;
}

static const cli_option formats_options[] = {
    {"json", 0, CLI_FLAG, NULL, "one JSON object", offsetof(formats_args, json)},
};

const cli_command cli_formats = {
    .name = "formats",
    .usage = "",
    .about = "the files this build reads and writes",
    .options = formats_options,
    .option_count = sizeof formats_options / sizeof *formats_options,
    .size = sizeof(formats_args),
    .run = run_formats,
};

static const cli_option version_options[] = {
    {"features", 0, CLI_FLAG, NULL, "also what is in this build",
     offsetof(formats_args, features)},
    {"json", 0, CLI_FLAG, NULL, "one JSON object, with the formats",
     offsetof(formats_args, json)},
};

const cli_command cli_version = {
    .name = "version",
    .usage = "",
    .about = "the version of this program",
    .options = version_options,
    .option_count = sizeof version_options / sizeof *version_options,
    .size = sizeof(formats_args),
    .run = run_version,
};
