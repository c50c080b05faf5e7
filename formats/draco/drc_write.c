/* Writes Draco files: one mesh on a grid, readable by Draco's own programs and three.js. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "formats/codec/draco_pack.h"
#include "formats/draco/drc_format.h"

#include <stdio.h>
#include <string.h>

/* Appends a part's vertices and triangles to those of the parts before it, as the file has
 * them. */
static void put_part(const cwi_part *part, cw_mesh *whole)
{
    const cw_mesh *m = &part->mesh;
    for (size_t v = 0; v < m->vertex_count; v++) {
        float *to = whole->positions + 3 * (part->first + v);
        for (int a = 0; a < 3; a++)
            to[a] = (float)cwi_file_coordinate(part, v, a);
        if (whole->normals)
            cwi_normal(part, v, whole->normals + 3 * (part->first + v));
    }
    if (whole->colors)
        memcpy(whole->colors + 4 * part->first, m->colors, 4 * m->vertex_count);
    for (size_t t = 0; t < m->triangle_count; t++)
        for (int c = 0; c < 3; c++)
            whole->triangles[3 * (part->first_triangle + t) + (size_t)c] =
                (uint32_t)cwi_corner_number(part, t, c);
}

static cw_status join_parts(const cwi_parts *parts, cw_mesh *whole, cw_error *err)
{
    const cw_mesh *first = &parts->items[0].mesh; /* all have the same arrays */
    if (parts->vertices >= UINT32_MAX || parts->triangles >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "Draco holds at most 4294967294 vertices and triangles");
    cw_status st = cwi_check_single(parts, err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(whole, (size_t)parts->vertices, (size_t)parts->triangles,
                            first->normals, err);
    if (st == CW_OK && first->colors &&
        !(whole->colors = cwi_alloc_array(whole->vertex_count, 4)))
        st = cwi_fail_memory(err);
    for (size_t p = 0; p < parts->count && st == CW_OK; p++)
        put_part(&parts->items[p], whole);
    return st;
}

cw_status cwi_drc_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const cw_write_desc *desc = out->desc;
    cwi_part whole = {.name = ""};
    cwi_parts one = {.items = &whole, .count = 1};
    float *settled = NULL, *positions = NULL;
    cwi_draco_packed packed = {0};
    cw_compressed facts = {0};
    cwi_quantization_grid grid;
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES], comment[CWI_DRACO_COMMENT];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, "\norigin ", "", origin);
    snprintf(comment, sizeof comment, "cubewright %s, %s%s", CW_VERSION, axes, origin);
    cw_status st = cwi_progress(out->progress, "writing", 0, err);
    if (st == CW_OK)
        st = join_parts(parts, &whole.mesh, err);
    if (st == CW_OK) {
        facts.dropped = cwi_draco_count_degenerate(&whole.mesh);
        cwi_draco_drop_degenerate(&whole.mesh);
        positions = whole.mesh.positions;
        st = cwi_grid_choose(&grid, &one, desc, &settled, &facts, err);
    }
    if (st == CW_OK)
        st = cwi_draco_pack(&whole.mesh, whole.mesh.colors, NULL, NULL, &grid, comment, desc,
                            &packed, &facts, err);
    if (st == CW_OK) /* compressing is nearly all of the work */
        st = cwi_progress(out->progress, "writing", 0.95, err);
    if (st == CW_OK)
        st = cwi_outfile_write(out->file, packed.bytes, packed.size, err);
    facts.bytes = packed.size;
    if (st == CW_OK && desc->compressed)
        *desc->compressed = facts;
    cwi_draco_packed_free(&packed);
    whole.mesh.positions = settled ? positions : whole.mesh.positions;
    cwi_free(settled);
    cw_mesh_free(&whole.mesh);
    return st;
}
