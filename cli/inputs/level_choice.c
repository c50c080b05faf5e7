/* Finds the numbers of isovalues that are named, and says them. */
#include "cli/inputs/level_choice.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/volume/named_level.h"

#include <cubewright/stream.h>

typedef struct stream_request {
    int threads;
    cw_statistics *out;
} stream_request;

static cw_status count_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    const stream_request *r = user;
    return cw_stream_statistics(source, CWI_LEVEL_BINS, r->threads, r->out, err);
}

static cw_status find_statistics(const cli_volume *volume, const cli_input *input,
                                 cw_statistics *s, cw_error *err)
{
    stream_request request = {.threads = (int)input->threads, .out = s};
    const cw_slice_visitor visitor = {count_slices, &request};
    cw_status st = volume->streams ? cli_visit_slices(volume, input, &visitor, err)
                                   : cw_volume_statistics(&volume->view, CWI_LEVEL_BINS,
                                                          (int)input->threads, s, err);
    return st;
}

static cw_status choose_level(const cli_volume *volume, const cw_statistics *s,
                              cli_level *level, double *value, cw_error *err)
{
    if (*level == CLI_LEVEL_NUMBER)
        return CW_OK;
    const char *name = cli_level_text(*level, *value);
    cw_status st = cw_statistics_level(s, &volume->whole, name, value, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, volume->path);
    cli_say("%s: isovalue %s is %s%s", volume->path, name, cli_number_text(*value),
            *level < CLI_LEVEL_BONE ? "" : " HU");
    *level = CLI_LEVEL_NUMBER;
    return CW_OK;
}

cw_status cli_choose_levels(const cli_volume *volume, const cli_input *input,
                            cli_numbers *levels, cw_error *err)
{
    cw_statistics s = {0};
    bool named = false;
    for (size_t n = 0; n < levels->count; n++)
        named = named || levels->level[n] != CLI_LEVEL_NUMBER;
    cw_status st = named ? find_statistics(volume, input, &s, err) : CW_OK;
    for (size_t n = 0; n < levels->count && st == CW_OK; n++)
        st = choose_level(volume, &s, levels->level + n, levels->value + n, err);
    cw_statistics_free(&s);
    return st;
}

cw_status cli_choose_level(const cli_volume *volume, const cli_input *input, cli_number *level,
                           cw_error *err)
{
    cli_numbers one = {.count = level->given, .value = {level->value}, .level = {level->level}};
    cw_status st = cli_choose_levels(volume, input, &one, err);
    level->value = one.value[0];
    level->level = one.level[0];
    return st;
}

cw_status cli_find_level(const cli_volume *volume, const cli_input *input, double *iso,
                         const char **how, cw_error *err)
{
    const bool is_level_set = volume->whole.known & CW_KNOWN_LEVEL_SET;
    cli_number level = {.given = true,
                        .level = is_level_set ? CLI_LEVEL_NUMBER : CLI_LEVEL_OTSU};
    cw_status st = cli_choose_level(volume, input, &level, err);
    *how = is_level_set ? "of level sets" : "otsu";
    *iso = level.value;
    return st;
}
