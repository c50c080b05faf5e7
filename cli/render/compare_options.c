/* Parses --compare into the settings of two sides, and joins their pictures at a divider or
 * side by side with their difference. */
#define _GNU_SOURCE /* strdup, asprintf */
#include "cli/render/compare_options.h"

#include "cli/framework/option_rules.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_WORDS = 32 };

static bool is_mode(const char *word)
{
    for (int m = 0; m < CW_MODE_COUNT; m++)
        if (strcmp(cw_mode_name((cw_mode)m), word) == 0)
            return true;
    return false;
}

/* "step-length=2" as "--step-length=2", "reference" as "--mode=reference". */
static cw_status add_word(char **words, int *count, const char *item, cw_error *err)
{
    char name[32];
    const size_t length = strcspn(item, "=");
    snprintf(name, sizeof name, "%.*s", (int)length, item);
    const char *bare = strncmp(name, "no-", 3) == 0 ? name + 3 : name;
    const bool mode = *count == 0 && is_mode(item);
    if (!mode && !cli_is_setting(bare))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--compare: '%s' is neither a mode nor an option of pictures, such as "
                        "step-length=2 or no-lit",
                        item);
    if (*count == MAX_WORDS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--compare: at most %d settings a side",
                        MAX_WORDS);
    if (asprintf(&words[*count], "--%s%s", mode ? "mode=" : "", item) < 0)
        return cwi_fail_memory(err);
    ++*count;
    return CW_OK;
}

/* Over the arguments of the run; it keeps what was given on this side alone. */
static cw_status parse_side(const cli_command *command, const render_args *args,
                            const char *text, size_t length, cli_side *side, cw_error *err)
{
    const char *nothing[MAX_WORDS + 2] = {0};
    char *copy = strndup(text, length), *next = copy;
    cw_status st = copy ? CW_OK : cwi_fail_memory(err);
    while (st == CW_OK && next) {
        const char *item = strsep(&next, ",");
        st = add_word(side->words, &side->word_count, item, err);
    }
    free(copy);
    side->args = *args;
    memset(side->args.common.given, 0, sizeof side->args.common.given);
    side->args.common.input_count = 0;
    cli_command bare = *command; /* without inputs, which are there */
    bare.min_inputs = 0;
    if (st == CW_OK)
        st = cli_parse(&bare, side->word_count, side->words, &side->args, nothing, err);
    if (st == CW_OK)
        st = cli_check_rules(&bare, &side->args, err);
    /* options are looked up by where their row stands, which both tables share */
    side->args.common.inputs = args->common.inputs;
    side->args.common.input_count = args->common.input_count;
    side->mode =
        side->args.scene.mode ? (cw_mode)(side->args.scene.mode - 1) : CW_MODE_COMPOSITE;
    if (st == CW_OK && side->mode == CW_MODE_MESH)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--compare is for the modes of volumes");
    return st;
}

/* Makes the reference beside an intensity projection that of the same projection, with its
 * threshold and its transfer function, unless it has its own. */
static void match_reference(cli_side *reference, const cli_side *other)
{
    cli_scene *s = &reference->args.scene;
    if (reference->mode != CW_MODE_REFERENCE || !cw_mode_is_intensity(other->mode))
        return;
    s->reference_of = other->mode;
    s->threshold = other->args.scene.threshold;
    s->minip_inside = other->args.scene.minip_inside;
    s->transfer = s->transfer ? s->transfer : other->args.scene.transfer;
}

bool cli_compares_alike(const cli_split *split)
{
    const cw_mode a = split->sides[0].mode, b = split->sides[1].mode;
    const bool has_reference = a == CW_MODE_REFERENCE || b == CW_MODE_REFERENCE;
    const bool is_single = cw_mode_is_intensity(a) || cw_mode_is_intensity(b);
    const bool is_sliced = a == CW_MODE_SLICES || b == CW_MODE_SLICES;
    return a == b || (!is_sliced && (!is_single || has_reference));
}

cw_status cli_parse_split(const cli_command *command, const render_args *args, cli_split *split,
                          cw_error *err)
{
    const char *text = args->compare, *bar = strchr(text, '|');
    const bool has_mesh = args->iso.given || args->mesh;
    if (!bar || strchr(bar + 1, '|'))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--compare '%s': two sides were expected, such as "
                        "'texture,step-length=2|reference'",
                        text);
    cw_status st = parse_side(command, args, text, (size_t)(bar - text), &split->sides[0], err);
    if (st == CW_OK)
        st = parse_side(command, args, bar + 1, strlen(bar + 1), &split->sides[1], err);
    for (int n = 0; n < 2 && st == CW_OK; n++)
        st = cli_check_scene(command, &split->sides[n].args.common, split->sides[n].mode,
                             has_mesh, err);
    if (st == CW_OK &&
        cli_check_scene(command, &args->common, split->sides[0].mode, has_mesh, NULL) != CW_OK)
        st = cli_check_scene(command, &args->common, split->sides[1].mode, has_mesh, err);
    for (int n = 0; n < 2; n++)
        match_reference(&split->sides[n], &split->sides[1 - n]);
    return st;
}

void cli_free_split(cli_split *split)
{
    for (int n = 0; n < 2; n++)
        for (int w = 0; w < split->sides[n].word_count; w++)
            free(split->sides[n].words[w]);
    *split = (cli_split){0};
}

/* One beside the other. */
static cw_status join_pictures(const cw_picture *const *parts, size_t count, cw_picture *out,
                               cw_error *err)
{
    const size_t w = parts[0]->width, h = parts[0]->height;
    cw_status st = cw_picture_alloc(out, count * w, h, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        for (size_t y = 0; y < h; y++)
            memcpy(out->pixels + 4 * (y * count * w + n * w), parts[n]->pixels + 4 * y * w,
                   4 * w * sizeof *out->pixels);
    return st;
}

cw_status cli_draw_split(const cw_picture sides[2], const render_args *args,
                         const uint8_t background[2][4], cw_comparison *measured,
                         cw_picture *out, cw_error *err)
{
    float under[2][3];
    cw_picture difference = {0};
    for (int n = 0; n < 2; n++)
        for (int c = 0; c < 3; c++)
            under[n][c] = (float)background[n][c] / 255;
    cw_status st =
        cw_picture_compare(&sides[0], &sides[1], (const float(*)[3])under, measured, err);
    if (st == CW_OK && !args->difference.given)
        return cw_picture_split(&sides[0], &sides[1], 0.5, out, err);
    if (st == CW_OK)
        st = cw_picture_difference(&sides[0], &sides[1], args->difference.value, &difference,
                                   err);
    if (st == CW_OK)
        st = join_pictures((const cw_picture *const[]){&sides[0], &sides[1], &difference}, 3,
                           out, err);
    cw_picture_free(&difference);
    return st;
}
