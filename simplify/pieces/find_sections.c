/* Sections between neighbouring pieces: pieces on the same sides of all planes but one. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/pieces/pieces_state.h"

#include <string.h>

static bool are_neighbours(const cwi_cutter *c, size_t below, size_t above, size_t plane)
{
    const bool *a = c->above + below * c->plane_count, *b = c->above + above * c->plane_count;
    return !a[plane] && b[plane] && memcmp(a, b, plane * sizeof *a) == 0 &&
           memcmp(a + plane + 1, b + plane + 1, (c->plane_count - plane - 1) * sizeof *a) == 0;
}

/* Sums the areas of a piece's triangles in each plane. areas: plane_count, zeroed */
static void sum_areas(const cw_mesh *mesh, double *areas)
{
    const uint32_t *number = cwi_section_numbers(mesh);
    for (size_t t = 0; t < mesh->triangle_count && number; t++)
        if (number[t])
            areas[number[t] - 1] += cwi_mesh_area(mesh, t);
}

cw_status cwi_find_sections(cwi_cutter *c, cw_error *err)
{
    cw_pieces *o = c->out;
    size_t capacity = 0;
    double *areas = cwi_alloc_array(c->plane_count, sizeof *areas);
    cw_status st = areas ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; n < o->count && st == CW_OK; n++) {
        memset(areas, 0, c->plane_count * sizeof *areas);
        sum_areas(&o->pieces[n].mesh, areas);
        for (size_t k = 0; k < c->plane_count && st == CW_OK; k++)
            for (size_t m = 0; m < o->count && areas[k] > 0; m++) {
                if (!are_neighbours(c, n, m, k))
                    continue;
                void *grown = cwi_grow_array(o->sections, o->section_count, &capacity,
                                             sizeof *o->sections);
                if (!grown) {
                    st = cwi_fail_memory(err);
                    break;
                }
                o->sections = grown;
                o->sections[o->section_count++] = (cw_piece_section){
                    .plane = k, .below = n, .above = m, .area_mm2 = areas[k]};
                break;
            }
    }
    cwi_free(areas);
    return st;
}
