/* Commands that show a surface cut to pieces for a printer, before they are written. */
#include "cli/cut/cut_facts.h"
#include "cli/cut/cut_preview.h"
#include "cli/framework/console.h"
#include "cli/framework/option_rules.h"
#include "cli/session/verbs.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The name that pieces are written by, as the command is shown. */
static const char PIECES_NAME[] = "{stem}-{name}.stl";

enum { OWN_WORDS = 3 }; /* the mesh, -o and that name */

const cw_mesh *view_whole_mesh(const view *v)
{
    return v->document.pieces.are_shown ? &v->document.pieces.whole : &v->document.source.mesh;
}

void view_hide_pieces(view *v)
{
    view_pieces *p = &v->document.pieces;
    if (p->are_shown) {
        cw_mesh_free(&v->document.source.mesh);
        v->document.source.mesh = p->whole;
        if (v->picture.renderer)
            cw_renderer_forget(v->picture.renderer);
        view_touch(v, 1 << VIEW_SPACE);
    }
    free(p->command);
    free(p->settings);
    *p = (view_pieces){0};
}

static cw_status expect_surface(view *v, cw_error *err)
{
    cw_status st = view_need_open(v, err);
    if (st == CW_OK && view_shows_surfaces(v))
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "pieces are those of one surface; labels are shown: write one with "
                      "'extract --labels', and open it");
    return st == CW_OK ? view_need_whole(v, err) : st;
}

/* Parses options of the command cut. words: OWN_WORDS and options; inputs: as many */
static cw_status parse_cut(int count, char **words, cli_cut_args *args, const char **inputs,
                           cw_error *err)
{
    memcpy(args, cli_cut.defaults, sizeof *args);
    cw_status st = cli_parse(&cli_cut, count, words, args, inputs, err);
    return st == CW_OK ? cli_check_rules(&cli_cut, args, err) : st;
}

/* Returns words with a blank between each, as a shell reads them; NULL: no memory. */
static char *join_words(const char *first, int count, char **words)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (!out)
        return NULL;
    fputs(first, out);
    for (int n = 0; n < count; n++) {
        if (n || *first)
            fputc(' ', out);
        cli_put_word(out, words[n]);
    }
    return cwi_text_close(out, &text) ? text : NULL;
}

/* Puts the mesh of pieces in the place of the surface. */
static cw_status show_mesh(view *v, cw_mesh *preview, int count, char **words, cw_error *err)
{
    view_pieces *p = &v->document.pieces;
    char *command = join_words("cubewright cut", count, words);
    char *settings = join_words("", count - OWN_WORDS, words + OWN_WORDS);
    if (!command || !settings) {
        free(command);
        free(settings);
        cw_mesh_free(preview);
        return cwi_fail_memory(err);
    }
    view_hide_pieces(v);
    *p = (view_pieces){.are_shown = true,
                       .whole = v->document.source.mesh,
                       .command = command,
                       .settings = settings};
    v->document.source.mesh = *preview;
    if (v->picture.renderer)
        cw_renderer_forget(v->picture.renderer);
    return view_place_camera(v, "32,24", err); /* from a corner, where pegs are seen */
}

static void tell_pieces(view *v, const cw_pieces *cut)
{
    char text[VIEW_MESSAGE];
    size_t solids = 0;
    for (size_t n = 0; n < cut->count; n++)
        solids += !cut->pieces[n].is_dowel;
    int used =
        snprintf(text, sizeof text, "%zu pieces, sections %zu", solids, cut->section_count);
    if (cut->peg_count)
        used += snprintf(text + used, sizeof text - (size_t)used, ", %s %zu of %.3g mm",
                         cut->settings.dowels ? "dowels" : "pegs", cut->peg_count,
                         cut->settings.peg_diameter_mm);
    if (cut->missing)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "; %zu more pegs have no room", cut->missing);
    snprintf(text + used, sizeof text - (size_t)used,
             "; nothing is written yet: 'copy-pieces' copies the command that does");
    view_say(v, false, text);
}

static cw_status cut_surface(view *v, int count, char **words, const cli_cut_args *args,
                             cw_error *err)
{
    cli_cut_state state = {0};
    cw_mesh preview = {0};
    cli_mesh_run r = {
        .args = &args->mesh, .state = &state, .threads = (int)v->state.args.input.threads};
    r.mesh.path = words[0];
    r.mesh.mesh = *view_whole_mesh(v); /* borrowed */
    cw_status st = cli_cut_solid(&r, err);
    if (st == CW_OK)
        st = cli_make_cut_preview(&state.cut, state.planes, state.plane_count, &preview, err);
    if (st == CW_OK)
        st = show_mesh(v, &preview, count, words, err);
    if (st == CW_OK)
        tell_pieces(v, &state.cut);
    cli_free_cut(&state);
    return st;
}

static cw_status show_pieces(view *v, int count, char **options, cw_error *err)
{
    const size_t all = (size_t)count + OWN_WORDS;
    char **words = calloc(all, sizeof *words);
    const char **inputs = calloc(all, sizeof *inputs);
    cli_cut_args *args = calloc(1, sizeof *args);
    cw_status st = words && inputs && args ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        words[0] = v->document.source.is_mesh ? v->document.path : (char *)"MESH";
        words[1] = (char *)"-o";
        words[2] = (char *)PIECES_NAME;
        memcpy(words + OWN_WORDS, options, (size_t)count * sizeof *words);
        st = parse_cut((int)all, words, args, inputs, err);
    }
    if (st == CW_OK)
        st = cut_surface(v, (int)all, words, args, err);
    free(args);
    free(inputs);
    free(words);
    return st;
}

static cw_status run_pieces(view *v, int count, char **args, cw_error *err)
{
    cw_status st = expect_surface(v, err);
    if (st != CW_OK)
        return st;
    if (count != 1 || strcmp(args[0], "off") != 0)
        return show_pieces(v, count, args, err);
    if (!v->document.pieces.are_shown)
        return CW_OK;
    view_hide_pieces(v);
    return view_place_camera(v, NULL, err);
}

static cw_status run_copy_pieces(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    if (!v->document.pieces.are_shown)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "no pieces are shown: 'pieces --plate 220x220x250mm --pegs 2' does");
    v->ui->set_clipboard(v->window, v->document.pieces.command);
    view_say(v, false, v->document.pieces.command);
    return CW_OK;
}

static const view_verb rows[] = {
    VERB("pieces", "OPTIONS|off",
         "Show the surface cut to pieces, by options of 'cut': --plate 220x220x250mm --pegs 2",
         1, 64, run_pieces),
    VERB("copy-pieces", "", "Copy the command that writes these pieces", 0, 0, run_copy_pieces),
};
const view_verbs view_pieces_verbs = {rows, sizeof rows / sizeof *rows};
