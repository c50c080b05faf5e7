/* Welds, measures, filters, closes and compares the parts of a mesh piece by piece. */
#include "cli/results/mesh_parts.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/stage_facts.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>
#include <stdlib.h>

static cw_status in_file(const cli_pieces *p, cw_status st, cw_error *err)
{
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, p->path);
}

static void measure_box(cli_pieces *p)
{
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t n = 0; n < p->count; n++) {
        double from[3], to[3];
        cw_mesh_bounds(&p->piece[n].input, from, to);
        cwi_box_join(low, high, from, to);
    }
    p->diagonal_mm = cwi_box_diagonal(low, high);
}

cw_status cli_take_surface(cli_pieces *p, const char *path, const cw_mesh *mesh, cw_error *err)
{
    *p = (cli_pieces){.path = path, .piece = calloc(1, sizeof *p->piece)};
    if (!p->piece)
        return cwi_fail_memory(err);
    p->piece->input = *mesh;
    p->count = 1;
    p->triangles = mesh->triangle_count;
    measure_box(p);
    return CW_OK;
}

/* Makes pieces of the parts that have triangles, welded or not. */
static cw_status take_parts(cli_pieces *p, const cli_mesh *m, bool weld, cw_error *err)
{
    const size_t count = m->parts ? m->part_count : 1;
    cw_status st = CW_OK;
    *p = (cli_pieces){.path = m->path};
    p->piece = calloc(count ? count : 1, sizeof *p->piece);
    if (!p->piece)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        size_t merged = 0;
        cli_piece *piece = &p->piece[p->count];
        *piece = (cli_piece){.input = m->parts ? *m->parts[n].mesh : m->mesh,
                             .name = m->parts ? m->parts[n].name : NULL,
                             .label = m->parts ? m->parts[n].label : NULL,
                             .textures = m->parts ? m->parts[n].textures : m->textures};
        if (weld)
            st = cw_mesh_weld(&piece->input, &merged, err);
        p->merged += merged;
        p->triangles += piece->input.triangle_count;
        p->count += st == CW_OK && piece->input.triangle_count > 0;
    }
    return st;
}

/* Measures the box of pieces, of which there must be some. */
static cw_status finish_pieces(cli_pieces *p, cw_status st, cw_error *err)
{
    if (st == CW_OK && !p->count)
        st = cwi_fail(err, CW_ERR_EMPTY, "it has no triangles");
    if (st == CW_OK)
        measure_box(p);
    return in_file(p, st, err);
}

cw_status cli_take_pieces(cli_pieces *p, const cli_mesh *mesh, cw_error *err)
{
    return finish_pieces(p, take_parts(p, mesh, false, err), err);
}

cw_status cli_weld_pieces(cli_pieces *p, const cli_mesh *mesh, cw_error *err)
{
    cw_status st = take_parts(p, mesh, true, err);
    if (st == CW_OK && p->merged)
        cli_say("%s: %s vertices at the position of another were merged", p->path,
                cli_count(p->merged));
    return finish_pieces(p, st, err);
}

cw_status cli_drop_from_pieces(cli_pieces *p, double diagonal_mm, cw_error *err)
{
    const size_t count = p->count;
    size_t all_kept = 0;
    cw_status st = CW_OK;
    p->count = 0;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        size_t dropped = 0, kept = 0;
        cli_piece *piece = &p->piece[p->count];
        *piece = p->piece[n];
        st = cw_mesh_drop_components(&piece->input, diagonal_mm, &dropped, &kept, err);
        p->dropped += dropped;
        all_kept += kept;
        p->count += kept > 0;
    }
    if (st == CW_OK && !p->count)
        st = cwi_fail(err, CW_ERR_EMPTY,
                      "no component has a diagonal of %.6g mm: nothing is left", diagonal_mm);
    if (st == CW_OK)
        cli_say("%s: %s component%s kept, %s dropped (< %.6g mm)", p->path, cli_count(all_kept),
                all_kept == 1 ? "" : "s", cli_count(p->dropped), diagonal_mm);
    return in_file(p, st, err);
}

static void add_handles(cw_close_handles_facts *sum, const cw_close_handles_facts *f)
{
    sum->genus_before += f->genus_before;
    sum->genus_after += f->genus_after;
    sum->cut += f->cut;
    sum->filled += f->filled;
    sum->left_long += f->left_long;
    sum->left_crossing += f->left_crossing;
    sum->change_mm = fmax(sum->change_mm, f->change_mm);
}

static cw_status close_piece(cli_piece *piece, const cw_close_handles_desc *desc,
                             cw_close_handles_facts *facts, cw_error *err)
{
    cw_mesh closed;
    const cw_status st = cw_mesh_close_handles(&piece->input, desc, &closed, facts, err);
    if (st != CW_OK)
        return st;
    piece->input = closed;
    piece->owns_input = true;
    return CW_OK;
}

