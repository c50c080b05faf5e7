/* The part of a volume on which is tried what would take too long on all of it: as large as may
 * be, where the surface is. */
#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/study/study.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>

/* Triangles that are simplified and compressed a dozen times within a minute. */
enum { MIN_TRIANGLES = 20000, MAX_TRIANGLES = 160000, MAX_DIVISIONS = 6 };

static cw_extract_desc desc_of(const cli_study *s)
{
    return (cw_extract_desc){.isovalue = s->iso,
                             .inside_is_low = s->inside_is_low,
                             .leave_open = s->is_field,
                             .threads = s->threads};
}

/* One of the boxes of 1/by of each side, on a lattice of half their size. */
static cw_box box_at(const cw_volume *v, size_t by, size_t number)
{
    const size_t steps = 2 * by - 1;
    cw_box box;
    for (int a = 0; a < 3; a++) {
        box.count[a] = v->dim[a] / by;
        box.first[a] = number % steps * box.count[a] / 2;
        number /= steps;
    }
    return box;
}

static void find_middle(const cw_volume *v, double at[3])
{
    double index[3];
    for (int a = 0; a < 3; a++)
        index[a] = 0.5 * (double)(v->dim[a] - 1);
    cw_volume_to_world(v, index, at);
}

/* How far to the back a box is, in the patient's frame, and from the middle of what is seen. */
static double depth_of(const cw_volume *whole, const cw_volume *part)
{
    double middle[3], at[3];
    find_middle(whole, middle);
    find_middle(part, at);
    return at[1] - middle[1] + 0.5 * (fabs(at[0] - middle[0]) + fabs(at[2] - middle[2]));
}

/* Of the boxes that have enough of the surface, within the limit, the one in front, where
 * pictures are taken from; false: there is none. */
static bool find_box(const cli_study *s, const cw_volume *v, size_t by, cw_box *best)
{
    const cw_extract_desc desc = desc_of(s);
    const size_t boxes = (2 * by - 1) * (2 * by - 1) * (2 * by - 1);
    double min = INFINITY;
    for (size_t n = 0; n < boxes; n++) {
        const cw_box box = box_at(v, by, n);
        cw_volume part;
        cw_extract_counts counts;
        if (cw_volume_crop(v, &box, &part, NULL) != CW_OK ||
            cw_extract_predict(&part, &desc, &counts, NULL) != CW_OK)
            return false;
        if (counts.triangles > MAX_TRIANGLES || counts.triangles < MIN_TRIANGLES ||
            !(depth_of(v, &part) < min))
            continue;
        min = depth_of(v, &part);
        *best = box;
    }
    return isfinite(min);
}

/* In voxels of the file, as --crop counts them. */
static void tell_part(cli_study *s, const cw_box *box)
{
    const size_t *f = box->first, *n = box->count, by = s->coarsen;
    snprintf(s->part_words, sizeof s->part_words, " --crop %zu:%zu,%zu:%zu,%zu:%zu", f[0] * by,
             (f[0] + n[0] - 1) * by, f[1] * by, (f[1] + n[1] - 1) * by, f[2] * by,
             (f[2] + n[2] - 1) * by);
}

/* The plain surface of the box: what simplified ones of it are to be compared with. */
static cw_status draw_part(cli_study *s, cw_error *err)
{
    const cw_mesh *mesh = &s->part_mesh;
    float *worst = cwi_alloc_zeroed(mesh->vertex_count, sizeof *worst);
    const cw_field_distance_desc desc = {
        .isovalue = s->iso,
        .inside_is_low = s->inside_is_low,
        .leave_open = s->is_field,
        .worst = worst,
        .threads = s->threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cw_distance d;
    if (!worst)
        return cwi_fail_memory(err);
    cw_status st = cw_distance_to_field(mesh, &s->part.view, &desc, &d, NULL, err);
    if (st == CW_OK)
        st = cli_draw_mesh(s, mesh, mesh, worst, &s->part_drawn, err);
    cwi_free(worst);
    return st;
}

cw_status cli_need_part(cli_study *s, cw_error *err)
{
    const cw_volume *v = &s->volume->view;
    const cw_extract_desc desc = desc_of(s);
    cw_box box;
    if (s->part_chosen)
        return CW_OK;
    s->part_chosen = true;
    s->part = *s->volume;
    if (s->full.triangle_count <= MAX_TRIANGLES || s->is_cropped || v->cells || v->sparse ||
        v->coordinates[0])
        return CW_OK;
    size_t by = 2;
    while (by <= MAX_DIVISIONS && !find_box(s, v, by, &box))
        by++;
    if (by > MAX_DIVISIONS)
        return CW_OK;
    cw_status st = cw_volume_crop(v, &box, &s->part.view, err);
    if (st == CW_OK)
        st = cli_extract_surface(&s->part, &desc, &s->part_mesh, NULL, err);
    if (st != CW_OK) {
        s->part = *s->volume;
        return st;
    }
    tell_part(s, &box);
    return draw_part(s, err);
}

const cw_mesh *cli_part_mesh(const cli_study *s)
{
    return s->part_mesh.triangle_count ? &s->part_mesh : &s->full;
}

static double find_longest_side(const cw_mesh *mesh)
{
    double low[3], high[3];
    return cw_mesh_bounds(mesh, low, high)
               ? fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]))
               : 0;
}

double cli_part_ratio(const cli_study *s)
{
    const double part = find_longest_side(cli_part_mesh(s));
    return part > 0 ? find_longest_side(&s->full) / part : 1;
}
