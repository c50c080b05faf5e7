/* The public calls: views, pictures, and how alike two surfaces look. */
#include <cubewright/appearance.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/appearance/look_difference.h"
#include "viewer/appearance/look_draw.h"

#include <math.h>

enum { DEFAULT_VIEWS = 8, DEFAULT_SIZE = 1024, MIN_SIZE = 16 };

static const double FOV_DEG = 30, MARGIN = 1.02;

/* Degrees from each view to the next one: the golden angle, which spreads them evenly. */
static const double GOLDEN_DEG = 137.50776405;

static cw_status resolve_desc(const cw_appearance_desc *desc, cw_appearance_desc *d,
                              cw_error *err)
{
    *d = desc ? *desc : (cw_appearance_desc){0};
    d->views = d->views ? d->views : DEFAULT_VIEWS;
    d->size = d->size ? d->size : DEFAULT_SIZE;
    if (d->views > CW_APPEARANCE_MAX_VIEWS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->views %u: expected 1 to %d", d->views,
                        CW_APPEARANCE_MAX_VIEWS);
    if (d->size < MIN_SIZE || d->size > CW_APPEARANCE_MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->size %u: expected %d to %d", d->size,
                        MIN_SIZE, CW_APPEARANCE_MAX_SIZE);
    return CW_OK;
}

/* Finds the camera: the whole reference is within 1.02 of its sphere. In LPS z is up, and the front
 * faces -y. */
static void find_view(const double center[3], double radius_mm, uint32_t views, uint32_t n,
                      cw_appearance_view *view)
{
    const double up = 1 - (2.0 * n + 1) / views, flat = sqrt(1 - up * up);
    const double azimuth = fmod(n * GOLDEN_DEG, 360), angle = azimuth * CWI_PI / 180;
    const double toward[3] = {flat * sin(angle), -flat * cos(angle), up};
    const double distance = radius_mm / sin(FOV_DEG * CWI_PI / 360) * MARGIN;
    *view = (cw_appearance_view){.camera = {.up = {0, 0, 1}, .fov_deg = FOV_DEG},
                                 .azimuth_deg = azimuth,
                                 .elevation_deg = asin(up) * 180 / CWI_PI};
    for (int a = 0; a < 3; a++) {
        view->camera.target[a] = center[a];
        view->camera.eye[a] = center[a] + distance * toward[a];
    }
}

static cw_status find_extent(const cwi_look_model *reference, double center[3],
                             double *radius_mm, cw_error *err)
{
    return cwi_look_model_extent(reference, center, radius_mm)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "the reference has no triangles, or no extent: there is nothing to "
                          "look at");
}

cw_status cw_appearance_find_view(const cw_surface_look *reference, size_t reference_count,
                                  uint32_t views, uint32_t n, cw_appearance_view *view,
                                  cw_error *err)
{
    CWI_REQUIRE(err, reference, view);
    cwi_look_model model = {0};
    double center[3], radius_mm;
    cw_appearance_desc d;
    cw_status st = resolve_desc(&(cw_appearance_desc){.views = views}, &d, err);
    if (st == CW_OK && n >= d.views)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "view %u of %u", n, d.views);
    if (st == CW_OK)
        st = cwi_look_model_make(reference, reference_count, &model, err);
    if (st == CW_OK)
        st = find_extent(&model, center, &radius_mm, err);
    if (st == CW_OK)
        find_view(center, radius_mm, d.views, n, view);
    cwi_look_model_free(&model);
    return st;
}

cw_status cw_appearance_draw(const cw_surface_look *surface, size_t count,
                             const cw_camera *camera, const cw_appearance_desc *desc,
                             cw_image *image, cw_error *err)
{
    CWI_REQUIRE(err, camera, image);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_look_model model = {0};
    cw_appearance_desc d;
    *image = (cw_image){0};
    cw_status st = resolve_desc(desc, &d, err);
    if (st == CW_OK)
        st = cwi_look_model_make(surface, count, &model, err);
    if (st == CW_OK)
        st = cw_image_alloc(image, d.size, d.size, err);
    const cwi_look_picture picture = {
        .camera = camera, .size = d.size, .threads = d.threads, .progress = d.progress};
    if (st == CW_OK)
        st = cwi_look_draw(&model, &picture, image->pixels, err);
    cwi_look_model_free(&model);
    if (st != CW_OK)
        cw_image_free(image);
    return st;
}

/* --- the measurement ---------------------------------------------------------------------- */

