/* Paints over pictures of slices: a colour for each point of the world that a sample shows. */
#ifndef VIEWER_IMAGE_SLICE_PAINT_H
#define VIEWER_IMAGE_SLICE_PAINT_H

#include <cubewright/render.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_slice_paint {
    const char *what;        /* for messages: "labels" */
    const cw_volume *volume; /* resolved and dense: has to overlap that of the scene */
    double opacity;          /* 0 to 1, of all colours */
    /* Finds colour and opacity, 0 to 1, at a point of the world; false where it is bare. */
    bool (*color)(const void *context, const double world[3], double rgba[4]);
    const void *context;
} cwi_slice_paint;

/* Blends the colours over a picture of slices, where slices have values. Results and errors are
 * those of cw_label_slices_draw(). */
CW_NODISCARD cw_status cwi_slice_paint_draw(const cwi_slice_paint *paint, const cw_scene *scene,
                                            cw_picture *picture, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
