/* What is written on pictures: scales, directions, legends; and sheets of many pictures. */
#ifndef CUBEWRIGHT_OVERLAY_H
#define CUBEWRIGHT_OVERLAY_H

#include <cubewright/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What to draw on a picture. Zero-initialise it and set what you need. */
typedef struct cw_overlay {
    bool axes;      /* the edges of the volume's box (or the mesh's), fainter behind; and, lower
                       left, the directions to the patient's left, back and head: L, P, S */
    bool scale_bar; /* bottom: 1, 2 or 5 times a power of ten; at the distance of the camera's
                       target, if in perspective */
    bool letters;   /* at the edges, where they lead: R L A P S I, or two of them */
    bool color_bar; /* upper right: the colours of the scene's transfer function,
                       in the mode mesh those of its tint */
    bool histogram; /* lower right: how often values are, logarithmically, under the opacity,
                       whose highest value is told */
    const char *caption;             /* top; UTF-8, lines end with \n; default none */
    const cw_statistics *statistics; /* required for the histogram, with bins */
    double text_px;   /* height of capitals; default 1/48 of the picture's height,
                         at least 7 */
    uint8_t color[4]; /* sRGB and opacity of lines and letters; default white where the picture
                         is dark, black where it is bright */
} cw_overlay;

/* Draws on the picture of a scene. Deterministic on any machine.
 *
 * scene    as it was rendered, borrowed
 * image    of that scene, of any size of the same shape
 * Returns  CW_ERR_ARGUMENT  the image is of another shape; the scene has no transfer function
 * or there are no statistics, where they are needed; as cw_render() */
CW_NODISCARD CW_API cw_status cw_overlay_draw(const cw_overlay *overlay, const cw_scene *scene,
                                              cw_image *image, cw_error *err);

/* What a scale bar says: its length in mm, and in pixels of a picture of a scene. */
CW_NODISCARD CW_API cw_status cw_scale_bar(const cw_scene *scene, const cw_image *image,
                                           double *length_mm, double *length_px, cw_error *err);

/* Copies one image into another, with its upper left corner at column x, row y; what would be
 * outside is left out. */
CW_API void cw_image_place(cw_image *onto, const cw_image *image, ptrdiff_t x, ptrdiff_t y);

/* A sheet of images, row by row: cells are as large as the largest image, which stand in their
 * middles, on a background.
 * columns  0: as many as make the sheet about square
 * gap_px   between cells
 * sheet    made anew; free it with cw_image_free()
 * Returns  CW_ERR_ARGUMENT  no images, or one of nothing; CW_ERR_LIMIT  a sheet of more than
 *          16384 pixels a side; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_image_tile(const cw_image *images, size_t count,
                                            size_t columns, size_t gap_px,
                                            const uint8_t background[4], cw_image *sheet,
                                            cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