typedef struct measuring {
    cw_appearance_desc d;
    cwi_look_model reference, surface;
    cwi_look_greys *greys;
    double center[3], radius_mm;
    uint8_t *picture[2]; /* of the reference, of the surface */
} measuring;

static cw_status prepare(measuring *m, const cw_surface_look *reference, size_t reference_count,
                         const cw_surface_look *surface, size_t surface_count, cw_error *err)
{
    const size_t pixels = (size_t)m->d.size * m->d.size;
    cw_status st = cwi_look_model_make(reference, reference_count, &m->reference, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "the reference");
    st = find_extent(&m->reference, m->center, &m->radius_mm, err);
    if (st == CW_OK)
        st = cwi_look_model_make(surface, surface_count, &m->surface, err);
    if (st != CW_OK)
        return st;
    m->greys = cwi_alloc_array(1, sizeof *m->greys);
    for (int k = 0; k < 2; k++)
        m->picture[k] = cwi_alloc_array(pixels, 4);
    if (!m->greys || !m->picture[0] || !m->picture[1])
        return cwi_fail_memory(err);
    cwi_look_greys_make(m->greys);
    return CW_OK;
}

/* Draws one of the two. */
static cw_status draw(measuring *m, int which, const cw_camera *camera, bool without_maps,
                      cw_error *err)
{
    const cwi_look_picture picture = {.camera = camera,
                                      .size = m->d.size,
                                      .without_maps = without_maps,
                                      .threads = m->d.threads};
    return cwi_look_draw(which ? &m->surface : &m->reference, &picture, m->picture[which], err);
}

/* Draws the surface, and compares it with the reference. */
static cw_status compare(measuring *m, const cw_camera *camera, bool without_maps,
                         cwi_look_sums *sums, cw_error *err)
{
    cw_status st = draw(m, 1, camera, without_maps, err);
    if (st == CW_OK)
        st = cwi_look_compare(m->greys, m->picture[0], m->picture[1], m->d.size, m->d.threads,
                              sums, err);
    return st;
}

static void put_view(const cwi_look_sums *sums, const cw_appearance_view *view, uint32_t n,
                     cwi_look_sums *all, cw_appearance *out)
{
    out->place[n] = *view;
    cwi_look_figures(sums, &out->view[n]);
    cwi_look_sums_add(all, sums);
    cwi_look_figures(all, &out->all);
    if (out->view[n].rmse > out->view[out->worst].rmse)
        out->worst = n;
}

static cw_status measure(measuring *m, cw_appearance *with_maps, cw_appearance *without_maps,
                         cw_error *err)
{
    cwi_look_sums all[2] = {{0}, {0}};
    cw_status st = CW_OK;
    *with_maps = (cw_appearance){.views = m->d.views, .size = m->d.size};
    if (without_maps)
        *without_maps = *with_maps;
    for (uint32_t n = 0; n < m->d.views && st == CW_OK; n++) {
        cwi_look_sums sums;
        cw_appearance_view view;
        find_view(m->center, m->radius_mm, m->d.views, n, &view);
        st = cwi_progress(&m->d.progress, "comparing looks", (double)n / m->d.views, err);
        if (st == CW_OK)
            st = draw(m, 0, &view.camera, false, err);
        if (st == CW_OK)
            st = compare(m, &view.camera, false, &sums, err);
        if (st == CW_OK)
            put_view(&sums, &view, n, &all[0], with_maps);
        if (st == CW_OK && without_maps && m->surface.has_maps)
            st = compare(m, &view.camera, true, &sums, err);
        if (st == CW_OK && without_maps)
            put_view(&sums, &view, n, &all[1], without_maps);
    }
    return st == CW_OK ? cwi_progress(&m->d.progress, "comparing looks", 1, err) : st;
}

cw_status cw_appearance_measure(const cw_surface_look *reference, size_t reference_count,
                                const cw_surface_look *surface, size_t surface_count,
                                const cw_appearance_desc *desc, cw_appearance *with_maps,
                                cw_appearance *without_maps, cw_error *err)
{
    CWI_REQUIRE(err, reference, with_maps);
    CWI_REQUIRE_VERSION(err, desc, 0);
    measuring m = {0};
    cw_status st = resolve_desc(desc, &m.d, err);
    if (st == CW_OK)
        st = prepare(&m, reference, reference_count, surface, surface_count, err);
    if (st == CW_OK)
        st = measure(&m, with_maps, without_maps, err);
    cwi_look_model_free(&m.reference);
    cwi_look_model_free(&m.surface);
    cwi_free(m.greys);
    cwi_free(m.picture[0]);
    cwi_free(m.picture[1]);
    return st;
}
