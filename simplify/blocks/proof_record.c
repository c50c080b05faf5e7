/* Records what triangles were found near, and finds what has stayed since. */
#include "simplify/blocks/proof_record.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/corner_table.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

cw_status cwi_proof_record_init(cwi_proof_record *record, const cwi_passes *p, size_t blocks,
                                cw_error *err)
{
    const size_t triangles = p->input.triangle_count;
    record->near = cwi_alloc_array(triangles, sizeof *record->near);
    record->block_of = cwi_alloc_array(triangles, sizeof *record->block_of);
    record->first_facet = cwi_alloc_zeroed(blocks + 1, sizeof *record->first_facet);
    if (!record->near || !record->block_of || !record->first_facet)
        return cwi_fail_memory(err);
    cwi_near_facets_clear(record->near, triangles);
    return CW_OK;
}

void cwi_proof_record_free(cwi_proof_record *record)
{
    cwi_free(record->near);
    cwi_free(record->block_of);
    cwi_free(record->first_facet);
    *record = (cwi_proof_record){0};
}

void cwi_near_facets_clear(cwi_near_facets *near, size_t count)
{
    for (size_t t = 0; t < count; t++)
        near[t].count = 0;
}

void cwi_near_facets_add(cwi_near_facets *near, uint32_t facet)
{
    for (uint32_t n = 0; n < near->count && n < CWI_NEAR_FACETS; n++)
        if (near->facets[n] == facet)
            return;
    if (near->count < CWI_NEAR_FACETS)
        near->facets[near->count] = facet;
    if (near->count <= CWI_NEAR_FACETS)
        near->count++;
}

/* Returns the triangle of a surface that has three corners; NONE where the surface lacks it, or all
 * of their fans are wide. */
static uint32_t find_triangle(const cwi_fans *fans, const uint32_t corner[3])
{
    uint32_t hub = corner[0];
    for (int k = 1; k < 3; k++)
        if (fans->first[corner[k] + 1] - fans->first[corner[k]] <
            fans->first[hub + 1] - fans->first[hub])
            hub = corner[k];
    for (uint32_t n = fans->first[hub]; n < fans->first[hub + 1] && !cwi_fan_is_wide(fans, hub);
         n++) {
        const uint32_t *c = fans->corners + 3 * (size_t)fans->around[n];
        int found = 0;
        for (int k = 0; k < 3; k++)
            found += corner[k] == c[0] || corner[k] == c[1] || corner[k] == c[2];
        if (found == 3)
            return fans->around[n];
    }
    return NONE;
}

void cwi_proof_record_take(cwi_proof_record *record, const cwi_passes *p,
                           const cwi_block_part *x, const cwi_near_facets *near, size_t block)
{
    for (size_t t = 0; t < x->input.triangle_count; t++) {
        uint32_t corner[3];
        for (size_t k = 0; k < 3; k++)
            corner[k] = x->global_ids[x->input.triangles[3 * t + k]];
        const uint32_t global = find_triangle(&p->original.fans, corner);
        if (global == NONE)
            continue;
        record->near[global] = near[t];
        record->block_of[global] = (uint32_t)block;
    }
}

/* Marks facets of the joined blocks that are in the result, and those of the result. Vertices keep
 * their global ids, and a triangle is the same if its corners and their places are. */
static void mark_unchanged(const cwi_block_part *x, const cwi_fans *fans,
                           const uint32_t *left_of, uint8_t *unchanged, uint8_t *left_known)
{
    const cwi_mesh_block *from = x->from;
    for (size_t f = 0; f < from->interior_count; f++) {
        uint32_t corner[3];
        bool same = true;
        for (size_t k = 0; k < 3; k++) {
            const size_t v = from->corners[3 * f + k];
            corner[k] = left_of[from->global_ids[v]];
            same = same && corner[k] != NONE &&
                   memcmp(from->points + 3 * v, fans->points + 3 * (size_t)corner[k],
                          3 * sizeof(float)) == 0;
        }
        const uint32_t t = same ? find_triangle(fans, corner) : NONE;
        unchanged[f] = t != NONE;
        if (t != NONE)
            left_known[t] = 1;
    }
}

static void mark_known(const cwi_proof_record *record, const uint8_t *unchanged, size_t count,
                       uint8_t *input_known)
{
    for (size_t t = 0; t < count; t++) {
        const cwi_near_facets *near = record->near + t;
        input_known[t] = near->count > 0 && near->count <= CWI_NEAR_FACETS;
        for (uint32_t n = 0; n < near->count && input_known[t]; n++)
            input_known[t] =
                unchanged[record->first_facet[record->block_of[t]] + near->facets[n]];
    }
}

cw_status cwi_proof_record_compare(const cwi_proof_record *record, const cwi_block_part *x,
                                   size_t global_id_count, uint8_t *input_known,
                                   uint8_t *left_known, cw_error *err)
{
    const cwi_mesh_block *left = x->left;
    uint32_t *left_of = cwi_alloc_array(global_id_count, sizeof *left_of);
    uint8_t *unchanged = cwi_alloc_zeroed(x->from->interior_count, 1);
    uint32_t *first = cwi_alloc_array(left->vertices + 2, sizeof *first);
    uint32_t *around = cwi_alloc_array(3 * left->interior_count, sizeof *around);
    const bool ok = left_of && unchanged && first && around;
    if (ok) {
        const cwi_fans fans = {left->points, left->corners, first, around};
        memset(left_of, 0xff, global_id_count * sizeof *left_of);
        for (size_t v = 0; v < left->vertices; v++)
            left_of[left->global_ids[v]] = (uint32_t)v;
        cwi_fans_sort(left->corners, left->interior_count, left->vertices, first, around);
        mark_unchanged(x, &fans, left_of, unchanged, left_known);
        mark_known(record, unchanged, x->input.triangle_count, input_known);
    }
    cwi_free(left_of);
    cwi_free(unchanged);
    cwi_free(first);
    cwi_free(around);
    return ok ? CW_OK : cwi_fail_memory(err);
}
