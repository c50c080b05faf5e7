/* Draws the modes of the CPU renderer, and blends a volume with the mesh in it by the mesh's
 * depths. */
#include "viewer/cpu/cpu_draw.h"

#include "viewer/cpu/cpu_mesh.h"
#include "viewer/cpu/intensity_projection.h"
#include "viewer/cpu/pixel_beam.h"
#include "viewer/cpu/reference_volume.h"
#include "viewer/cpu/vbuffer.h"
#include "viewer/projection/cell_projection.h"
#include "viewer/projection/uneven_projection.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

bool cwi_cpu_draws(cw_mode mode)
{
    return mode == CW_MODE_MESH || mode == CW_MODE_MIP || mode == CW_MODE_MINIP ||
           mode == CW_MODE_AVERAGE || mode == CW_MODE_LOCAL_MIP || mode == CW_MODE_PROJECTION ||
           mode == CW_MODE_VBUFFER || mode == CW_MODE_REFERENCE;
}

void cwi_cpu_forget(cwi_cpu *cpu)
{
    cwi_ranges_free(&cpu->ranges);
    cwi_mean_cells_free(&cpu->means);
    cwi_cell_tables_free(&cpu->cell_tables);
    cwi_cell_tree_free(&cpu->tree);
    *cpu = (cwi_cpu){0};
}

static cw_status take_ranges(cwi_cpu *cpu, const cwi_frame *f, cw_error *err)
{
    if (cpu->ranges.blocks && memcmp(&cpu->key, &f->volume, sizeof cpu->key) == 0)
        return CW_OK;
    cwi_ranges_free(&cpu->ranges);
    cwi_mean_cells_free(&cpu->means);
    cw_status st =
        cwi_ranges_make(&f->volume, f->scene.threads, &f->scene.progress, &cpu->ranges, err);
    if (st == CW_OK)
        cpu->key = f->volume;
    else
        cwi_ranges_free(&cpu->ranges);
    return st;
}

/* Makes the mean cells of the volume whose ranges are there, with gradients where the frame
 * needs them. */
static cw_status take_means(cwi_cpu *cpu, const cwi_frame *f, cw_error *err)
{
    const bool has_gradients = cwi_frame_needs_gradients(f);
    if (cpu->means.level_count > 0 && (cpu->means.has_gradients || !has_gradients))
        return CW_OK;
    cwi_mean_cells_free(&cpu->means);
    return cwi_mean_cells_make(&f->volume, &cpu->ranges, has_gradients, f->scene.threads,
                               &f->scene.progress, &cpu->means, err);
}

/* Draws cell by cell, with means where pixels are much wider than a cell. */
static cw_status draw_vbuffer(cwi_cpu *cpu, const cwi_frame *f, const double *depths,
                              cw_picture *picture, cw_error *err)
{
    const char *kind = cwi_volume_kind(&f->volume);
    if (f->scene.vbuffer.pixel_area && kind)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "the area of pixels is averaged for evenly spaced volumes, not for %s",
                        kind);
    const bool needs_means = f->scene.vbuffer.pixel_area && cwi_beams_need_means(f);
    cw_status st = needs_means ? take_means(cpu, f, err) : CW_OK;
    if (st != CW_OK)
        return st;
    return cwi_vbuffer_draw(f, &cpu->ranges, &cpu->tree, needs_means ? &cpu->means : NULL,
                            depths, picture, err);
}

/* Makes the tree of an irregular grid, with gradients where the frame needs them. */
static cw_status take_tree(cwi_cpu *cpu, const cwi_frame *f, cw_error *err)
{
    cw_status st = CW_OK;
    if (!f->volume.cells)
        return CW_OK;
    if (!cpu->tree.kinds || memcmp(&cpu->key, &f->volume, sizeof cpu->key) != 0 ||
        memcmp(&cpu->cells, f->volume.cells, sizeof cpu->cells) != 0) {
        cwi_cpu_forget(cpu);
        st = cwi_cell_tree_make(f, NULL, &cpu->tree, err);
        if (st == CW_OK) {
            cpu->key = f->volume;
            cpu->cells = *f->volume.cells;
        }
    }
    if (st != CW_OK || !cwi_frame_needs_gradients(f))
        return st;
    if (cpu->gradient_version != f->gradient_version)
        cwi_cell_tree_drop_gradients(&cpu->tree);
    cpu->gradient_version = f->gradient_version;
    return cwi_cell_tree_need_gradients(f, &cpu->tree, err);
}

