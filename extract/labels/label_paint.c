/* Makes one mesh of all interfaces for a picture, in the colours of their labels. */
#include <cubewright/labels.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"

#include <stdlib.h>
#include <string.h>

/* A patch, and the side whose colour it has: a place in the list of labels. */
typedef struct owned {
    size_t owner, patch;
    bool is_flipped; /* the owner is labels[1] */
} owned;

/* Finds a label in the rising list; label_count for the background. */
static size_t place_of(const cw_label_surfaces *s, uint32_t label)
{
    size_t low = 0, high = s->label_count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (s->labels[middle].label < label)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->label_count && s->labels[low].label == label ? low : s->label_count;
}

static int compare_owned(const void *a, const void *b)
{
    const owned *x = a, *y = b;
    return x->owner != y->owner ? (x->owner < y->owner ? -1 : 1)
                                : (x->patch > y->patch) - (x->patch < y->patch);
}

/* Gives each patch to the more opaque of its labels, of equal ones to the first. Patches between
 * clear labels are left out. Returns the number of patches. */
static size_t share_patches(const cw_label_surfaces *s, const uint8_t (*colors)[4],
                            owned *patches)
{
    size_t count = 0;
    for (size_t p = 0; p < s->patch_count; p++) {
        size_t at[2];
        int opacity[2];
        for (int side = 0; side < 2; side++) {
            at[side] = place_of(s, s->patches[p].labels[side]);
            opacity[side] = at[side] < s->label_count ? colors[at[side]][3] : 0;
        }
        const int side = opacity[1] > opacity[0];
        if (opacity[side] > 0)
            patches[count++] = (owned){at[side], p, side == 1};
    }
    qsort(patches, count, sizeof *patches, compare_owned);
    return count;
}

/* Numbers of the vertices that the labels' meshes have: each label has its own. */
typedef struct numbering {
    size_t *owner; /* of a vertex of the interfaces, plus 1: the last label that used it */
    uint32_t *number;
    size_t count;
} numbering;

/* Returns true if a label uses a vertex for the first time, which then has the next number. */
static bool need_vertex(numbering *n, size_t owner, uint32_t vertex)
{
    if (n->owner[vertex] == owner + 1)
        return false;
    n->owner[vertex] = owner + 1;
    n->number[vertex] = (uint32_t)n->count++;
    return true;
}

/* Counts the vertices and triangles of the patches. */
static size_t count_vertices(const cw_label_surfaces *s, const owned *patches, size_t count,
                             numbering *n, size_t *triangles)
{
    *triangles = 0;
    for (size_t p = 0; p < count; p++) {
        const cw_label_patch *patch = &s->patches[patches[p].patch];
        const uint32_t *corners = s->mesh.triangles + 3 * patch->first;
        for (size_t c = 0; c < 3 * patch->count; c++)
            need_vertex(n, patches[p].owner, corners[c]);
        *triangles += patch->count;
    }
    return n->count;
}

static void copy_vertex(const cw_label_surfaces *s, uint32_t from, size_t to, size_t owner,
                        const uint8_t color[4], cw_mesh *mesh)
{
    memcpy(mesh->positions + 3 * to, s->mesh.positions + 3 * (size_t)from,
           3 * sizeof *mesh->positions);
    memcpy(mesh->colors + 4 * to, color, 4);
    mesh->labels[to] = s->labels[owner].label;
}

static void copy_patches(const cw_label_surfaces *s, const uint8_t (*colors)[4],
                         const owned *patches, size_t count, numbering *n, cw_mesh *mesh)
{
    uint32_t *to = mesh->triangles;
    for (size_t p = 0; p < count; p++) {
        const owned *o = &patches[p];
        const cw_label_patch *patch = &s->patches[o->patch];
        const uint32_t *from = s->mesh.triangles + 3 * patch->first;
        for (size_t c = 0; c < 3 * patch->count; c++) {
            /* seen from the other side, the last two corners change places */
            const size_t turned = c % 3 && o->is_flipped ? c - c % 3 + 3 - c % 3 : c;
            const uint32_t vertex = from[turned];
            if (need_vertex(n, o->owner, vertex))
                copy_vertex(s, vertex, n->number[vertex], o->owner, colors[o->owner], mesh);
            *to++ = n->number[vertex];
        }
    }
}

static cw_status alloc_painted(const cw_label_surfaces *s, size_t vertices, size_t triangles,
                               cw_mesh *mesh, cw_error *err)
{
    if (vertices > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "%zu vertices of labels in one mesh: at most 4294967295", vertices);
    cw_status st = cwi_mesh_alloc(mesh, vertices, triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(mesh->origin, s->mesh.origin, sizeof mesh->origin);
    memcpy(mesh->affine, s->mesh.affine, sizeof mesh->affine);
    mesh->colors = cwi_alloc_array(vertices, 4 * sizeof *mesh->colors);
    mesh->labels = cwi_alloc_array(vertices, sizeof *mesh->labels);
    return mesh->colors && mesh->labels ? CW_OK : cwi_fail_memory(err);
}

cw_status cw_label_colored_mesh(const cw_label_surfaces *s, const uint8_t (*colors)[4],
                                cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, s, colors, mesh);
    const size_t size = s->mesh.vertex_count;
    owned *patches = cwi_alloc_array(s->patch_count, sizeof *patches);
    numbering n = {cwi_alloc_zeroed(size, sizeof *n.owner),
                   cwi_alloc_array(size, sizeof *n.number), 0};
    size_t triangles = 0;
    memset(mesh, 0, sizeof *mesh);
    cw_status st = patches && n.owner && n.number ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        const size_t count = share_patches(s, colors, patches);
        const size_t vertices = count_vertices(s, patches, count, &n, &triangles);
        st = alloc_painted(s, vertices, triangles, mesh, err);
        memset(n.owner, 0, size * sizeof *n.owner);
        n.count = 0;
        if (st == CW_OK)
            copy_patches(s, colors, patches, count, &n, mesh);
    }
    if (st == CW_OK)
        st = cw_mesh_normals(mesh, err);
    if (st != CW_OK)
        cw_mesh_free(mesh);
    cwi_free(patches);
    cwi_free(n.owner);
    cwi_free(n.number);
    return st;
}
