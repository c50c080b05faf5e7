/* Text on solids: volumes, places, and what is refused. */
#include "support/solids.h"

#include "core/base/memory.h"
#include "core/font/stroke_font.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"

#include <cubewright/engrave.h>
#include <cubewright/field.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh make_box(double width, double depth, double height)
{
    cw_mesh m = test_make_boxes(1);
    test_add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){width, depth, height},
                 false);
    return m;
}

/* Engraves, checks the solid and its volume, and frees it. */
static cw_engrave_facts check_engraved(const cw_mesh *mesh, const cw_engrave_desc *desc)
{
    cw_error err = {0};
    cw_mesh out;
    cw_engrave_facts facts = {0};
    assert_ok(cw_mesh_engrave(mesh, desc, &out, &facts, &err), err);
    test_check_solid(&out);
    const double before = test_measure(mesh).volume_mm3, after = test_measure(&out).volume_mm3;
    const double change = desc->emboss ? after - before : before - after;
    /* on curved places facets of the surface are not those of the letters */
    assert_true(fabs(change - facts.volume_mm3) <= 0.03 * facts.volume_mm3 + 1e-6 * before);
    assert_true(fabs(cwi_length(facts.normal) - 1) < 1e-9);
    assert_true(fabs(cwi_dot(facts.normal, facts.right)) < 1e-9);
    assert_null(cw_mesh_attribute_find(&out, "input"));
    cw_mesh_free(&out);
    return facts;
}

static void letters_have_their_volume(void **state)
{
    (void)state;
    static const double scales[] = {1, 1e-4, 1e4};
    for (int s = 0; s < 3; s++)
        for (int emboss = 0; emboss < 2; emboss++) {
            const double k = scales[s];
            cw_mesh box = make_box(60 * k, 20 * k, 40 * k);
            const cw_engrave_desc desc = {
                .text = "L 4711", .size_mm = 5 * k, .depth_mm = k, .emboss = emboss};
            const cw_engrave_facts f = check_engraved(&box, &desc);
            assert_int_equal(f.characters, 5);
            assert_true(fabs(f.size_mm - 5 * k) < 1e-9 * k && fabs(f.depth_mm - k) < 1e-9 * k);
            assert_true(f.deviation_mm < 1e-5 * k);
            assert_true(fabs(f.normal[1]) > 0.999 && fabs(f.right[2]) < 1e-6);
            assert_true(fabs(f.center[0] - 30 * k) < k && fabs(f.center[2] - 20 * k) < k);
            assert_true(fabs(f.thickness_mm - 20 * k) < 1e-3 * k || f.thickness_mm > 20 * k);
            cw_mesh_free(&box);
        }
    /* a bar alone: length x width, and a round end of a stroke's width */
    cw_mesh box = make_box(30, 30, 5);
    const cw_engrave_desc bar = {.text = "|", .size_mm = 7, .stroke_mm = 1, .depth_mm = 2};
    const cw_engrave_facts f = check_engraved(&box, &bar);
    assert_true(fabs(f.volume_mm3 - 2 * (7 + CWI_PI / 4)) < 0.02 * f.volume_mm3);
    cw_mesh_free(&box);
}

static void all_characters_become_solids(void **state)
{
    (void)state;
    char text[8] = "";
    cw_mesh box = make_box(40, 8, 40);
    for (uint32_t c = '!'; c <= '~'; c++) {
        cwi_stroke strokes[CWI_GLYPH_STROKES];
        double width;
        text[0] = (char)c;
        if (cwi_glyph(c, strokes, &width))
            check_engraved(&box, &(cw_engrave_desc){.text = text, .size_mm = 8});
    }
    check_engraved(&box, &(cw_engrave_desc){.text = "20 \xc2\xb0"
                                                    "C"});
    cw_mesh_free(&box);
}

static void letters_follow_curved_surfaces(void **state)
{
    (void)state;
    static const cw_field kinds[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS};
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh = test_extract_field(kinds[n], 48);
        for (int emboss = 0; emboss < 2; emboss++) {
            const cw_engrave_facts f =
                check_engraved(&mesh, &(cw_engrave_desc){.text = "Nr. 5", .emboss = emboss});
            assert_true(f.lean_deg > 5 && f.lean_deg <= 50 + 1e-6);
            assert_true(f.normal[2] > 0.906 || f.normal[2] < -0.906 || fabs(f.right[2]) < 1e-9);
        }
        cw_mesh_free(&mesh);
    }
}

static void places_are_where_they_are_asked_for(void **state)
{
    (void)state;
    cw_mesh box = make_box(60, 20, 40);
    cw_engrave_desc d = {.text = "up", .size_mm = 4, .direction = {0, 0, 3}};
    cw_engrave_facts f = check_engraved(&box, &d);
    assert_true(f.normal[2] > 0.999 && f.right[0] > 0.999 && fabs(f.center[2] - 40) < 1e-4);
    d = (cw_engrave_desc){.text = "at", .size_mm = 4, .has_at = true, .at = {61, 12, 9}};
    f = check_engraved(&box, &d);
    assert_true(f.normal[0] > 0.999 && f.right[1] > 0.999);
    assert_true(fabs(f.center[0] - 60) < 1e-4 && fabs(f.center[1] - 12) < 1e-4 &&
                fabs(f.center[2] - 9) < 1e-4);
    /* across the surface: depth is along the direction */
    memcpy(d.direction, (const double[3]){1, 0.3, 0}, sizeof d.direction);
    f = check_engraved(&box, &d);
    assert_true(fabs(f.normal[1] / f.normal[0] - 0.3) < 1e-9);
    cw_mesh_free(&box);
}

