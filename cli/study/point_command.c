/* The command that does what a point does, to be copied: of the whole object, also where a part
 * of it was tried to save time. */
#include "cli/study/point_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/compress_options.h"
#include "core/base/text.h"

#include <stdlib.h>
#include <string.h>

static void put_extract(FILE *out, const cli_study *s, const cli_tried *t, const char *output)
{
    const size_t coarsen = s->coarsen * (t->coarsen ? t->coarsen : 1);
    fprintf(out, "cubewright extract %s --iso %s", s->input_words, cli_number_text(s->iso));
    if (s->inside_is_low)
        fputs(" --inside below", out);
    if (s->is_field)
        fputs(" --open", out);
    if (coarsen > 1)
        fprintf(out, " --coarsen %zu", coarsen);
    if (t->cubic)
        fputs(" --placement cubic", out);
    if (t->snap > 0)
        fprintf(out, " --snap %g", t->snap);
    if (t->error_vox > 0)
        fprintf(out, " --simplify %gvox", t->error_vox);
    if (t->fraction > 0)
        fprintf(out, " --simplify %zu", cli_share_of(&s->full, t->fraction));
    if (t->compression)
        fprintf(out, " --compress %s --bits %d", cli_compression_name(t->compression), t->bits);
    fprintf(out, " -o %s", output);
}

char *cli_settings_command(const cli_study *s, const cli_tried *tried, const char *output)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        put_extract(out, s, tried, output);
    return cwi_text_close(out, &text) ? text : NULL;
}

static void put_render(FILE *out, const cli_study *s, const cli_point *p)
{
    const cli_scene *scene = &p->tried.scene;
    fprintf(out, "cubewright render %s --mode %s", s->input_words, cw_mode_name(p->tried.mode));
    if (p->family == CLI_RENDERING)
        fputs(" --no-lit", out);
    if (scene->step.given)
        fprintf(out, " --step-length %g", scene->step.value);
    if (scene->tree_error.given)
        fprintf(out, " --tree-error %g", scene->tree_error.value);
    if (scene->slices)
        fprintf(out, " --slices %zu", scene->slices);
    if (scene->target)
        fprintf(out, " --target %s", scene->target == CW_TARGET_8 ? "8" : "16f");
    fprintf(out, " --camera front --size %dx%d -o picture.png", CLI_STUDY_WIDTH,
            CLI_STUDY_HEIGHT);
}

char *cli_point_command(const cli_study *s, const cli_point *p)
{
    char *text, name[32];
    size_t size;
    FILE *out;
    if (!cli_is_drawn(p->family)) {
        snprintf(name, sizeof name, "mesh%s", s->suffix);
        return cli_settings_command(s, &p->tried, name);
    }
    out = cwi_text_open(&text, &size);
    if (out)
        put_render(out, s, p);
    return cwi_text_close(out, &text) ? text : NULL;
}
