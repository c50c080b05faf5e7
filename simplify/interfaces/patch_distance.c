/* Copies patches into meshes of their own, and measures them both ways. */
#include "simplify/interfaces/patch_distance.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/quality/mesh_within.h"

#include <string.h>

/* Patches with fewer triangles than this are measured by one thread: waking others would take
 * longer. */
enum { MIN_SHARED = 10000 };

/* One patch as a mesh, in memory for the largest one. */
typedef struct patch_copy {
    cw_mesh mesh;
    uint32_t *numbers; /* one a vertex of the surfaces: its number in the mesh, plus 1 */
} patch_copy;

static bool make_copy(patch_copy *copy, const cw_label_surfaces *s)
{
    size_t largest = 0;
    for (size_t p = 0; p < s->patch_count; p++)
        largest = s->patches[p].count > largest ? s->patches[p].count : largest;
    const size_t vertices =
        largest < s->mesh.vertex_count / 3 ? 3 * largest : s->mesh.vertex_count;
    copy->mesh = (cw_mesh){.origin = {0}};
    copy->numbers = cwi_alloc_zeroed(s->mesh.vertex_count, sizeof *copy->numbers);
    copy->mesh.triangles = cwi_alloc_array(3 * largest, sizeof *copy->mesh.triangles);
    copy->mesh.positions = cwi_alloc_array(3 * vertices, sizeof *copy->mesh.positions);
    return copy->numbers && copy->mesh.triangles && copy->mesh.positions;
}

static void free_copy(patch_copy *copy)
{
    cw_mesh_free(&copy->mesh);
    cwi_free(copy->numbers);
}

static void fill_copy(patch_copy *copy, const cw_label_surfaces *s, size_t patch)
{
    const uint32_t *from = s->mesh.triangles + 3 * s->patches[patch].first;
    const size_t corners = 3 * s->patches[patch].count;
    copy->mesh.vertex_count = 0;
    copy->mesh.triangle_count = s->patches[patch].count;
    for (size_t i = 0; i < corners; i++) {
        uint32_t *number = &copy->numbers[from[i]];
        if (*number == 0) {
            memcpy(copy->mesh.positions + 3 * copy->mesh.vertex_count,
                   s->mesh.positions + 3 * (size_t)from[i], 3 * sizeof(float));
            *number = (uint32_t)++copy->mesh.vertex_count;
        }
        copy->mesh.triangles[i] = *number - 1;
    }
    for (size_t i = 0; i < corners; i++)
        copy->numbers[from[i]] = 0;
}

cw_status cwi_patches_measure(const cw_label_surfaces *in, const cw_label_surfaces *out,
                              double error_mm, int threads, const cw_progress *progress,
                              uint8_t *in_beyond, uint8_t *out_beyond, cw_error *err)
{
    patch_copy before = {0}, after = {0};
    cw_status st =
        make_copy(&before, in) && make_copy(&after, out) ? CW_OK : cwi_fail_memory(err);
    memset(in_beyond, 0, in->mesh.triangle_count);
    memset(out_beyond, 0, out->mesh.triangle_count);
    for (size_t p = 0; p < in->patch_count && st == CW_OK; p++) {
        if (in->patches[p].count == out->patches[p].count)
            continue;
        const int few = in->patches[p].count < MIN_SHARED ? 1 : threads;
        fill_copy(&before, in, p);
        fill_copy(&after, out, p);
        st = cwi_mesh_within(&before.mesh, &after.mesh, error_mm, NULL, few, progress,
                             in_beyond + in->patches[p].first, err);
        if (st == CW_OK)
            st = cwi_mesh_within(&after.mesh, &before.mesh, error_mm, NULL, few, progress,
                                 out_beyond + out->patches[p].first, err);
    }
    free_copy(&before);
    free_copy(&after);
    return st;
}
