/* Checks surfaces of labels. */
#include "support/label_surfaces.h"

/* Checks one label: closed, oriented, manifold, also for readers who weld. */
static void check_label(const cw_label_surfaces *s, uint32_t label)
{
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    const cw_quality_desc welded = {.weld = CW_WELD_WORLD, .shells = true, .threads = 1};
    assert_ok(cw_label_mesh(s, label, &mesh, &err), err);
    assert_true(mesh.triangle_count > 0);
    assert_ok(cw_quality_measure(&mesh, &welded, &q, &err), err);
    if (!cw_quality_is_closed_manifold(&q) || q.duplicates || q.degenerate ||
        q.merged_vertices || q.unused_vertices || q.inside_out)
        fail_msg("label %u: %zu open, %zu non-manifold edges, %zu vertices, %zu misoriented, "
                 "%zu duplicates, %zu degenerate, %zu merged, %zu unused, %zu inside out",
                 label, q.open_edges, q.nonmanifold_edges, q.nonmanifold_vertices,
                 q.misoriented_edges, q.duplicates, q.degenerate, q.merged_vertices,
                 q.unused_vertices, q.inside_out);
    assert_true(q.volume_mm3 > 0);
    cw_mesh_free(&mesh);
}

/* Checks the whole: patches in order, each triangle in one, and no crossings, so that no label
 * crosses itself or another. */
static void check_whole(const cw_label_surfaces *s)
{
    size_t next = 0;
    for (size_t p = 0; p < s->patch_count; p++) {
        const cw_label_patch *patch = &s->patches[p];
        assert_true(patch->first == next && patch->count > 0);
        assert_true(patch->labels[0] != patch->labels[1]);
        assert_true(patch->labels[0] != s->background);
        assert_true(patch->labels[1] == s->background || patch->labels[0] < patch->labels[1]);
        if (p > 0)
            assert_true(s->patches[p - 1].labels[0] < patch->labels[0] ||
                        s->patches[p - 1].labels[1] < patch->labels[1]);
        next += patch->count;
    }
    assert_true(next == s->mesh.triangle_count);
    cw_crossings crossings = {0};
    cw_error err = {0};
    assert_ok(
        cw_self_intersections(&s->mesh, &(cw_crossings_desc){.threads = 1}, &crossings, &err),
        err);
    if (crossings.count > 0)
        fail_msg("patches cross each other %zu times", crossings.count);
    cw_crossings_free(&crossings);
}

void test_check_label_surfaces(const cw_label_surfaces *s)
{
    check_whole(s);
    for (size_t n = 0; n < s->label_count; n++)
        check_label(s, s->labels[n].label);
}

void test_assert_same_labels(const cw_label_surfaces *a, const cw_label_surfaces *b)
{
    assert_int_equal(a->mesh.vertex_count, b->mesh.vertex_count);
    assert_int_equal(a->mesh.triangle_count, b->mesh.triangle_count);
    assert_memory_equal(a->mesh.triangles, b->mesh.triangles, 12 * a->mesh.triangle_count);
    assert_memory_equal(a->mesh.positions, b->mesh.positions, 12 * a->mesh.vertex_count);
    assert_int_equal(a->patch_count, b->patch_count);
    assert_memory_equal(a->patches, b->patches, a->patch_count * sizeof *a->patches);
    assert_int_equal(a->label_count, b->label_count);
    assert_memory_equal(a->labels, b->labels, a->label_count * sizeof *a->labels);
}
