/* Copies meshes of labels: patches are listed by label once, and vertices are numbered in an array that is
 * cleared behind each label. */
#include "extract/pipeline/label_copier.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/labels/find_label.h"
#include "extract/labels/label_net.h"

#include <string.h>

/* Lists patches by label: counts them, then fills them in from behind. */
static bool list_patches(cwi_label_copier *c)
{
    const cw_label_surfaces *s = c->surfaces;
    c->firsts = cwi_alloc_zeroed(s->label_count + 1, sizeof *c->firsts);
    c->patches = cwi_alloc_array(2 * s->patch_count, sizeof *c->patches);
    if (!c->firsts || !c->patches)
        return false;
    for (size_t p = 0; p < s->patch_count; p++)
        for (int side = 0; side < 2; side++)
            c->firsts[cwi_find_label(s, s->patches[p].labels[side])]++;
    size_t total = 0;
    for (size_t n = 0; n <= s->label_count; n++) {
        total += c->firsts[n];
        c->firsts[n] = total;
    }
    for (size_t p = s->patch_count; p-- > 0;)
        for (int side = 0; side < 2; side++)
            c->patches[--c->firsts[cwi_find_label(s, s->patches[p].labels[side])]] =
                (uint32_t)p;
    return true;
}

bool cwi_label_copier_init(cwi_label_copier *c, const cw_label_surfaces *surfaces)
{
    *c = (cwi_label_copier){.surfaces = surfaces};
    c->numbers = cwi_alloc_zeroed(surfaces->mesh.vertex_count, sizeof *c->numbers);
    return list_patches(c) && c->numbers;
}

void cwi_label_copier_free(cwi_label_copier *c)
{
    cwi_free(c->firsts);
    cwi_free(c->patches);
    cwi_free(c->numbers);
    cwi_free(c->met);
    *c = (cwi_label_copier){0};
}

/* Copies a patch's triangles, with vertices numbered as they are met; seen from the other side, the last
 * two corners change places. Returns the number of vertices met so far. */
static size_t copy_patch(cwi_label_copier *c, const cw_label_patch *patch, bool turns,
                         uint32_t *to, size_t count)
{
    const uint32_t *from = c->surfaces->mesh.triangles + 3 * patch->first;
    for (size_t t = 0; t < patch->count; t++, from += 3, to += 3) {
        cwi_label_trim(t);
        for (int k = 0; k < 3; k++) {
            const uint32_t v = from[k && turns ? 3 - k : k];
            if (c->numbers[v] == 0) {
                c->met[count++] = v;
                c->numbers[v] = (uint32_t)count;
            }
            to[k] = c->numbers[v] - 1;
        }
    }
    return count;
}

/* Copies the positions of the vertices that were met, and clears their numbers. */
static void take_positions(cwi_label_copier *c, cw_mesh *mesh)
{
    for (size_t n = 0; n < mesh->vertex_count; n++) {
        if (mesh->positions)
            memcpy(mesh->positions + 3 * n, c->surfaces->mesh.positions + 3 * (size_t)c->met[n],
                   3 * sizeof(float));
        c->numbers[c->met[n]] = 0;
        cwi_label_trim(n);
    }
}

/* Makes room for the vertices of triangles. */
static bool reserve_met(cwi_label_copier *c, size_t triangles)
{
    if (3 * triangles <= c->capacity)
        return true;
    cwi_free(c->met);
    c->met = cwi_alloc_array(3 * triangles, sizeof *c->met);
    c->capacity = c->met ? 3 * triangles : 0;
    return c->met;
}

cw_status cwi_label_copier_copy(cwi_label_copier *c, size_t n, cw_mesh *mesh, cw_error *err)
{
    const cw_label_surfaces *s = c->surfaces;
    size_t triangles = 0;
    *mesh = (cw_mesh){0};
    memcpy(mesh->origin, s->mesh.origin, sizeof mesh->origin);
    memcpy(mesh->affine, s->mesh.affine, sizeof mesh->affine);
    for (size_t i = c->firsts[n]; i < c->firsts[n + 1]; i++)
        triangles += s->patches[c->patches[i]].count;
    if (triangles == 0)
        return CW_OK;
    mesh->triangles = cwi_alloc_array(triangles, 3 * sizeof *mesh->triangles);
    if (!reserve_met(c, triangles) || !mesh->triangles) {
        cw_mesh_free(mesh);
        return cwi_fail_memory(err);
    }
    for (size_t i = c->firsts[n]; i < c->firsts[n + 1]; i++) {
        const cw_label_patch *patch = &s->patches[c->patches[i]];
        mesh->vertex_count =
            copy_patch(c, patch, patch->labels[1] == s->labels[n].label,
                       mesh->triangles + 3 * mesh->triangle_count, mesh->vertex_count);
        mesh->triangle_count += patch->count;
    }
    mesh->positions = cwi_alloc_array(mesh->vertex_count, 3 * sizeof *mesh->positions);
    take_positions(c, mesh);
    if (mesh->positions)
        return CW_OK;
    cw_mesh_free(mesh);
    return cwi_fail_memory(err);
}
