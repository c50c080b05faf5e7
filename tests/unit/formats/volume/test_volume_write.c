/* Tests the writers of volumes: types, frames, strides, time steps, scaling, and interrupted
 * writes. */
#define _GNU_SOURCE /* locale_t, in core/base/text.h */
#include "support/files/reading.h"

#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>

static const char *const names[] = {"a.nrrd", "a.nii", "a.nii.gz", "a.mha"};
enum { NAME_COUNT = sizeof names / sizeof *names };

/* Voxels no two of which are alike, in any type; a frame that any float holds exactly. */
static cw_volume make_volume(cw_type type, size_t components, size_t steps)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, (const size_t[3]){5, 4, 3}, components, steps, &err),
              err);
    unsigned char *p = cw_volume_voxels(&v);
    const size_t size = cw_type_size(type), count = 60 * components * steps;
    for (size_t i = 0; i < count; i++) {
        const float f = (float)i - 7.5f;
        const double d = (double)i * 1.1;
        const uint64_t n = i * 0x01010101;
        memcpy(p + i * size,
               type == CW_F32   ? (const void *)&f
               : type == CW_F64 ? (const void *)&d
                                : &n,
               size);
    }
    const double affine[3][4] = {{-0.5, 0, 0, 12.25}, {0, 0, 2, -7.5}, {0, 0.75, 0, 1000}};
    memcpy(v.affine, affine, sizeof affine);
    v.known = CW_KNOWN_FRAME | CW_KNOWN_UNIT;
    return v;
}

static void check_same_voxels(const cw_volume *a, const cw_volume *b)
{
    cw_volume x, y;
    cw_error err = {0};
    assert_int_equal(a->type, b->type);
    assert_int_equal(a->components, b->components);
    assert_int_equal(a->steps, b->steps);
    assert_memory_equal(a->dim, b->dim, sizeof a->dim);
    for (size_t c = 0; c < a->components; c++)
        for (size_t t = 0; t < a->steps; t++) {
            assert_ok(cw_volume_select(a, c, t, &x, &err), err);
            assert_ok(cw_volume_select(b, c, t, &y, &err), err);
            for (size_t k = 0; k < a->dim[2]; k++)
                for (size_t j = 0; j < a->dim[1]; j++)
                    for (size_t i = 0; i < a->dim[0]; i++)
                        assert_memory_equal(cwi_voxel_address(&x, i, j, k),
                                            cwi_voxel_address(&y, i, j, k),
                                            cw_type_size(a->type));
        }
}

static void every_type_survives_every_writer(void **state)
{
    (void)state;
    const size_t shapes[4][2] = {{1, 1}, {3, 1}, {1, 4}, {2, 3}};
    for (int type = 0; type < CW_TYPE_COUNT; type++)
        for (size_t s = 0; s < 4; s++)
            for (size_t n = 0; n < NAME_COUNT; n++) {
                cw_volume v = make_volume((cw_type)type, shapes[s][0], shapes[s][1]), back;
                cw_error err = {0};
                assert_ok(cw_volume_write(test_path(names[n]), &v, NULL, &err), err);
                assert_ok(read_back(names[n], &back, &err), err);
                check_same_voxels(&v, &back);
                check_affine(&back, &v.affine[0][0]);
                assert_int_equal(back.known, v.known);
                cw_volume_free(&back);
                cw_volume_free(&v);
            }
}

/* Doubles that no float holds: NRRD keeps them to the bit; NIfTI-2 does, NIfTI-1 rounds. */
static void oblique_frames_survive_as_far_as_the_format_can(void **state)
{
    (void)state;
    const double affine[3][4] = {
        {0.1, -0.2, 0.3, 1.0 / 3}, {0.4, 0.5, -0.6, 1e5 / 7}, {-0.7, 0.8, 0.9, -0.123456789}};
    const double margins[NAME_COUNT] = {0, 1e-3, 1e-3, 1e-15};
    for (size_t n = 0; n < NAME_COUNT; n++) {
        cw_volume v = make_volume(CW_U8, 1, 1), back;
        cw_error err = {0};
        memcpy(v.affine, affine, sizeof affine);
        assert_ok(cw_volume_write(test_path(names[n]), &v, NULL, &err), err);
        assert_ok(read_back(names[n], &back, &err), err);
        for (int i = 0; i < 12; i++)
            assert_near(back.affine[i / 4][i % 4], affine[i / 4][i % 4], margins[n]);
        cw_volume_free(&back);
        cw_volume_free(&v);
    }
}

