/* Draws marks such as axes and a scale bar onto a picture, and slices beside it. */
#include "cli/render/overlay_options.h"
#include "cli/render/slice_caption.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>
#include <string.h>

enum { BINS = 256 };

bool cli_has_marks(const cli_marks *m)
{
    return m->axes || m->scale_bar || m->letters || m->color_bar || m->histogram || m->legend ||
           m->caption || m->isolines || m->values;
}

/* A label of the legend. */
typedef struct entry {
    size_t voxels, index; /* in the list of labels */
} entry;

static int compare_entries(const void *a, const void *b)
{
    const entry *x = a, *y = b;
    return x->voxels != y->voxels ? (x->voxels < y->voxels) - (x->voxels > y->voxels)
                                  : (x->index > y->index) - (x->index < y->index);
}

/* Lists the labels that the scene shows, the largest first. */
static cw_status list_legend(const cli_label_scene *s, const cw_scene *scene,
                             cw_legend_item **items, size_t *count, cw_error *err)
{
    const size_t all = s->shown.count;
    entry *entries = calloc(all + 1, sizeof *entries);
    *items = calloc(all + 1, sizeof **items);
    *count = 0;
    if (!entries || !*items) {
        free(entries);
        return cwi_fail_memory(err);
    }
    for (size_t n = 0; n < all; n++) {
        const cw_label *label = &s->shown.labels[n];
        if (label->color[3] > 0 && !(label->hidden && scene->mode == CW_MODE_MESH))
            entries[(*count)++] = (entry){s->voxels[n], n};
    }
    qsort(entries, *count, sizeof *entries, compare_entries);
    for (size_t n = 0; n < *count; n++) {
        const cw_label *label = &s->shown.labels[entries[n].index];
        (*items)[n].name = label->name;
        memcpy((*items)[n].color, label->color, 3);
    }
    free(entries);
    return CW_OK;
}

static cw_status draw_marks(const cli_marks *m, const cli_label_scene *labels,
                            const cw_scene *scene, const cw_statistics *statistics,
                            cw_image *image, cw_error *err)
{
    cw_legend_item *legend = NULL;
    size_t count = 0;
    cw_status st = CW_OK;
    if (m->legend && labels)
        st = list_legend(labels, scene, &legend, &count, err);
    const cw_overlay overlay = {.axes = m->axes,
                                .scale_bar = m->scale_bar,
                                .letters = m->letters,
                                .color_bar = m->color_bar,
                                .histogram = m->histogram,
                                .legend = legend,
                                .legend_count = count,
                                .caption = m->caption,
                                .text_px = m->text_px,
                                .isoline = m->isolines,
                                .values_bar = m->values,
                                .isovalue = m->isovalue,
                                .statistics = statistics};
    if (st == CW_OK)
        st = cw_overlay_draw(&overlay, scene, image, err);
    free(legend);
    return st;
}

cw_status cli_mark(const cli_marks *marks, const cli_label_scene *labels, const cw_scene *scene,
                   cw_image *image, cw_error *err)
{
    cw_statistics statistics;
    if (!cli_has_marks(marks))
        return CW_OK;
    if (!marks->histogram)
        return draw_marks(marks, labels, scene, NULL, image, err);
    if (!scene->volume)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--histogram is for volumes");
    cw_status st = cw_volume_statistics(scene->volume, BINS, scene->threads, &statistics, err);
    if (st == CW_OK)
        st = draw_marks(marks, labels, scene, &statistics, image, err);
    cw_statistics_free(&statistics);
    return st;
}

/* Makes greys over the range of the values, or black under labels. */
static cw_status make_greys(const cw_scene *scene, const cli_slice_labels *labels,
                            cw_transfer *greys, cw_error *err)
{
    cw_statistics statistics;
    *greys = cli_black_transfer();
    if (labels->is_base)
        return CW_OK;
    cw_status st = cw_volume_statistics(scene->volume, BINS, scene->threads, &statistics, err);
    if (st == CW_OK)
        st = cw_transfer_preset("grey", &statistics, greys, err);
    cw_statistics_free(&statistics);
    return st;
}

static cw_status draw_slice(const cw_scene *scene, const cw_transfer *greys,
                            const cli_slice_labels *labels, int axis, cw_renderer *renderer,
                            cw_image *image, cw_error *err)
{
    static const uint8_t black[2][4] = {{0, 0, 0, 255}, {0, 0, 0, 255}};
    char caption[96];
    const cli_marks marks = {.scale_bar = true,
                             .letters = true,
                             .caption = caption,
                             .values = axis == 2 && labels->has_values ? &labels->values : NULL,
                             .isolines = labels->isoline.given,
                             .isovalue = labels->isoline.value};
    cw_picture picture;
    double middle[3], world[3];
    cw_scene s = {.mode = CW_MODE_SLICES,
                  .volume = scene->volume,
                  .transfer = greys,
                  .width = scene->width / 2,
                  .height = scene->height / 2,
                  .samples = scene->samples,
                  .slice_count = 1,
                  .threads = scene->threads};
    for (int a = 0; a < 3; a++)
        middle[a] = ((double)s.volume->dim[a] - 1) / 2;
    cw_volume_to_world(s.volume, middle, world);
    s.slices[0].normal[axis] = 1;
    s.slices[0].distance_mm = world[axis];
    cli_caption_slice(s.volume, axis, world[axis], "\n", caption, sizeof caption);
    cw_status st = cw_slice_camera(s.volume, &s.slices[0], (double)s.width / (double)s.height,
                                   &s.camera, err);
    if (st == CW_OK)
        st = cw_render(renderer, &s, &picture, err);
    if (st != CW_OK)
        return st;
    st = cli_draw_slice_labels(labels, &s, &picture, err);
    if (st == CW_OK)
        st = cw_picture_show(&picture, black, image, err);
    cw_picture_free(&picture);
    return st == CW_OK ? cli_mark(&marks, NULL, &s, image, err) : st;
}

cw_status cli_mark_quad(const cw_scene *scene, const cw_image *shown,
                        const cli_slice_labels *labels, cw_backend backend,
                        cw_renderer **renderer, cw_image *sheet, cw_error *err)
{
    static const int axes[3] = {2, 1, 0}; /* axial, coronal, sagittal */
    cw_transfer greys;
    const ptrdiff_t w = (ptrdiff_t)shown->width, h = (ptrdiff_t)shown->height;
    cw_status st = make_greys(scene, labels, &greys, err);
    if (st == CW_OK && !*renderer)
        st = cw_renderer_new(backend, renderer, err);
    if (st == CW_OK)
        st = cw_image_alloc(sheet, scene->width, scene->height, err);
    if (st == CW_OK)
        cw_image_place(sheet, shown, w, h);
    for (int n = 0; n < 3 && st == CW_OK; n++) {
        cw_image slice = {0};
        st = draw_slice(scene, &greys, labels, axes[n], *renderer, &slice, err);
        if (st == CW_OK)
            cw_image_place(sheet, &slice, n % 2 * w, n / 2 * h);
        cw_image_free(&slice);
    }
    return st;
}
