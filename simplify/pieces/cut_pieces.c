/* Cuts a solid to pieces: each plane splits the pieces that it meets by an exact boolean with a half-space. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/pieces/pieces_state.h"

#include <cubewright/atlas.h>
#include <cubewright/boolean.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A vertex nearer to a plane than this fraction of the largest coordinate is in it, as in cw_mesh_cut(). */
static const double NEARNESS = 4e-7;

static const cw_attribute section_row = {.name = CW_SECTION_ATTRIBUTE,
                                         .on = CW_ON_TRIANGLES,
                                         .type = CW_U32,
                                         .components = 1,
                                         .interpolation = CW_INTERPOLATE_NEAREST};

const uint32_t *cwi_section_numbers(const cw_mesh *mesh)
{
    const cw_attribute *a = cw_mesh_attribute_find(mesh, CW_SECTION_ATTRIBUTE);
    return a && a->on == CW_ON_TRIANGLES && a->type == CW_U32 ? a->data : NULL;
}

/* --- one plane ---------------------------------------------------------------------------- */

/* Makes a tetrahedron that stands for the half-space above a plane: its base is in the plane, in one
 * triangle, so that it is flat whatever rounding does, and all of the mesh above the plane is inside. */
static cw_status make_half_space(const cwi_cutter *c, size_t plane, cw_mesh *out, cw_error *err)
{
    static const double base[3][2] = {
        {1, 0}, {-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386}};
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const cwi_cut_plane *p = &c->planes[plane];
    cw_attribute *row = NULL;
    cw_status st = cwi_mesh_alloc(out, 4, 4, false, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, c->mesh->origin, sizeof out->origin);
    memcpy(out->triangles, faces, sizeof faces);
    for (size_t n = 0; n < 4; n++) {
        double x[3];
        if (n < 3) {
            cwi_add_scaled(p->point, 2 * c->diagonal * base[n][0], p->u, x);
            cwi_add_scaled(x, 2 * c->diagonal * base[n][1], p->v, x);
        } else
            cwi_add_scaled(p->point, 4 * c->diagonal, p->normal, x);
        for (int k = 0; k < 3; k++)
            out->positions[3 * n + (size_t)k] = (float)x[k];
    }
    st = cw_mesh_attribute_add(out, &section_row, &row, err);
    if (st != CW_OK) {
        cw_mesh_free(out);
        return st;
    }
    for (size_t t = 0; t < 4; t++)
        ((uint32_t *)row->data)[t] = (uint32_t)plane + 1;
    return CW_OK;
}

/* Returns the sides of a plane on which a piece has vertices: 1 below, 2 above. */
static int find_sides(const cwi_cutter *c, const cwi_cut_plane *p, const cw_mesh *mesh)
{
    int sides = 0;
    for (size_t v = 0; v < mesh->vertex_count && sides != 3; v++) {
        double x[3];
        cwi_plane_local(p, mesh->positions + 3 * v, x);
        sides |= x[2] > c->tolerance ? 2 : x[2] < -c->tolerance ? 1 : 0;
    }
    return sides;
}

/* Gives the list one more piece, after the first `at`. */
static bool insert_piece(cwi_cutter *c, size_t at)
{
    cw_pieces *o = c->out;
    const size_t planes = c->plane_count ? c->plane_count : 1;
    if (o->count == c->capacity) {
        const size_t capacity = 2 * c->capacity + 8;
        cw_piece *pieces = cwi_realloc_array(o->pieces, capacity, sizeof *pieces);
        o->pieces = pieces ? pieces : o->pieces;
        bool *above =
            pieces ? cwi_realloc_array(c->above, capacity, planes * sizeof *above) : NULL;
        if (!above)
            return false;
        c->above = above;
        c->capacity = capacity;
    }
    memmove(o->pieces + at + 1, o->pieces + at, (o->count - at) * sizeof *o->pieces);
    memmove(c->above + (at + 1) * planes, c->above + at * planes,
            (o->count - at) * planes * sizeof *c->above);
    o->pieces[at] = (cw_piece){0};
    memset(c->above + at * planes, 0, planes * sizeof *c->above);
    o->count++;
    return true;
}

/* Splits piece n by a plane, if it is on both sides: what is above becomes the piece after it.
 * parts  set to the number of pieces that it is now, 0 to 2 */
