/* Pictures that are stopped, and those that are watched. */
#define _GNU_SOURCE /* RTLD_DEFAULT */
#include "support/pictures.h"

#include "core/base/sandbox.h"

#include <cubewright/extract.h>

#include <dlfcn.h>

enum { SIDE = 48, MAX_REPORTS = 1 << 20 };

/* Watcher that lets `left` more reports pass, and on the way may draw something else. */
typedef struct watcher {
    int left, reports;
    cw_renderer *other;
    const cw_scene *scene; /* that it draws */
} watcher;

/* The context of whoever called: here there is none. */
static void assert_no_context(void)
{
    void *epoxy = dlopen("libepoxy.so.0", RTLD_NOW | RTLD_NOLOAD);
    assert_non_null(epoxy);
    void *(**current)(void) = (void *(**)(void))dlsym(epoxy, "epoxy_eglGetCurrentContext");
    assert_non_null(current);
    assert_null((*current)());
    dlclose(epoxy);
}

static bool watch(void *user, const char *step, double done)
{
    watcher *w = user;
    assert_non_null(step);
    assert_true(done >= 0 && done <= 1);
    w->reports++;
    assert_no_context();
    if (w->other) {
        cw_picture picture = test_draw(w->other, w->scene);
        cw_picture_free(&picture);
    }
    return w->left-- > 0;
}

static const cw_mode modes[] = {
    CW_MODE_MESH,       CW_MODE_COMPOSITE, CW_MODE_MIP,    CW_MODE_MINIP,
    CW_MODE_AVERAGE,    CW_MODE_LOCAL_MIP, CW_MODE_SPLAT,  CW_MODE_SPLAT_TREE,
    CW_MODE_PROJECTION, CW_MODE_TEXTURE,   CW_MODE_SLICES, CW_MODE_SHADED_TEXTURE,
    CW_MODE_VBUFFER,    CW_MODE_REFERENCE,
};

/* Makes a scene with settings that need the most to be uploaded. */
static cw_scene scene_of(cw_mode mode, const cw_volume *volume, const cw_transfer *transfer,
                         const cw_mesh *mesh)
{
    cw_scene s = {
        .mode = mode, .width = SIDE, .height = SIDE, .sampling.step_vox = 1, .lit = true};
    s.volume = mode == CW_MODE_MESH ? NULL : volume;
    s.transfer = mode == CW_MODE_MESH ? NULL : transfer;
    s.mesh = mesh;
    s.splat.tree_error = mode == CW_MODE_SPLAT_TREE ? 0.02 : 0;
    s.mesh_look.color[0] = s.mesh_look.color[1] = s.mesh_look.color[2] = 0.8f;
    s.mesh_look.color[3] = mode == CW_MODE_MESH ? 0.5f : 1;
    if (mode == CW_MODE_TEXTURE)
        s.texture.target = CW_TARGET_16F;
    return s;
}

static void assert_same(const cw_picture *a, const cw_picture *b)
{
    assert_int_equal(a->width, b->width);
    assert_memory_equal(a->pixels, b->pixels, a->width * a->height * 4 * sizeof *a->pixels);
}

static cw_renderer *new_renderer(void)
{
    cw_error err = {0};
    cw_renderer *r;
    test_renderer(); /* or skip */
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &r, &err), err);
    return r;
}

/* Cancels at report n, from nothing, and then draws; false: there are fewer reports. */
static bool stop_at(int n, cw_scene scene, const cw_picture *expected)
{
    cw_error err = {0};
    cw_picture picture;
    cw_renderer *r = new_renderer();
    watcher w = {.left = n};
    cw_scene watched = scene;
    watched.progress = (cw_progress){watch, &w};
    const cw_status st = cw_render(r, &watched, &picture, &err);
    if (st != CW_OK) {
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_int_equal(w.reports, n + 1); /* and is not asked again */
        assert_null(picture.pixels);
        picture = test_draw(r, &scene);
    }
    assert_same(&picture, expected);
    cw_picture_free(&picture);
    cw_renderer_free(r);
    return st == CW_ERR_CANCELLED;
}

typedef struct things {
    cw_volume blobs;
    cw_transfer soft;
    cw_mesh mesh;
} things;

static void make_things(things *t)
{
    cw_error err = {0};
    const cw_extract_desc desc = {.isovalue = 0.6f};
    *t = (things){.soft = test_soft_transfer()};
    test_field(&t->blobs, 40, 36, 44, (const double[3]){1, 1, 1}, test_blobs);
    assert_ok(cw_extract(&t->blobs, &desc, &t->mesh, NULL, &err), err);
}

static void free_things(things *t)
{
    cw_volume_free(&t->blobs);
    cw_mesh_free(&t->mesh);
}

/* Stopped anywhere, a renderer draws the next picture as if it had not been. On one thread: of
 * several one that does not ask may have done the most. */
static void stopped_pictures_leave_a_whole_renderer(void **state)
{
    (void)state;
    things t;
    make_things(&t);
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m += CWI_SANITIZED ? 2 : 1) {
        cw_scene scene = scene_of(modes[m], &t.blobs, &t.soft, &t.mesh);
        scene.threads = 1;
        cw_renderer *r = new_renderer();
        cw_picture expected = test_draw(r, &scene);
        int stops = 0;
        for (int n = 0; n < 200 && stop_at(n, scene, &expected);
             n = n < 2 ? n + 1 : (test_is_short() ? 8 : 2) * n)
            stops++;
        if (stops < 2)
            fail_msg("%s asks %d times whether to go on", cw_mode_name(modes[m]), stops);
        cw_picture_free(&expected);
        cw_renderer_free(r);
    }
    free_things(&t);
}

/* Whoever watches gets the same picture, also when more is drawn in between. */
static void watched_pictures_are_the_same(void **state)
{
    (void)state;
    things t;
    make_things(&t);
    cw_renderer *other = new_renderer();
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m += CWI_SANITIZED ? 2 : 1)
        for (int edge = 0; edge < 40; edge += 30) { /* whole, and in bricks */
            cw_scene scene = scene_of(modes[m], &t.blobs, &t.soft, &t.mesh);
            scene.sampling.texture_edge = (size_t)edge;
            cw_renderer *r = new_renderer();
            cw_picture expected = test_draw(r, &scene);
            const cw_scene aside = {.mode = CW_MODE_SLICES,
                                    .volume = &t.blobs,
                                    .transfer = &t.soft,
                                    .width = 8,
                                    .height = 8};
            watcher w = {.left = MAX_REPORTS, .other = other, .scene = &aside};
            scene.progress = (cw_progress){watch, &w};
            cw_renderer_forget(r);
            cw_picture first = test_draw(r, &scene), second = test_draw(r, &scene);
            assert_true(w.reports > 0);
            assert_same(&first, &expected);
            assert_same(&second, &expected);
            cw_picture_free(&first);
            cw_picture_free(&second);
            cw_picture_free(&expected);
            cw_renderer_free(r);
        }
    cw_renderer_free(other);
    free_things(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stopped_pictures_leave_a_whole_renderer),
        cmocka_unit_test(watched_pictures_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