static void long_axes_make_a_nifti_2(void **state)
{
    (void)state;
    cw_volume v, back;
    cw_error err = {0};
    size_t size;
    assert_ok(cw_volume_alloc(&v, CW_U8, (const size_t[3]){40000, 1, 2}, 1, 1, &err), err);
    v.affine[0][3] = 1.0 / 3;
    assert_ok(cw_volume_write(test_path("a.nii"), &v, NULL, &err), err);
    char *bytes = test_file_read(test_path("a.nii"), &size);
    assert_int_equal(size, 544 + 80000);
    assert_memory_equal(bytes + 4, "n+2", 4);
    assert_ok(read_back("a.nii", &back, &err), err);
    check_affine(&back, &v.affine[0][0]);
    free(bytes);
    cw_volume_free(&back);
    cw_volume_free(&v);
}

/* Every other voxel, backwards along y: only strides tell. */
static void strided_views_are_written_as_they_look(void **state)
{
    (void)state;
    for (size_t n = 0; n < NAME_COUNT; n++) {
        cw_volume v = make_volume(CW_I16, 2, 2), view, back;
        cw_error err = {0};
        assert_ok(cw_volume_resolve(&v, &view, &err), err);
        view.owned = NULL;
        view.data = (const char *)view.data + 3 * view.stride[1];
        view.dim[0] = 3;
        view.stride[0] *= 2;
        view.stride[1] *= -1;
        assert_ok(cw_volume_write(test_path(names[n]), &view, NULL, &err), err);
        assert_ok(read_back(names[n], &back, &err), err);
        check_same_voxels(&view, &back);
        cw_volume_free(&back);
        cw_volume_free(&v);
    }
}

/* The components of a voxel stand far apart, as many bytes from voxel to voxel as if not. */
static void components_may_stand_in_planes(void **state)
{
    (void)state;
    for (size_t n = 0; n < NAME_COUNT; n++) {
        cw_volume v = make_volume(CW_I16, 2, 2), view, back;
        cw_error err = {0};
        assert_ok(cw_volume_resolve(&v, &view, &err), err);
        view.owned = NULL;
        view.component_stride = view.step_stride;
        view.steps = 1;
        assert_ok(cw_volume_write(test_path(names[n]), &view, NULL, &err), err);
        assert_ok(read_back(names[n], &back, &err), err);
        check_same_voxels(&view, &back);
        cw_volume_free(&back);
        cw_volume_free(&v);
    }
}

static void time_steps_keep_their_length(void **state)
{
    (void)state;
    for (size_t n = 0; n < 3; n++) { /* MetaImage has no unit of time */
        cw_volume v = make_volume(CW_U8, 1, 2), back;
        cw_error err = {0};
        v.step_seconds = 2.5;
        assert_ok(cw_volume_write(test_path(names[n]), &v, NULL, &err), err);
        assert_ok(read_back(names[n], &back, &err), err);
        assert_true(back.step_seconds == 2.5);
        cw_volume_free(&back);
        cw_volume_free(&v);
    }
}

/* A scale, a shift, and each without the other. */
static void scaling_goes_into_nifti_only(void **state)
{
    (void)state;
    static const double scalings[][2] = {{2, -1024}, {1, -1024}, {2, 0}};
    for (size_t n = 0; n < sizeof scalings / sizeof *scalings; n++) {
        cw_volume v = make_volume(CW_I16, 1, 1), back;
        cw_error err = {0};
        v.slope = scalings[n][0];
        v.intercept = scalings[n][1];
        assert_fails(cw_volume_write(test_path("a.nrrd"), &v, NULL, &err), CW_ERR_ARGUMENT,
                     ".nii has", err);
        assert_fails(cw_volume_write(test_path("a.mha"), &v, NULL, &err), CW_ERR_ARGUMENT,
                     ".nii has", err);
        assert_int_equal(test_folder_entries(), n > 0);
        assert_ok(cw_volume_write(test_path("a.nii"), &v, NULL, &err), err);
        assert_ok(read_back("a.nii", &back, &err), err);
        assert_true(back.slope == v.slope && back.intercept == v.intercept);
        cw_volume_free(&back);
        cw_volume_free(&v);
    }
}

static void what_is_not_known_is_not_claimed(void **state)
{
    (void)state;
    cw_volume v = make_volume(CW_U8, 1, 1), back;
    cw_error err = {0};
    v.known = 0;
    assert_ok(cw_volume_write(test_path("a.nrrd"), &v, NULL, &err), err);
    assert_ok(read_back("a.nrrd", &back, &err), err);
    assert_int_equal(back.known, 0);
    check_affine(&back, &v.affine[0][0]);
    cw_volume_free(&back);
    cw_volume_free(&v);
}

