/* Finds triangles that cross, first among all, then only around vertices that were put back. */
#include "extract/labels/label_untangle.h"

#include "extract/labels/key_counts.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/quality.h>

#include <math.h>

enum { REACH = 2, BITS = 21 }; /* cubes; bits of a cube's number along an axis */

typedef struct untangling {
    cw_label_surfaces *surfaces;
    const float *originals;
    uint32_t *near; /* numbers of the triangles that are looked at */
    size_t near_count;
    cwi_key_counts cubes; /* around vertices that were put back */
} untangling;

/* Returns the key of a cube at an offset from a vertex's own. */
static uint64_t key_of(const float *place, int x, int y, int z)
{
    const int64_t i = (int64_t)floorf(place[0]) + x + REACH + 1;
    const int64_t j = (int64_t)floorf(place[1]) + y + REACH + 1;
    const int64_t k = (int64_t)floorf(place[2]) + z + REACH + 1;
    return ((uint64_t)k << 2 * BITS | (uint64_t)j << BITS | (uint64_t)i) + 1;
}

/* Marks the cubes whose vertices may be in triangles that cross those of a vertex. */
static bool mark_around(untangling *u, size_t vertex)
{
    const float *place = u->originals + 3 * vertex;
    cwi_key_count *own = cwi_key_counts_need(&u->cubes, key_of(place, 0, 0, 0));
    if (!own || own->count == 2)
        return own != NULL;
    own->count = 2; /* all around are marked */
    for (int n = 0; n < 125; n++) {
        cwi_key_count *e = cwi_key_counts_need(
            &u->cubes, key_of(place, n % 5 - REACH, n / 5 % 5 - REACH, n / 25 - REACH));
        if (!e)
            return false;
        e->count = e->count ? e->count : 1;
    }
    return true;
}

/* Lists the triangles with a vertex in a marked cube. */
static void list_near(untangling *u)
{
    const cw_mesh *mesh = &u->surfaces->mesh;
    u->near_count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        bool is_near = false;
        for (size_t c = 0; c < 3 && !is_near; c++) {
            const float *p = u->originals + 3 * (size_t)mesh->triangles[3 * t + c];
            is_near = cwi_key_counts_has(&u->cubes, key_of(p, 0, 0, 0));
        }
        if (is_near)
            u->near[u->near_count++] = (uint32_t)t;
    }
}

/* Finds crossings among the triangles near, or among all at first. The pairs are numbers of the
 * mesh's own triangles. */
static cw_status find_crossings(const untangling *u, bool all, const cw_labels_desc *desc,
                                cw_crossings *crossings, cw_error *err)
{
    const cw_crossings_desc how = {.threads = desc->threads, .progress = desc->progress};
    const cw_mesh *mesh = &u->surfaces->mesh;
    cw_mesh part = *mesh;
    if (all)
        return cw_self_intersections(mesh, &how, crossings, err);
    part.triangle_count = u->near_count;
    part.triangles = cwi_alloc_array(u->near_count, 3 * sizeof *part.triangles);
    if (!part.triangles)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for triangles that cross");
    for (size_t n = 0; n < 3 * u->near_count; n++)
        part.triangles[n] = mesh->triangles[3 * (size_t)u->near[n / 3] + n % 3];
    cw_status st = cw_self_intersections(&part, &how, crossings, err);
    for (size_t n = 0; n < 2 * crossings->count && st == CW_OK; n++)
        crossings->pairs[n] = u->near[crossings->pairs[n]];
    cwi_free(part.triangles);
    return st;
}

cw_status cwi_labels_untangle(cw_label_surfaces *surfaces, const float *originals,
                              void (*place)(const void *context, const float place[3],
                                            float point[3]),
                              const void *context, const cw_labels_desc *desc, cw_error *err)
{
    cw_mesh *mesh = &surfaces->mesh;
    untangling u = {.surfaces = surfaces, .originals = originals};
    cw_crossings crossings = {0};
    cw_status st = CW_OK;
    bool is_first = true, is_whole = true;
    do {
        cw_crossings_free(&crossings);
        st = find_crossings(&u, is_first, desc, &crossings, err);
        if (st == CW_OK && crossings.count > 0 && !u.near) {
            u.near = cwi_alloc_array(mesh->triangle_count, sizeof *u.near);
            is_whole = u.near != NULL;
        }
        cwi_key_counts_free(&u.cubes);
        for (size_t n = 0; n < 6 * crossings.count && st == CW_OK && is_whole; n++) {
            const size_t v = mesh->triangles[3 * (size_t)crossings.pairs[n / 3] + n % 3];
            place(context, originals + 3 * v, mesh->positions + 3 * v);
            is_whole = mark_around(&u, v);
        }
        if (st == CW_OK && is_whole && crossings.count > 0)
            list_near(&u);
        is_first = false;
    } while (st == CW_OK && is_whole && crossings.count > 0);
    cw_crossings_free(&crossings);
    cwi_key_counts_free(&u.cubes);
    cwi_free(u.near);
    if (st == CW_OK && !is_whole)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for triangles that cross");
    return st;
}
