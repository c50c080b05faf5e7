/* Overlays on pictures: scale bars, directions, legends; and sheets of several pictures. */
#ifndef CUBEWRIGHT_OVERLAY_H
#define CUBEWRIGHT_OVERLAY_H

#include <cubewright/color.h>
#include <cubewright/label_table.h>
#include <cubewright/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An item of a legend. */
typedef struct cw_legend_item {
    const char *name; /* UTF-8; one that is too wide is cut */
    uint8_t color[3]; /* sRGB */
} cw_legend_item;

/* Values to draw over slices in colours. Zero-initialise the struct and set what you need. */
typedef struct cw_value_slices {
    const cw_volume *values; /* on an even or rectilinear grid anywhere in the world: trilinear
                                between voxels; nothing is drawn where one of them has no value,
                                and beyond the outermost ones */
    cw_colormap map;         /* default viridis */
    double low, high; /* values of the ends of the map; nothing is drawn below low, and above
                                high is the last colour */
    float opacity;    /* of all colours, up to 1; default 1 */
} cw_value_slices;

/* The parts to draw on a picture. Zero-initialise the struct and set what you need. */
typedef struct cw_overlay {
    bool axes;      /* the edges of the volume's box (or the mesh's), fainter behind; and, lower
                       left, the directions to the patient's left, back and head: L, P, S */
    bool scale_bar; /* bottom: 1, 2 or 5 times a power of ten; in perspective, at the distance
                       of the camera's target */
    bool letters;   /* at the edges, the direction there: R L A P S I, or two of them */
    bool color_bar; /* upper right: the colours of the scene's transfer function,
                       in the mode mesh those of its tint */
    bool histogram; /* lower right: the frequency of values, logarithmic, under the opacity; its
                       highest value is written */
    const cw_legend_item *legend;    /* legend_count items on the right: patches of colours with
                                     their names, in this order. Those without room are counted
                                     in a last line, "and 3 more" */
    size_t legend_count;             /* default: no legend */
    const char *caption;             /* top; UTF-8, lines end with \n; default none */
    const cw_statistics *statistics; /* required for the histogram, with bins */
    double text_px;   /* height of capitals; default 1/48 of the picture's height,
                         at least 7 */
    uint8_t color[4]; /* sRGB and opacity of lines and letters; default white where the picture
                         is dark, black where it is bright */
    bool isoline; /* a line where slices have the isovalue, to a part of a pixel: the surface's
                         outline there. Only for scenes of slices without a mesh */
    double isovalue;          /* of the isoline */
    uint8_t isoline_color[4]; /* sRGB and opacity; default a yellow */
    const cw_value_slices
        *values_bar; /* the colours of values over slices: upper right, or below
                                          the colour bar. Borrowed; default none */
} cw_overlay;

/* Draws an overlay on the picture of a scene. Deterministic on any machine.
 *
 * overlay  borrowed
 * scene    as it was rendered, borrowed
 * image    of that scene, of any size with the same aspect ratio
 * Returns  CW_ERR_ARGUMENT  the image has another aspect ratio; the scene has no transfer
 *                           function or there are no statistics, where they are needed; an
 *                           isoline is asked for and the mode is not slices; as cw_render()
 *          CW_ERR_UNSUPPORTED  an isoline beside a mesh; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_overlay_draw(const cw_overlay *overlay, const cw_scene *scene,
                                              cw_image *image, cw_error *err);

/* Computes the length that a scale bar states, in mm, and its length in pixels of a picture of
 * a scene.
 * length_mm, length_px  set to the length
 * Returns               CW_ERR_ARGUMENT  the image is empty or has another aspect ratio;
 *                       as cw_render() */
CW_NODISCARD CW_API cw_status cw_scale_bar(const cw_scene *scene, const cw_image *image,
                                           double *length_mm, double *length_px, cw_error *err);

/* Labels to draw over slices. Zero-initialise the struct and set what you need. */
typedef struct cw_label_slices {
    const cw_volume *labels; /* on a dense grid anywhere in the world: a point has the label of
                                    the nearest voxel, and beyond the outermost voxels none */
    const cw_label_table
        *table;     /* their colours and opacities. Labels that it does not have are
                                    not drawn */
    uint32_t layer; /* of the table */
    float opacity;  /* factor of all opacities, up to 1; default 1 */
} cw_label_slices;

