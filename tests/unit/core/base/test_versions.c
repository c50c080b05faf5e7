/* Structs that callers fill in state their version: a zeroed one is the first, and a version that this
 * library does not know is refused. */
#include "support/support.h"

#include <stdio.h>
#include <string.h>

/* Options may be written as {.isovalue = 300}: the version comes first, and 0 is valid. */
static void versions_come_first(void **state)
{
    (void)state;
#define PLACE(type) offsetof(type, version), sizeof(((type *)0)->version)
    static const size_t offsets[][2] = {
        {PLACE(cw_mesh)},          {PLACE(cw_fit_desc)},        {PLACE(cw_sample_desc)},
        {PLACE(cw_cut_desc)},      {PLACE(cw_extract_desc)},    {PLACE(cw_field_distance_desc)},
        {PLACE(cw_field_desc)},    {PLACE(cw_normals_desc)},    {PLACE(cw_mesh_distance_desc)},
        {PLACE(cw_filter_desc)},   {PLACE(cw_read_desc)},       {PLACE(cw_label_field_desc)},
        {PLACE(cw_write_desc)},    {PLACE(cw_mesh_read_desc)},  {PLACE(cw_label_simplify_desc)},
        {PLACE(cw_hard_desc)},     {PLACE(cw_labels_desc)},     {PLACE(cw_level_set_desc)},
        {PLACE(cw_offset_desc)},   {PLACE(cw_hollow_desc)},     {PLACE(cw_quality_stream_desc)},
        {PLACE(cw_print_desc)},    {PLACE(cw_quality_desc)},    {PLACE(cw_render_mesh_desc)},
        {PLACE(cw_remesh_desc)},   {PLACE(cw_repair_desc)},     {PLACE(cw_crossings_desc)},
        {PLACE(cw_simplify_desc)}, {PLACE(cw_smooth_desc)},     {PLACE(cw_slice_filter_desc)},
        {PLACE(cw_stream_desc)},   {PLACE(cw_spool_drop_desc)}, {PLACE(cw_pipeline_desc)},
        {PLACE(cw_engrave_desc)},
    };
    for (size_t n = 0; n < sizeof offsets / sizeof *offsets; n++) {
        assert_int_equal(offsets[n][0], 0);
        assert_int_equal(offsets[n][1], sizeof(uint32_t));
    }
}

/* The message names both versions. */
static void later_versions_are_refused(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume ball = {0}, other = {0};
    cw_mesh mesh = {0}, out = {0};
    cw_quality q;
    cw_print_facts facts;
    const cw_field_desc field = {.dim = {8, 8, 8}, .type = CW_F32};
    const char *words = "desc->version is 7; this library knows up to 0";
    assert_ok(cw_field_sample(&field, &ball, &err), err);
    assert_ok(cw_extract(&ball, NULL, &mesh, NULL, &err), err);
    assert_fails(cw_field_sample(&(cw_field_desc){.version = 7, .type = CW_F32}, &other, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_extract(&ball, &(cw_extract_desc){.version = 7}, &out, NULL, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_mesh_cut(&mesh, &(cw_cut_desc){.version = 7}, &out, NULL, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_mesh_repair(&mesh, &(cw_repair_desc){.version = 7}, &out, NULL, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_mesh_remesh(&mesh, &(cw_remesh_desc){.version = 7}, &out, NULL, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_mesh_smooth(&mesh, &(cw_smooth_desc){.version = 7}, NULL, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_simplify(&mesh, &(cw_simplify_desc){.version = 7}, &out, NULL, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_quality_measure(&mesh, &(cw_quality_desc){.version = 7}, &q, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_print_measure(&mesh, &(cw_print_desc){.version = 7}, &facts, &err),
                 CW_ERR_ARGUMENT, words, err);
    assert_fails(cw_mesh_write("none.stl", &mesh, &(cw_write_desc){.version = 7}, &err),
                 CW_ERR_ARGUMENT, words, err);
    mesh.version = 7;
    assert_fails(cw_mesh_check(&mesh, &err), CW_ERR_ARGUMENT,
                 "mesh->version is 7; this library knows up to 0", err);
    assert_null(out.positions);
    mesh.version = 0;
    assert_ok(cw_mesh_check(&mesh, &err), err);
    cw_mesh_free(&mesh);
    cw_volume_free(&ball);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(versions_come_first),
        cmocka_unit_test(later_versions_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