static cw_status draw_volume(cwi_cpu *cpu, const cwi_frame *f, const double *depths,
                             cw_picture *picture, cw_error *err)
{
    const bool is_even = !cwi_volume_kind(&f->volume);
    cw_status st = is_even ? CW_OK : take_tree(cpu, f, err);
    if (st == CW_OK && !is_even && f->scene.mode == CW_MODE_REFERENCE &&
        f->scene.texture.colors_first)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "colours are interpolated on evenly spaced volumes, not on %s",
                        cwi_volume_kind(&f->volume));
    if (st == CW_OK && f->scene.mode == CW_MODE_REFERENCE)
        return cwi_reference_draw(f, &cpu->tree, depths, picture, NULL, err);
    if (st == CW_OK && f->scene.mode == CW_MODE_PROJECTION && !is_even)
        return cwi_uneven_projection_draw(f, &cpu->tree, depths, picture, err);
    if (st == CW_OK && is_even)
        st = take_ranges(cpu, f, err);
    if (st == CW_OK && f->scene.mode == CW_MODE_VBUFFER)
        st = draw_vbuffer(cpu, f, depths, picture, err);
    else if (st == CW_OK && f->scene.mode == CW_MODE_PROJECTION)
        st = cwi_projection_draw(f, &cpu->ranges, &cpu->cell_tables, depths, picture, err);
    else if (st == CW_OK)
        st = cwi_intensity_draw(f, &cpu->ranges, &cpu->tree, depths, picture, err);
    return st;
}

/* Puts an opaque mesh behind the volume drawn so far. */
static void put_behind(const cw_picture *mesh, cw_picture *picture)
{
    for (size_t p = 0; p < picture->width * picture->height; p++) {
        float *pixel = picture->pixels + 4 * p;
        const float through = 1 - pixel[3];
        for (size_t c = 0; c < 4; c++)
            pixel[c] += through * mesh->pixels[4 * p + c];
    }
}

static cw_status draw_both(cwi_cpu *cpu, const cwi_frame *f, cw_picture *picture, cw_error *err)
{
    const size_t count = picture->width * picture->height;
    cw_picture mesh = {0};
    double *depths = cwi_alloc_array(count, sizeof *depths);
    if (!depths)
        return cwi_fail_memory(err);
    cw_status st = cw_picture_alloc(&mesh, picture->width, picture->height, err);
    if (st == CW_OK)
        st = cwi_cpu_draw_mesh(f, depths, &mesh, err);
    for (size_t p = 0; p < count && st == CW_OK; p++)
        depths[p] /= f->unit_mm;
    if (st == CW_OK)
        st = draw_volume(cpu, f, depths, picture, err);
    if (st == CW_OK)
        put_behind(&mesh, picture);
    cw_picture_free(&mesh);
    cwi_free(depths);
    return st;
}

cw_status cwi_cpu_draw(cwi_cpu *cpu, const cwi_frame *f, cw_picture *picture, cw_error *err)
{
    const bool is_uneven = cwi_volume_kind(&f->volume);
    if (!cwi_cpu_draws(f->scene.mode) && !(is_uneven && f->scene.mode == CW_MODE_PROJECTION))
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "the mode %s is not drawn by the CPU",
                        cw_mode_name(f->scene.mode));
    if (f->scene.mode == CW_MODE_MESH)
        return cwi_cpu_draw_mesh(f, NULL, picture, err);
    return f->scene.mesh ? draw_both(cpu, f, picture, err)
                         : draw_volume(cpu, f, NULL, picture, err);
}