cw_status cli_close_handles(cli_pieces *p, double length_mm, int threads,
                            cw_close_handles_facts *facts, cw_error *err)
{
    const cw_close_handles_desc desc = {
        .length_mm = length_mm > 0 ? length_mm : CW_HANDLE_FRACTION * p->diagonal_mm,
        .threads = threads,
        .progress = cli_progress((double)p->triangles / 1e6, "Mtriangle")};
    char text[CLI_HANDLES_TEXT];
    cw_status st = CW_OK;
    *facts = (cw_close_handles_facts){.length_mm = desc.length_mm};
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_close_handles_facts found = {0};
        st = close_piece(&p->piece[n], &desc, &found, err);
        add_handles(facts, &found);
    }
    if (st != CW_OK)
        return in_file(p, st, err);
    p->closed_mm = desc.length_mm;
    cli_handles_text(facts, text);
    cli_say("%s: %s", p->path, text);
    return CW_OK;
}

size_t cli_count_handles(const cli_pieces *p)
{
    size_t handles = 0;
    for (size_t n = 0; n < p->count; n++)
        handles += p->piece[n].before.genus > 0 ? (size_t)p->piece[n].before.genus : 0;
    return handles;
}

cw_status cli_measure_pieces(cli_pieces *p, int threads, cw_error *err)
{
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .threads = threads};
    cw_status st = CW_OK;
    p->triangles = 0;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        st = cw_quality_measure(&p->piece[n].input, &desc, &p->piece[n].before, err);
        p->triangles += p->piece[n].input.triangle_count;
    }
    return in_file(p, st, err);
}

cw_status cli_hold_pieces(const cli_pieces *p, int threads, cw_error *err)
{
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .threads = threads};
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_quality after;
        st = cw_quality_measure(&p->piece[n].out, &desc, &after, err);
        if (st == CW_OK)
            st = cw_quality_compare(&p->piece[n].before, &after, err);
        if (st == CW_ERR_CHECK)
            st = cwi_fail_in(err, st, "not as promised");
    }
    return in_file(p, st, err);
}

/* Measures how far the texture of a piece moved, where both sides have one. */
static cw_status compare_texture(const cli_piece *piece, int threads, cli_comparison *c,
                                 cw_error *err)
{
    cw_texture_distance d, *sum = &c->texture;
    if (!cw_mesh_attribute_find(&piece->out, CW_TEXTURE_COORDINATES) ||
        !cw_mesh_attribute_find(&piece->input, CW_TEXTURE_COORDINATES))
        return CW_OK;
    cw_status st = cw_mesh_texture_distance(&piece->out, &piece->input, threads, &d, err);
    if (st != CW_OK)
        return st == CW_ERR_EMPTY || st == CW_ERR_ARGUMENT ? CW_OK : st;
    const size_t samples = sum->samples + d.samples;
    sum->mean_mm += (d.mean_mm - sum->mean_mm) * (double)d.samples / (double)samples;
    if (!c->has_texture || d.max_mm > sum->max_mm) {
        sum->max_mm = d.max_mm;
        sum->side_mm = d.side_mm;
    }
    sum->samples = samples;
    c->has_texture = true;
    return CW_OK;
}

cw_status cli_compare_pieces(const cli_pieces *p, int threads, cli_comparison *c, cw_error *err)
{
    cw_status st = CW_OK;
    c->diagonal_mm = p->diagonal_mm;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        st = cli_compare(&p->piece[n].out, &p->piece[n].input, c->promised_mm / 100, threads, c,
                         err);
        if (st == CW_OK)
            st = compare_texture(&p->piece[n], threads, c, err);
    }
    const double max = cw_mesh_comparison_max(&c->with_input);
    if (st == CW_OK && c->promised_mm > 0 && max > c->promised_mm)
        st = cwi_fail(err, CW_ERR_CHECK,
                      "not as promised: %.6g mm from the input, not %.6g; nothing is written",
                      max, c->promised_mm);
    return in_file(p, st, err);
}

/* Returns the mean side of the voxels from which a mesh came; 0: the file does not tell. */
static double find_voxel_side(const cw_mesh *mesh)
{
    double product = 1;
    for (int k = 0; k < 3; k++)
        product *= hypot(hypot(mesh->affine[0][k], mesh->affine[1][k]), mesh->affine[2][k]);
    return cbrt(product);
}

cw_status cli_find_length(const cli_pieces *p, const char *option, const cli_length *length,
                          double *mm, cw_error *err)
{
    const double voxel_mm = find_voxel_side(&p->piece->input);
    if (length->given && length->unit == CLI_VOXELS && !(voxel_mm > 0))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s: %s: the file tells no voxels; give mm, or %% of its box's diagonal", p->path,
            option);
    *mm = length->given ? cli_length_mm(length, p->diagonal_mm, voxel_mm) : 0;
    return CW_OK;
}

cw_status cli_list_parts(const cli_pieces *p, cw_part **parts, cw_error *err)
{
    *parts = calloc(p->count, sizeof **parts);
    if (!*parts)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < p->count; n++)
        (*parts)[n] = (cw_part){.mesh = &p->piece[n].out,
                                .name = p->piece[n].name,
                                .label = p->piece[n].label,
                                .textures = p->textures ? p->textures : p->piece[n].textures};
    return CW_OK;
}

void cli_free_pieces(cli_pieces *p)
{
    for (size_t n = 0; n < p->count; n++) {
        cw_mesh_free(&p->piece[n].out);
        if (p->piece[n].owns_input)
            cw_mesh_free(&p->piece[n].input);
    }
    free(p->piece);
    *p = (cli_pieces){0};
}
