/* Reads the texture coordinates of OBJ, and gives them to the corners of triangles. */
#include "formats/obj/obj_places.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/texture/split_seams.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/* A corner of a polygon. */
typedef struct polygon_corner {
    uint32_t vertex, place;
} polygon_corner;

/* The second number goes up in OBJ. It may be missing, and a third one is ignored. */
cw_status cwi_obj_read_place(cwi_obj_places *p, cwi_scan *s, cw_error *err)
{
    double place[2] = {0, 0};
    cwi_word word;
    cw_status st = cwi_scan_double(s, "a texture coordinate", &place[0], err);
    if (st == CW_OK)
        st = cwi_scan_word(s, &word, err);
    if (st == CW_OK && word.size && !cwi_word_double(&word, &place[1]))
        place[1] = 0;
    if (st == CW_OK && p->count == UINT32_MAX - 1)
        st = cwi_fail(err, CW_ERR_LIMIT, "more than %u texture coordinates", UINT32_MAX - 1);
    if (st == CW_OK)
        st = cwi_mesh_grow(p->in, &p->places, &p->capacity, p->count + 1, 2 * sizeof *p->places,
                           err);
    if (st != CW_OK)
        return st;
    for (int k = 0; k < 2; k++) /* numbers beyond single precision are no places */
        place[k] = fabs(place[k]) < 1e30 ? place[k] : 0;
    p->places[2 * p->count] = (float)place[0];
    p->places[2 * p->count + 1] = (float)(1 - place[1]);
    p->count++;
    return CW_OK;
}

/* Gives triangles that have no place yet none. */
static cw_status reserve_corners(cwi_obj_places *p, size_t corners, cw_error *err)
{
    cw_status st = cwi_mesh_grow(p->in, &p->of_corner, &p->named_capacity, corners,
                                 sizeof *p->of_corner, err);
    for (; st == CW_OK && p->named < corners; p->named++)
        p->of_corner[p->named] = NONE;
    return st;
}

cw_status cwi_obj_name_place(cwi_obj_places *p, const cwi_mesh_build *build, int64_t number,
                             cw_error *err)
{
    const int64_t index = number < 0 ? (int64_t)p->count + number : number - 1;
    const bool is_there = number != 0 && index >= 0 && index < (int64_t)p->count;
    const uint32_t place = is_there ? (uint32_t)index : NONE;
    p->is_named = p->is_named || is_there;
    p->is_broken = p->is_broken || (number != 0 && !is_there);
    if (build->corners == 1)
        p->first = place;
    if (build->corners >= 3 && p->is_named) {
        const size_t end = 3 * build->triangle_count;
        cw_status st = reserve_corners(p, end, err);
        if (st != CW_OK)
            return st;
        p->of_corner[end - 3] = p->first;
        p->of_corner[end - 2] = p->last;
        p->of_corner[end - 1] = place;
    }
    p->last = place;
    return CW_OK;
}

cw_status cwi_obj_keep_fans(cwi_obj_places *p, const cwi_mesh_build *build, cw_error *err)
{
    size_t capacity = 0;
    if (!p->is_named || !build->polygon_count)
        return CW_OK;
    cw_status st = cwi_mesh_grow(p->in, &p->fans, &capacity, 3 * build->triangle_count,
                                 sizeof *p->fans, err);
    if (st == CW_OK)
        memcpy(p->fans, build->triangles, 3 * build->triangle_count * sizeof *p->fans);
    return st;
}

static int compare_corners(const void *a, const void *b)
{
    const polygon_corner *c = a, *d = b;
    return (c->vertex > d->vertex) - (c->vertex < d->vertex);
}

/* Gives the triangles of a polygon, if its ears were cut, the places of their corners. */
static cw_status move_places(cwi_obj_places *p, const cwi_face_polygon *polygon,
                             const cw_mesh *mesh, cw_error *err)
{
    const size_t first = 3 * (size_t)polygon->first, count = 3 * (size_t)polygon->count;
    if (memcmp(p->fans + first, mesh->triangles + first, count * sizeof *p->fans) == 0)
        return CW_OK;
    polygon_corner *corners = cwi_alloc_array(count, sizeof *corners);
    if (!corners)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        corners[n] = (polygon_corner){p->fans[first + n], p->of_corner[first + n]};
    qsort(corners, count, sizeof *corners, compare_corners);
    for (size_t n = 0; n < count; n++) {
        const polygon_corner key = {mesh->triangles[first + n], 0};
        const polygon_corner *found =
            bsearch(&key, corners, count, sizeof *corners, compare_corners);
        p->of_corner[first + n] = found ? found->place : NONE;
    }
    cwi_free(corners);
    return CW_OK;
}

cw_status cwi_obj_keep_places(cwi_obj_places *p, const cwi_mesh_build *build, cw_mesh *mesh,
                              cw_error *err)
{
    const size_t corners = 3 * mesh->triangle_count;
    float(*uv)[2];
    if (!p->is_named)
        return CW_OK;
    cw_status st = reserve_corners(p, corners, err);
    for (size_t n = 0; n < build->polygon_count && st == CW_OK; n++)
        st = move_places(p, &build->polygons[n], mesh, err);
    if (st == CW_OK)
        st = cwi_texture_add(mesh, CW_ON_CORNERS, &uv, err);
    for (size_t c = 0; c < corners && st == CW_OK; c++) {
        if (p->of_corner[c] != NONE)
            memcpy(uv[c], p->places + 2 * (size_t)p->of_corner[c], sizeof *uv);
    }
    return st;
}

void cwi_obj_places_free(cwi_obj_places *p)
{
    cwi_free(p->places);
    cwi_free(p->of_corner);
    cwi_free(p->fans);
    *p = (cwi_obj_places){0};
}
