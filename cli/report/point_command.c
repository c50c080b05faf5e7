/* The command that does what a point does, to be copied. */
#include "cli/report/point_command.h"
#include "cli/framework/quantity.h"
#include "cli/results/compress_options.h"
#include "core/base/text.h"

#include <stdlib.h>
#include <string.h>

static bool is_plain(const char *word)
{
    return *word && word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                      "0123456789._/,:=+@%-")] == '\0';
}

void cli_put_word(FILE *out, const char *word)
{
    if (is_plain(word)) {
        fputs(word, out);
        return;
    }
    fputc('\'', out);
    for (; *word; word++)
        if (*word == '\'')
            fputs("'\\''", out);
        else
            fputc(*word, out);
    fputc('\'', out);
}

static void put_extract(FILE *out, const cli_study *s, const cli_point *p)
{
    const cli_tried *t = &p->tried;
    const size_t coarsen = s->coarsen * (t->coarsen ? t->coarsen : 1);
    fprintf(out, "cubewright extract %s --iso %s", s->input_words, cli_number_text(s->iso));
    if (p->family != CLI_EXTRACTION)
        fputs(s->part_words, out);
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
    if (t->share > 0)
        fprintf(out, " --simplify %zu", cli_share_of(s, t->share));
    if (t->compression)
        fprintf(out, " --compress %s --bits %d", cli_compression_name(t->compression), t->bits);
    fprintf(out, " -o mesh%s", s->suffix);
}

static void put_render(FILE *out, const cli_study *s, const cli_point *p)
{
    const cli_scene *scene = &p->tried.scene;
    fprintf(out, "cubewright render %s --mode %s --no-lit", s->input_words,
            cw_mode_name(p->tried.mode));
    if (scene->step.given)
        fprintf(out, " --step-length %g", scene->step.value);
    if (scene->tree_error.given)
        fprintf(out, " --tree-error %g", scene->tree_error.value);
    if (scene->slices)
        fprintf(out, " --slices %zu", scene->slices);
    fprintf(out, " --size %dx%d -o picture.png", CLI_STUDY_WIDTH, CLI_STUDY_HEIGHT);
}

char *cli_point_command(const cli_study *s, const cli_point *p)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (out && p->family == CLI_RENDERING)
        put_render(out, s, p);
    else if (out)
        put_extract(out, s, p);
    return cwi_text_close(out, &text) ? text : NULL;
}