static cw_status split_piece(cwi_cutter *c, size_t n, size_t plane, const cw_mesh *half_space,
                             const cw_progress *progress, size_t *parts, cw_error *err)
{
    cw_mesh out[2] = {{0}, {0}};
    cw_boolean_facts facts = {0};
    const cw_mesh *meshes[2] = {&c->out->pieces[n].mesh, half_space};
    const cw_boolean_desc desc = {
        .op = CW_BOOLEAN_SPLIT, .threads = c->out->settings.threads, .progress = *progress};
    cw_status st = cw_mesh_boolean(meshes, 2, &desc, out, &facts, err);
    if (st == CW_OK && out[1].triangle_count && !insert_piece(c, n + 1))
        st = cwi_fail_memory(err);
    if (st != CW_OK) {
        cw_mesh_free(&out[0]);
        cw_mesh_free(&out[1]);
        return st;
    }
    *parts = 1 + (out[1].triangle_count > 0);
    cw_mesh_free(&c->out->pieces[n].mesh);
    for (size_t k = 0; k < *parts; k++) {
        cw_mesh_attribute_remove(&out[k], "input");
        c->out->pieces[n + k].mesh = out[k];
        c->out->pieces[n + k].volume_mm3 = facts.volume_mm3[k];
    }
    if (*parts == 2) {
        bool *row = c->above + n * c->plane_count;
        memcpy(row + c->plane_count, row, c->plane_count * sizeof *row);
        row[c->plane_count + plane] = true;
    }
    return CW_OK;
}

static cw_status split_by_plane(cwi_cutter *c, size_t plane, const cw_progress *whole,
                                cw_error *err)
{
    cw_mesh half_space = {0};
    cw_status st = make_half_space(c, plane, &half_space, err);
    const size_t before = c->out->count;
    for (size_t n = 0, done = 0; n < c->out->count && st == CW_OK; done++) {
        const cwi_part_progress part = {whole, (double)done / (double)before,
                                        1.0 / (double)before};
        const cw_progress progress = cwi_progress_part(&part);
        const int sides = find_sides(c, &c->planes[plane], &c->out->pieces[n].mesh);
        size_t parts = 1;
        if (sides == 3)
            st = split_piece(c, n, plane, &half_space, &progress, &parts, err);
        else
            c->above[n * c->plane_count + plane] = sides == 2;
        n += parts;
    }
    cw_mesh_free(&half_space);
    return st;
}

/* --- all planes --------------------------------------------------------------------------- */

/* Unites what overlaps in the mesh: the one piece that planes then split. The result has no normals, and no
 * texture coordinates, as sections have none. */
static cw_status take_whole(cwi_cutter *c, const cw_progress *progress, cw_error *err)
{
    cw_mesh bare = *c->mesh;
    const cw_mesh *list = &bare;
    cw_boolean_facts facts = {0};
    bare.normals = NULL;
    if (!insert_piece(c, 0))
        return cwi_fail_memory(err);
    cw_piece *whole = c->out->pieces;
    const cw_boolean_desc desc = {.threads = c->out->settings.threads, .progress = *progress};
    const cw_status st = cw_mesh_boolean(&list, 1, &desc, &whole->mesh, &facts, err);
    if (st != CW_OK)
        return st;
    if (!whole->mesh.triangle_count)
        return cwi_fail(err, CW_ERR_EMPTY, "nothing to cut: the mesh encloses no volume");
    cw_mesh_attribute_remove(&whole->mesh, "input");
    cw_mesh_attribute_remove(&whole->mesh, CW_TEXTURE_COORDINATES);
    cw_mesh_attribute_remove(&whole->mesh, CW_SECTION_ATTRIBUTE);
    whole->volume_mm3 = c->out->whole_mm3 = facts.volume_mm3[0];
    return CW_OK;
}

static cw_status cut_by_planes(cwi_cutter *c, double fraction, cw_error *err)
{
    const cw_progress *all = &c->out->settings.progress;
    const double step = fraction / (double)(c->plane_count + 1);
    const cwi_part_progress first = {all, 0, step};
    const cw_progress progress = cwi_progress_part(&first);
    cw_status st = take_whole(c, &progress, err);
    for (size_t k = 0; k < c->plane_count && st == CW_OK; k++) {
        const cwi_part_progress part = {all, step * (double)(k + 1), step};
        const cw_progress one = cwi_progress_part(&part);
        st = split_by_plane(c, k, &one, err);
    }
    return st;
}

