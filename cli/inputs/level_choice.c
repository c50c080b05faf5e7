/* Finds the numbers of isovalues that are named: by Otsu's method, by the range of the values, or in
 * Hounsfield units. */
#include "cli/inputs/level_choice.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/missing_values.h"

#include <cubewright/stream.h>

#include <stdio.h>

double cli_round_level(double value)
{
    char text[32];
    const char *begin = text;
    snprintf(text, sizeof text, "%.6g", value);
    cwi_parse_double(&begin, &value);
    return value;
}

double cli_hounsfield_level(cli_level level)
{
    switch (level) {
    case CLI_LEVEL_BONE:
        return 226; /* above soft tissue and most of its contrast agents */
    case CLI_LEVEL_SKIN:
        return -300; /* between air, -1000, and fat, -100; nearer to fat, for hair and cloth */
    case CLI_LEVEL_SOFT:
        return -20; /* between fat, -90, and muscle, 50 */
    case CLI_LEVEL_LUNG:
        return -500; /* between lung, -850, and soft tissue */
    default:
        return 2500; /* metal: above enamel and dense bone */
    }
}

typedef struct stream_request {
    int threads;
    cw_statistics *out;
} stream_request;

static cw_status count_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    const stream_request *r = user;
    return cw_stream_statistics(source, CLI_LEVEL_BINS, r->threads, r->out, err);
}

static cw_status find_statistics(const cli_volume *volume, const cli_input *input,
                                 cw_statistics *s, cw_error *err)
{
    stream_request request = {.threads = (int)input->threads, .out = s};
    const cw_slice_visitor visitor = {count_slices, &request};
    cw_status st = volume->streams ? cli_visit_slices(volume, input, &visitor, err)
                                   : cw_volume_statistics(&volume->view, CLI_LEVEL_BINS,
                                                          (int)input->threads, s, err);
    char missing[CWI_MISSING_TEXT];
    if (st == CW_OK && !s->finite) {
        cwi_tell_missing(&volume->whole, s, missing);
        st = cwi_fail(err, CW_ERR_EMPTY, "%s: no voxel has a finite value%s", volume->path,
                      missing);
    }
    return st;
}

static cw_status find_otsu(const cli_volume *volume, const cw_statistics *s, cli_level level,
                           double *value, cw_error *err)
{
    double values[3];
    char missing[CWI_MISSING_TEXT];
    const int count = level == CLI_LEVEL_OTSU ? 1 : 3;
    cwi_tell_missing(&volume->whole, s, missing);
    if (!cw_statistics_otsu(s, count, values))
        return cwi_fail(err, CW_ERR_EMPTY,
                        "%s: --iso %s: the values are too few to be parted into %d classes%s",
                        volume->path, cli_level_text(level, 0), count + 1, missing);
    *value = values[level == CLI_LEVEL_MEDIUM ? 1 : level == CLI_LEVEL_BRIGHT ? 2 : 0];
    return CW_OK;
}

static cw_status find_tissue(const cli_volume *volume, const cw_statistics *s, cli_level level,
                             double *value, cw_error *err)
{
    *value = cli_hounsfield_level(level);
    return cli_is_hounsfield(&volume->whole, s)
               ? CW_OK
               : cwi_fail(
                     err, CW_ERR_ARGUMENT,
                     "%s: --iso %s is for a CT in Hounsfield units; these values are %g to "
                     "%g, and %.2g %% of them near -1000, as air is. Give a number: "
                     "'cubewright info' suggests some",
                     volume->path, cli_level_text(level, 0), s->min, s->max,
                     100 * cli_share_between(s, -1100, -800));
}

static cw_status choose_level(const cli_volume *volume, const cw_statistics *s,
                              cli_level *level, double *value, cw_error *err)
{
    const char *name = cli_level_text(*level, *value);
    cw_status st = CW_OK;
    if (*level == CLI_LEVEL_NUMBER)
        return CW_OK;
    if (*level == CLI_LEVEL_PERCENT)
        *value = s->min + *value / 100 * (s->max - s->min);
    else if (*level < CLI_LEVEL_BONE)
        st = find_otsu(volume, s, *level, value, err);
    else
        st = find_tissue(volume, s, *level, value, err);
    *value = cli_round_level(*value);
    if (st == CW_OK)
        cli_say("%s: isovalue %s is %s%s", volume->path, name, cli_number_text(*value),
                *level < CLI_LEVEL_BONE ? "" : " HU");
    *level = CLI_LEVEL_NUMBER;
    return st;
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