static void the_header_says_what_it_should(void **state)
{
    (void)state;
    static const char expected[] =
        "NRRD0005\ncontent: my name\ntype: uint8\ndimension: 5\nsizes: 2 5 4 3 2\n"
        "space: left-posterior-superior\n"
        "space directions: none (-0.5,0,0) (0,0,0.75) (0,2,0) none\n"
        "space origin: (12.25,-7.5,1000)\nspace units: \"mm\" \"mm\" \"mm\"\n"
        "kinds: vector domain domain domain time\nendian: little\nencoding: gzip\n\n";
    cw_volume v = make_volume(CW_U8, 2, 2);
    cw_error err = {0};
    size_t size;
    const cw_write_desc desc = {.name = "my\nname", .format = "nrrd"};
    assert_ok(cw_volume_write(test_path("a.anything"), &v, &desc, &err), err);
    char *bytes = test_file_read(test_path("a.anything"), &size);
    assert_memory_equal(bytes, expected, sizeof expected - 1);
    free(bytes);
    cw_volume_free(&v);
}

static void unknown_writers_are_refused(void **state)
{
    (void)state;
    cw_volume v = make_volume(CW_U8, 1, 1), none = {0};
    cw_error err = {0};
    const cw_write_desc jpeg = {.format = "jpeg"}, local = {.local = true};
    assert_fails(cw_volume_write(test_path("a.mhd"), &v, NULL, &err), CW_ERR_ARGUMENT,
                 ".nrrd .nii .nii.gz .mha", err);
    assert_fails(cw_volume_write(test_path("a.nrrd"), &v, &jpeg, &err), CW_ERR_ARGUMENT,
                 "no writer 'jpeg'", err);
    assert_fails(cw_volume_write(test_path("a.nrrd"), &v, &local, &err), CW_ERR_ARGUMENT,
                 "a volume has no local form", err);
    assert_fails(cw_volume_write(test_path("a.nrrd"), &none, NULL, &err), CW_ERR_ARGUMENT,
                 "empty", err);
    assert_int_equal(test_folder_entries(), 0);
    cw_volume_free(&v);
}

static bool stop_late(void *user, const char *step, double done)
{
    (void)user;
    return !(strcmp(step, "writing") == 0 && done > 0.5);
}

static void an_interrupted_write_leaves_nothing(void **state)
{
    (void)state;
    cw_volume v = make_volume(CW_U8, 1, 1);
    const cw_write_desc desc = {.progress = {.report = stop_late}};
    for (size_t n = 0; n < NAME_COUNT; n++) {
        cw_error err = {0};
        assert_fails(cw_volume_write(test_path(names[n]), &v, &desc, &err), CW_ERR_CANCELLED,
                     "interrupted while writing", err);
        assert_int_equal(test_folder_entries(), 0);
    }
    cw_volume_free(&v);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    cw_volume v = make_volume(CW_U8, 2, 1);
    for (size_t n = 0; n < NAME_COUNT; n++)
        for (long k = 0;; k++) {
            cw_error err = {0};
            cwi_alloc_fail_after(k);
            const cw_status st =
                cw_volume_write(test_path("x"), &v,
                                &(cw_write_desc){.format = n == 0   ? "nrrd"
                                                           : n == 3 ? "metaimage"
                                                                    : "nifti"},
                                &err);
            if (!cwi_alloc_fail_after(-1)) {
                assert_ok(st, err);
                remove(test_path("x"));
                break;
            }
            assert_int_equal(st, CW_ERR_NO_MEMORY);
            assert_int_equal(test_folder_entries(), 0);
        }
    cw_volume_free(&v);
}

static void a_format_is_found_by_the_extensions_that_are_written(void **state)
{
    (void)state;
    assert_string_equal(cw_volume_format("a.NII.gz", NULL)->name, "nifti");
    assert_string_equal(cw_volume_format("a", "nrrd")->name, "nrrd");
    assert_null(cw_volume_format("a.nhdr", NULL)); /* is read only */
    assert_null(cw_volume_format("a.stl", NULL));
    assert_null(cw_volume_format("a.nrrd", "tiff"));
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_type_survives_every_writer),
        TEST(oblique_frames_survive_as_far_as_the_format_can),
        TEST(long_axes_make_a_nifti_2),
        TEST(strided_views_are_written_as_they_look),
        TEST(components_may_stand_in_planes),
        TEST(time_steps_keep_their_length),
        TEST(scaling_goes_into_nifti_only),
        TEST(what_is_not_known_is_not_claimed),
        TEST(the_header_says_what_it_should),
        TEST(unknown_writers_are_refused),
        TEST(a_format_is_found_by_the_extensions_that_are_written),
        TEST(an_interrupted_write_leaves_nothing),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
