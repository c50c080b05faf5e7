/* Measures a simplified surface against the full one, and the surface of a cropped volume
 * against that of the whole volume. */
#include "cli/extract/extract_proof.h"

#include "cli/framework/console.h"
#include "cli/results/mesh_comparison.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/mesh/mesh_triangle.h"

#include <float.h>
#include <math.h>

cw_status cli_extract_full(const cli_volume *volume, const cli_surface_settings *settings,
                           cli_proof *proof, cw_mesh *full, cw_error *err)
{
    const cw_pipeline_desc desc = cli_describe_full(settings);
    cw_pipeline_facts facts = {0};
    const double start = cli_seconds();
    cw_status st = cli_make_surface(volume, NULL, &desc, full, &facts, err);
    if (st != CW_OK)
        return st;
    proof->made = true;
    proof->full_seconds = cli_seconds() - start;
    proof->full_bytes = facts.extracted.bytes;
    proof->full_triangles = full->triangle_count;
    return CW_OK;
}

static double diagonal_of(const cw_mesh *mesh)
{
    double low[3], high[3];
    cw_mesh_bounds(mesh, low, high);
    return cwi_box_diagonal(low, high);
}

/* The mesh's distance from the field says little without that of the full surface, which the
 * extractor leaves between the samples. */
static cw_status measure_full(const cli_volume *volume, const cw_extract_desc *d,
                              const cw_mesh *full, cli_comparison *compared, cw_error *err)
{
    cli_comparison c = {0};
    cw_status st = cli_compare_with_field(full, volume, d->isovalue, d->inside_is_low,
                                          d->threads, &c, err);
    compared->has_full_field = st == CW_OK;
    compared->full_to_field = c.to_field;
    return st;
}

cw_status cli_prove_error(const cli_volume *volume, const cli_surface_settings *settings,
                          const cw_mesh *mesh, cli_proof *proof, cli_comparison *compared,
                          cw_error *err)
{
    const double promised = settings->simplify.error_mm;
    cw_mesh full;
    cw_status st = cli_extract_full(volume, settings, proof, &full, err);
    if (st != CW_OK)
        return st;
    compared->promised_mm = proof->promised_mm = promised;
    compared->diagonal_mm = diagonal_of(&full);
    compared->other = "the full surface";
    st = cli_compare(mesh, &full, promised / 20, settings->simplify.threads, compared, err);
    if (st == CW_OK && compared->has_field)
        st = measure_full(volume, &settings->desc.extract, &full, compared, err);
    cw_mesh_free(&full);
    if (st != CW_OK)
        return cwi_fail_in(err, st, volume->path);
    proof->mm = cw_mesh_comparison_max(&compared->with_input);
    if (proof->mm <= promised || promised == 0)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_CHECK,
        "%s: not as promised: %.6g mm from the full surface, not %.6g; nothing is written",
        volume->path, proof->mm, promised);
}

/* --- a part of the volume ----------------------------------------------------------------- */

/* Whether a triangle lies in the cells of a volume. */
static cw_status is_inside(const cw_volume *v, const cw_mesh *m, size_t triangle, bool *inside,
                           cw_error *err)
{
    double middle[3] = {0, 0, 0}, index[3];
    for (size_t k = 0; k < 3; k++) {
        double world[3];
        cwi_mesh_world(m, m->triangles[3 * triangle + k], world);
        for (int a = 0; a < 3; a++)
            middle[a] += world[a] / 3;
    }
    cw_status st = cw_volume_to_index(v, middle, index, err);
    *inside = true;
    for (int a = 0; a < 3; a++)
        *inside = *inside && index[a] >= 0 && index[a] <= (double)(v->dim[a] - 1);
    return st;
}

/* Both come row by row, so that what is left of the whole is in the part's order. */
static cw_status compare_parts(const cw_volume *v, const cw_mesh *part, const cw_mesh *whole,
                               cli_crop_proof *proof, cw_error *err)
{
    size_t next = 0;
    for (size_t t = 0; t < whole->triangle_count; t++) {
        bool inside;
        cw_status st = is_inside(v, whole, t, &inside, err);
        if (st != CW_OK)
            return st;
        for (size_t k = 0; k < 3 && inside && next < part->triangle_count; k++) {
            double p[3], q[3];
            cwi_mesh_world(part, part->triangles[3 * next + k], p);
            cwi_mesh_world(whole, whole->triangles[3 * t + k], q);
            const double apart = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
            proof->apart_mm = fmax(proof->apart_mm, apart);
        }
        next += inside;
    }
    if (next != part->triangle_count)
        return cwi_fail(err, CW_ERR_CHECK,
                        "not as promised: %zu triangles, and %zu of the whole surface there",
                        part->triangle_count, next);
    return CW_OK;
}

/* Single precision may round places about another origin otherwise. */
static double rounding_of(const cw_mesh *part, const cw_mesh *whole)
{
    return 4 * FLT_EPSILON * (diagonal_of(part) + diagonal_of(whole));
}

static cw_status extract_open(const cli_volume *volume, const cw_extract_desc *extract,
                              cw_mesh *mesh, size_t *bytes, double *seconds, cw_error *err)
{
    cw_extract_desc desc = *extract;
    cw_extract_counts counts = {0};
    const double start = cli_seconds();
    desc.leave_open = true;
    desc.no_normals = true;
    cw_status st = cli_extract_surface(volume, &desc, mesh, &counts, err);
    *bytes += counts.bytes;
    *seconds += cli_seconds() - start;
    return st;
}

static size_t voxels_of(const cw_volume *v)
{
    return v->dim[0] * v->dim[1] * v->dim[2];
}

cw_status cli_prove_crop(const cli_volume *part, const cli_input *input,
                         const cw_extract_desc *extract, cli_crop_proof *proof, cw_error *err)
{
    cli_volume whole;
    cw_mesh some = {0}, all = {0};
    const size_t voxel = cw_type_size(part->view.type);
    *proof = (cli_crop_proof){.made = true, .voxels = voxels_of(&part->view)};
    proof->bytes = proof->voxels * voxel;
    cw_status st = cli_read_whole(part, input, &whole, err);
    proof->whole_voxels = st == CW_OK ? voxels_of(&whole.view) : 0;
    proof->whole_bytes = proof->whole_voxels * voxel;
    if (st == CW_OK)
        st = extract_open(part, extract, &some, &proof->bytes, &proof->seconds, err);
    if (st == CW_OK)
        st = extract_open(&whole, extract, &all, &proof->whole_bytes, &proof->whole_seconds,
                          err);
    proof->triangles = some.triangle_count;
    proof->whole_triangles = all.triangle_count;
    if (st == CW_OK) {
        st = compare_parts(&part->view, &some, &all, proof, err);
        if (st == CW_OK && proof->apart_mm > rounding_of(&some, &all))
            st = cwi_fail(
                err, CW_ERR_CHECK,
                "not as promised: a vertex is %.4g mm from where the whole surface has it",
                proof->apart_mm);
        st = st == CW_OK ? st : cwi_fail_in(err, st, part->path);
    }
    cw_mesh_free(&some);
    cw_mesh_free(&all);
    cli_free_volume(&whole);
    return st;
}
