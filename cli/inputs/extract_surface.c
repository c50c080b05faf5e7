/* Extracts the surface of a volume that was read, whole or simplified slab by slab, within
 * the memory that is left. */
#include "cli/inputs/extract_surface.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"

#include <cubewright/quality.h>

/* A closed surface has half as many vertices as triangles. It is written at the same time: what
 * the file loses takes LOSS_BYTES a vertex. */
size_t cli_check_bytes(void)
{
    enum { LOSS_BYTES = 28 };
    return cw_quality_bytes(500, 1000) / 1000 + 1 + LOSS_BYTES / 2;
}

size_t cli_slices_bytes(const cw_volume *shape, const cw_stream_desc *desc, size_t taken)
{
    return taken + CLI_BESIDE_SLICES + cw_extract_stream_bytes(shape, desc, true);
}

cw_status cli_limit_slices(const cli_slices *slices, const cw_volume *shape,
                           cw_stream_desc *desc, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], limit_text[CWI_MEMORY_TEXT];
    const size_t limit = slices->limit, unused = cwi_memory_left(),
                 taken = slices->turned && unused < limit ? limit - unused : cli_peak_bytes(),
                 beside = taken + CLI_BESIDE_SLICES,
                 needed = cli_slices_bytes(shape, desc, taken);
    if (needed <= limit) {
        desc->extract.max_bytes = limit - beside < unused ? limit - beside : unused;
        return CW_OK;
    }
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(limit, limit_text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "%s: slice by slice, the program needs %s; the limit is %s (--memory)",
                    slices->path, needed_text, limit_text);
}

static cw_status explain_empty(const cli_volume *volume, const cw_extract_desc *desc,
                               cw_error *err)
{
    cw_statistics range;
    cw_status st = cw_volume_statistics(&volume->view, 0, desc->threads, &range, err);
    if (st != CW_OK)
        return st;
    if (!range.finite)
        return cwi_fail(err, CW_ERR_EMPTY, "no voxel has a finite value");
    return cwi_fail(
        err, CW_ERR_EMPTY,
        "no surface at isovalue %g: values%s are %g to %g, and it must be above the "
        "lowest and at most the highest",
        desc->isovalue, cli_is_preview(volume) ? " of the preview" : "", range.min, range.max);
}

/* Of the limit to voxels and surface, and of that to the whole process. */
static size_t memory_left(const cli_volume *volume)
{
    const size_t left = cwi_memory_left();
    return left < 1 ? 1 : left < volume->memory_left ? left : volume->memory_left;
}

static cw_progress progress_of(const cli_volume *volume)
{
    const size_t *n = volume->view.dim;
    return cli_progress((double)n[0] * (double)n[1] * (double)n[2] / 1e6, "Mvoxel");
}