/* Names the pieces and sums them up. */
static void finish_pieces(cw_pieces *out)
{
    size_t solids = 0, dowels = 0;
    out->pieces_mm3 = 0;
    for (size_t n = 0; n < out->count; n++) {
        cw_piece *p = &out->pieces[n];
        snprintf(p->name, sizeof p->name, "%s-%zu", p->is_dowel ? "dowel" : "piece",
                 p->is_dowel ? ++dowels : ++solids);
        p->placed[0] = p->placed[5] = p->placed[10] = 1;
        out->pieces_mm3 += p->volume_mm3;
    }
    out->gaps_mm3 = out->peg_count ? out->whole_mm3 - out->pieces_mm3 : 0;
}

static cw_status check_settings(const cw_pieces_desc *d, size_t count, cw_error *err)
{
    const struct {
        const char *name;
        double value;
    } rows[] = {{"peg_diameter_mm", d->peg_diameter_mm},
                {"peg_length_mm", d->peg_length_mm},
                {"clearance_mm", d->clearance_mm},
                {"wall_mm", d->wall_mm},
                {"max_automatic_mm", d->max_automatic_mm}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        if (!(rows[n].value >= 0) || !isfinite(rows[n].value))
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; it must be 0 or more, and finite",
                            rows[n].name, rows[n].value);
    if (count > CW_MAX_CUT_PLANES)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%zu planes; up to %d can be cut by", count,
                        CW_MAX_CUT_PLANES);
    return CW_OK;
}

static cw_status begin(cwi_cutter *c, const cw_cut_desc *planes, size_t count, cw_error *err)
{
    double largest = 0;
    cw_status st = check_settings(&c->out->settings, count, err);
    if (st == CW_OK)
        st = cwi_mesh_check_size(c->mesh, "cut to pieces", err);
    if (st == CW_OK && !c->mesh->triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "nothing to cut: the mesh has no triangles");
    if (st != CW_OK)
        return st;
    cwi_box_clear(c->low, c->high);
    cwi_box_add_points(c->low, c->high, c->mesh->positions, c->mesh->vertex_count);
    c->diagonal = cwi_box_diagonal(c->low, c->high);
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, fmax(fabs(c->low[k]), fabs(c->high[k])));
    c->tolerance = NEARNESS * largest;
    return cwi_place_planes(c, planes, count, err);
}

cw_status cw_pieces_cut(const cw_mesh *mesh, const cw_cut_desc *planes, size_t count,
                        const cw_pieces_desc *desc, cw_pieces *out, cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    CWI_REQUIRE_ARRAY(err, planes, count);
    CWI_REQUIRE_VERSION(err, out, 0);
    CWI_REQUIRE_VERSION(err, desc, 0);
    *out = (cw_pieces){0};
    if (desc)
        out->settings = *desc;
    cwi_cutter c = {.mesh = mesh, .out = out};
    cw_status st = begin(&c, planes, count, err);
    if (st == CW_OK)
        st = cut_by_planes(&c, out->settings.pegs ? 0.6 : 1, err);
    if (st == CW_OK)
        st = cwi_find_sections(&c, err);
    if (st == CW_OK && out->settings.pegs && out->section_count)
        st = cwi_place_pegs(&c, err);
    if (st == CW_OK && out->peg_count)
        st = cwi_make_pegs(&c, err);
    cwi_free(c.planes);
    cwi_free(c.above);
    if (st != CW_OK) {
        cw_pieces_free(out);
        return st;
    }
    finish_pieces(out);
    out->settings.progress = (cw_progress){0};
    return CW_OK;
}

void cw_pieces_free(cw_pieces *p)
{
    if (!p)
        return;
    for (size_t n = 0; n < p->count; n++)
        cw_mesh_free(&p->pieces[n].mesh);
    cwi_free(p->pieces);
    cwi_free(p->sections);
    cwi_free(p->pegs);
    *p = (cw_pieces){0};
}