static void too_large_texts_tell_what_fits(void **state)
{
    (void)state;
    cw_mesh box = make_box(60, 20, 40), out;
    cw_error err = {0};
    cw_engrave_desc d = {.text = "L 4711", .size_mm = 30};
    assert_fails(cw_mesh_engrave(&box, &d, &out, NULL, &err), CW_ERR_CHECK,
                 "no place of the surface is that large", err);
    const char *fits = strstr(err.message, "; a size of ");
    assert_non_null(fits);
    d.size_mm = strtod(fits + strlen("; a size of "), NULL);
    assert_true(d.size_mm > 11 && d.size_mm < 30);
    check_engraved(&box, &d);
    cw_mesh_free(&box);

    box = make_box(60, 1.5, 40);
    d = (cw_engrave_desc){.text = "thin", .size_mm = 5, .depth_mm = 1, .wall_mm = 1};
    assert_fails(
        cw_mesh_engrave(&box, &d, &out, NULL, &err), CW_ERR_CHECK,
        "1.5 mm thick at most where the text has room; a depth of 1 mm and a wall of 1 mm need 2 mm",
        err);
    d.wall_mm = 0.4;
    check_engraved(&box, &d);
    d = (cw_engrave_desc){.text = "wide", .size_mm = 5, .stroke_mm = 2};
    assert_fails(cw_mesh_engrave(&box, &d, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "need a size of 8 mm", err);
    cw_mesh_free(&box);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    static const struct {
        cw_engrave_desc desc;
        const char *words;
    } rows[] = {
        {{.text = NULL}, "the text is empty"},
        {{.text = "  "}, "the text is empty"},
        {{.text = "a\nb"}, "U+000A"},
        {{.text = "Gr\xc3\xb6\xc3\x9f"
                  "e"},
         "\xc3\xb6 U+00F6, \xc3\x9f U+00DF"},
        {{.text = "\xff"}, "U+FFFD"},
        {{.text = "a", .size_mm = -1}, "size_mm is -1"},
        {{.text = "a", .depth_mm = NAN}, "depth_mm"},
        {{.text = "a", .has_at = true, .at = {0, INFINITY, 0}}, "at is not finite"},
        {{.text = "a", .version = 3}, "version is 3"},
    };
    cw_mesh box = make_box(9, 9, 9), out;
    cw_error err = {0};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_mesh_engrave(&box, &rows[n].desc, &out, NULL, &err), CW_ERR_ARGUMENT,
                     rows[n].words, err);
    char text[600];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_fails(cw_mesh_engrave(&box, &(cw_engrave_desc){.text = text}, &out, NULL, &err),
                 CW_ERR_ARGUMENT, "more than 400 characters", err);
    box.triangle_count = 11; /* open */
    assert_fails(cw_mesh_engrave(&box, &(cw_engrave_desc){.text = "a"}, &out, NULL, &err),
                 CW_ERR_CHECK, "open", err);
    box.triangle_count = 0;
    assert_fails(cw_mesh_engrave(&box, &(cw_engrave_desc){.text = "a"}, &out, NULL, &err),
                 CW_ERR_EMPTY, "no triangles", err);
    cw_mesh_free(&box);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    cw_mesh mesh = test_extract_field(CW_FIELD_TORUS, 32), out[2];
    cw_error err = {0};
    for (int n = 0; n < 2; n++)
        assert_ok(cw_mesh_engrave(&mesh,
                                  &(cw_engrave_desc){.text = "same", .threads = 1 + 3 * n},
                                  &out[n], NULL, &err),
                  err);
    assert_int_equal(out[0].triangle_count, out[1].triangle_count);
    assert_memory_equal(out[0].positions, out[1].positions,
                        3 * out[0].vertex_count * sizeof(float));
    assert_memory_equal(out[0].triangles, out[1].triangles,
                        3 * out[0].triangle_count * sizeof(uint32_t));
    assert_non_null(out[0].normals);
    assert_non_null(cw_mesh_attribute_find(&out[0], CW_CORNER_NORMALS));
    cw_mesh_free(&out[0]);
    cw_mesh_free(&out[1]);
    cw_mesh_free(&mesh);
}

static bool cancel_late(void *user, const char *step, double done)
{
    (void)step;
    (void)done;
    return (*(int *)user)-- > 0;
}

static void memory_failures_and_cancelling_are_told(void **state)
{
    (void)state;
    cw_mesh box = make_box(60, 20, 40), out;
    cw_error err = {0};
    const cw_engrave_desc d = {.text = "1", .size_mm = 5, .threads = 1};
    for (long n = 0;; n += 1 + n / 4) {
        (void)cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_engrave(&box, &d, &out, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_mesh_free(&out);
            assert_true(n > 5);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_null(out.positions);
    }
    int left = 0;
    const cw_engrave_desc c = {.text = "1", .progress = {cancel_late, &left}};
    assert_fails(cw_mesh_engrave(&box, &c, &out, NULL, &err), CW_ERR_CANCELLED, "", err);
    cw_mesh_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(letters_have_their_volume),
        cmocka_unit_test(all_characters_become_solids),
        cmocka_unit_test(letters_follow_curved_surfaces),
        cmocka_unit_test(places_are_where_they_are_asked_for),
        cmocka_unit_test(too_large_texts_tell_what_fits),
        cmocka_unit_test(bad_arguments_are_named),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(memory_failures_and_cancelling_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