/* Draws labels over the picture of a scene of slices, where the slices have values.
 *
 * labels   borrowed
 * scene    as it was rendered, borrowed; without a mesh
 * picture  of that scene
 * Returns  CW_ERR_ARGUMENT  the mode is not slices, the picture has another size, the opacity is
 *                           out of range, or the labels lie outside of the volume's box
 *          CW_ERR_UNSUPPORTED  a scene with a mesh; labels on sparse or irregular grids
 *          CW_ERR_CANCELLED; as cw_render()
 * Cost     in proportion to the samples of the picture
 * Threads  reentrant; the same picture for any number of threads */
CW_NODISCARD CW_API cw_status cw_label_slices_draw(const cw_label_slices *labels,
                                                   const cw_scene *scene, cw_picture *picture,
                                                   cw_error *err);

/* Draws values over the picture of a scene of slices, where the slices have values: a PET over a
 * CT, a statistical map over an MR.
 *
 * values   borrowed
 * scene    as it was rendered, borrowed; without a mesh
 * picture  of that scene
 * Returns  CW_ERR_ARGUMENT  the mode is not slices, the picture has another size, low and high are
 *          not finite and rising, the opacity or the map is out of range, or the values lie outside
 *          of the volume's box
 *          CW_ERR_UNSUPPORTED  a scene with a mesh; values on sparse or irregular grids
 *          CW_ERR_CANCELLED; as cw_render()
 * Cost     in proportion to the samples of the picture
 * Threads  reentrant; the same picture for any number of threads */
CW_NODISCARD CW_API cw_status cw_value_slices_draw(const cw_value_slices *values,
                                                   const cw_scene *scene, cw_picture *picture,
                                                   cw_error *err);

/* A mark of points of the world on pictures, such as a measurement. Zero-initialise the struct and
 * set what you need. */
typedef struct cw_world_mark {
    const double (*points)[3]; /* in mm of the world; a line goes through them */
    size_t count;              /* of the points */
    bool is_closed;            /* the last one is joined to the first; default: it is not */
    const char *text;          /* UTF-8, on a dark plate; default none */
    size_t
        text_point; /* number of the point beside which the text stands; count and more: beside
                          their middle */
    float opacity;  /* of lines and points, up to 1; default 1 */
} cw_world_mark;

/* Draws marks on the picture of a scene, in yellow on dark. A mark with a point behind the eye is
 * left out; nothing of the scene hides a mark.
 * marks    count of them, borrowed; later ones are on top
 * text_px  height of capitals; 0: 1/48 of the picture's height, at least 7
 * scene    its camera is used; borrowed
 * image    of that scene, of any size with the same aspect ratio
 * Returns  CW_ERR_ARGUMENT  an empty image, or letters of another size than 0 to 1000 pixels;
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_world_marks_draw(const cw_world_mark *marks, size_t count,
                                                  double text_px, const cw_scene *scene,
                                                  cw_image *image, cw_error *err);

/* Copies one image into another, with its upper left corner at column x, row y. Parts outside
 * are left out.
 * onto  the image that is changed
 * x, y  place of the upper left corner, which may lie outside */
CW_API void cw_image_place(cw_image *onto, const cw_image *image, ptrdiff_t x, ptrdiff_t y);

/* Makes a sheet of images, row by row, on a background. Cells are as large as the largest
 * image; images stand in the middle of their cells.
 * images      count of them, borrowed
 * columns     0: as many as make the sheet about square
 * gap_px      between cells
 * background  sRGB and alpha
 * sheet       the new image; free it with cw_image_free()
 * Returns     CW_ERR_ARGUMENT  no images, or an empty one; CW_ERR_LIMIT  a sheet of more than
 *             16384 pixels a side; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_image_tile(const cw_image *images, size_t count,
                                            size_t columns, size_t gap_px,
                                            const uint8_t background[4], cw_image *sheet,
                                            cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