cw_status cli_extract_surface(const cli_volume *volume, cw_extractor *extractor,
                              const cw_extract_desc *desc, cw_mesh *mesh,
                              cw_extract_counts *counts, cw_error *err)
{
    cw_extract_desc d = *desc;
    d.max_bytes = memory_left(volume);
    d.progress = progress_of(volume);
    cw_status st = extractor ? cw_extractor_extract(extractor, &d, mesh, counts, err)
                             : cw_extract(&volume->view, &d, mesh, counts, err);
    if (st == CW_OK && mesh->triangle_count == 0)
        st = explain_empty(volume, desc, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}

bool cli_wants_whole(const cli_wanted *wanted)
{
    return wanted->least_mm3 > 0 || wanted->largest || wanted->fill_voids || wanted->smooths ||
           wanted->cut;
}

cw_status cli_fail_dropped(double least_mm3, const cw_drop_counts *dropped, cw_error *err)
{
    return cwi_fail(err, CW_ERR_EMPTY,
                    "no component encloses %.6g mm3: the largest of %zu encloses %.6g",
                    least_mm3, dropped->dropped, dropped->largest_mm3);
}

static cw_status smooth_surface(const cli_wanted *wanted, cw_mesh *mesh, cw_error *err)
{
    cw_smooth_desc desc = wanted->smooth;
    desc.threads = wanted->extract.threads;
    desc.progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle");
    return cw_mesh_smooth(mesh, &desc, wanted->smoothed, err);
}

static cw_status cut_surface(const cli_wanted *wanted, cw_mesh *mesh, cw_error *err)
{
    double low[3], high[3];
    cw_cut_facts own, *facts = wanted->cut_facts ? wanted->cut_facts : &own;
    *facts = (cw_cut_facts){0};
    cw_mesh_bounds(mesh, low, high);
    return cli_cut_mesh(wanted->cut, low, high, mesh, facts, err);
}

cw_status cli_extract_wanted(const cli_volume *volume, cw_extractor *extractor,
                             const cli_wanted *wanted, cw_mesh *mesh, cw_extract_counts *counts,
                             cw_drop_counts *dropped, cw_error *err)
{
    cw_drop_counts own, *d = dropped ? dropped : &own;
    const int threads = wanted->extract.threads;
    cw_status st = cli_extract_surface(volume, extractor, &wanted->extract, mesh, counts, err);
    *d = (cw_drop_counts){0};
    if (st != CW_OK || !cli_wants_whole(wanted))
        return st;
    if (wanted->least_mm3 > 0)
        st = cw_mesh_drop_volumes(mesh, wanted->least_mm3, d, err);
    if (st == CW_OK && wanted->largest && mesh->triangle_count)
        st = cw_mesh_keep_largest(mesh, wanted->largest, wanted->smaller, err);
    if (st == CW_OK && wanted->fill_voids)
        st = cw_mesh_fill_voids(mesh, threads, wanted->filled, err);
    if (st == CW_OK && wanted->least_mm3 > 0 && !d->kept)
        st = cli_fail_dropped(wanted->least_mm3, d, err);
    if (st == CW_OK && wanted->smooths)
        st = smooth_surface(wanted, mesh, err);
    if (st == CW_OK && wanted->cut)
        st = cut_surface(wanted, mesh, err);
    if (st == CW_OK)
        return CW_OK;
    cw_mesh_free(mesh);
    return cwi_fail_in(err, st, volume->path);
}

/* Not by slabs: the surface as a whole, whose normals are carried over. */
static cw_status simplify_whole(const cli_volume *volume, const cli_wanted *wanted,
                                const cw_simplify_desc *simplify, cw_mesh *mesh,
                                cw_extract_counts *counts, cw_drop_counts *dropped,
                                cw_error *err)
{
    cw_mesh whole;
    *mesh = (cw_mesh){0};
    cw_status st = cli_extract_wanted(volume, NULL, wanted, &whole, counts, dropped, err);
    if (st != CW_OK)
        return st;
    cw_simplify_desc d = *simplify;
    d.progress = progress_of(volume);
    st = cw_simplify(&whole, &d, mesh, NULL, err);
    cw_mesh_free(&whole);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}

static cw_status simplify_slabs(const cli_volume *volume, const cw_extract_desc *desc,
                                const cw_simplify_desc *simplify, cw_mesh *mesh,
                                cw_extract_counts *counts, cw_error *err)
{
    cw_extract_desc d = *desc;
    cw_simplify_desc s = *simplify;
    cw_simplifier *simplifier;
    d.max_bytes = memory_left(volume);
    d.extra_bytes = 0; /* what is checked is what is left */
    d.progress = s.progress = progress_of(volume);
    *mesh = (cw_mesh){0};
    cw_status st = cw_simplifier_new(&s, &simplifier, err);
    if (st == CW_OK)
        st = cw_extract_slabs(&volume->view, &d, CW_SIMPLIFIER_SLAB,
                              (cw_slab_sink){cw_simplifier_take, simplifier}, counts, err);
    if (st == CW_OK)
        st = cw_simplifier_finish(simplifier, mesh, NULL, err);
    cw_simplifier_free(simplifier);
    if (st == CW_OK && mesh->triangle_count == 0)
        st = explain_empty(volume, desc, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}

cw_status cli_extract_simplified(const cli_volume *volume, const cli_wanted *wanted,
                                 const cw_simplify_desc *simplify, cw_mesh *mesh,
                                 cw_extract_counts *counts, cw_drop_counts *dropped,
                                 cw_error *err)
{
    const cw_extract_desc *d = &wanted->extract;
    const cw_normals_desc normals = {.inside_is_low = d->inside_is_low, .threads = d->threads};
    const bool dense = cwi_volume_expect_dense(&volume->view, "slabs", NULL) == CW_OK;
    cw_status st = dense && !cli_wants_whole(wanted)
                       ? simplify_slabs(volume, d, simplify, mesh, counts, err)
                       : simplify_whole(volume, wanted, simplify, mesh, counts, dropped, err);
    if (st != CW_OK || !dense || d->no_normals || wanted->smooths || wanted->cut)
        return st;
    st = cw_extract_normals(&volume->view, &normals, mesh, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}
