/* The parts of engraving: strokes of a text, the region that they cover, the surface, and places on it. */
#ifndef SIMPLIFY_ENGRAVE_ENGRAVE_STATE_H
#define SIMPLIFY_ENGRAVE_ENGRAVE_STATE_H

#include "core/font/stroke_font.h"
#include "core/geometry/bvh.h"

#include <cubewright/engrave.h>

/* The strokes of a text in units of the font, y up; the middle of their box is at 0. */
typedef struct cwi_text_lines {
    cwi_stroke *strokes;
    size_t count;
    double width, height; /* of the box around the strokes' middle lines */
    size_t characters;    /* without spaces */
} cwi_text_lines;

/* Lays out a text. Bends of up to 60 degrees become round.
 * Returns  CW_ERR_ARGUMENT for a text that is empty, too long, or not in the font; CW_ERR_NO_MEMORY; free it with
 *          cwi_free_text_lines() */
CW_NODISCARD cw_status cwi_lay_out_text(const char *text, cwi_text_lines *lines, cw_error *err);
void cwi_free_text_lines(cwi_text_lines *lines);

/* A region of the plane as triangles, against the clock. Its border is edges that have it on their left. */
typedef struct cwi_stroke_region {
    double (*points)[2];
    size_t point_count, point_capacity;
    uint32_t (*triangles)[3];
    size_t triangle_count, triangle_capacity;
    uint32_t (*border)[2];
    size_t border_count, border_capacity;
    double cell; /* side of the cells that the triangles lie in */
} cwi_stroke_region;

/* Fills the region that strokes of a width cover.
 * unit     of the strokes, mm
 * Returns  CW_ERR_LIMIT; CW_ERR_NO_MEMORY; free it with cwi_free_stroke_region() */
CW_NODISCARD cw_status cwi_fill_strokes(const cwi_text_lines *lines, double unit,
                                        double stroke_mm, cwi_stroke_region *region,
                                        cw_error *err);
void cwi_free_stroke_region(cwi_stroke_region *region);

/* A surface that rays are cast at. Points are relative to the mesh's origin. */
typedef struct cwi_ray_target {
    const cw_mesh *mesh;
    cwi_boxes tree;
    double middle[3], diagonal; /* of the box */
    float slack;
} cwi_ray_target;

CW_NODISCARD cw_status cwi_ray_target_build(cwi_ray_target *target, const cw_mesh *mesh,
                                            cw_error *err);
void cwi_ray_target_free(cwi_ray_target *target);

/* Returns the distance from a point to the first triangle along a direction, beyond a small fraction of the diagonal; or
 * INFINITY when it is farther than a reach. direction: unit */
double cwi_cast_along(const cwi_ray_target *target, const double from[3],
                      const double direction[3], double reach);

/* A place for text: a point of the surface and a frame. */
typedef struct cwi_text_place {
    double center[3], normal[3], right[3], up[3];
    double hint[3];   /* direction of reading where the place lies flat */
    double area;      /* of the plane face that it is the middle of; 0: it is any point */
    bool is_directed; /* the normal stays as it is */
} cwi_text_place;

/* Sets right and up from the normal and the hint. */
void cwi_set_frame(cwi_text_place *place);

/* Finds the height of the surface above a point of the place's plane: that of the sheet that faces the reader, next to the
 * plane. Returns false when there is none within a reach.
 * lean  set to the cosine of the surface's angle to the plane */
bool cwi_find_height(const cwi_ray_target *target, const cwi_text_place *place, double x,
                     double y, double reach, double *height, double *lean);

/* Lists places that may hold text: those before the middle of the box, along a direction or along the axes (NULL), then
 * middles of plane faces, then points of equal area.
 * Returns  CW_ERR_NO_MEMORY; free the list with cwi_free() */
CW_NODISCARD cw_status cwi_list_places(const cwi_ray_target *target, const double *direction,
                                       cwi_text_place **places, size_t *count, cw_error *err);

/* Requirements of a place. */
typedef struct cwi_room_for_text {
    double half_width, half_height; /* with the margin, mm */
    double max_deviation, max_lean_deg;
    double front;     /* free space in front of the surface */
    double thickness; /* of the material behind it */
} cwi_room_for_text;

/* Results of looking at a place, in the order in which they are found out. */
typedef enum cwi_place_result {
    CWI_PLACE_ENDS,    /* the surface does not cover the box */
    CWI_PLACE_BENDS,   /* it is not flat enough */
    CWI_PLACE_COVERED, /* something is in front of it */
    CWI_PLACE_THIN,    /* too little is behind it */
    CWI_PLACE_FITS,
} cwi_place_result;

/* Measurements of a place. */
typedef struct cwi_place_look {
    cwi_place_result result;
    double deviation, lean_deg;
    double thickness;
} cwi_place_look;

/* Fits the place's plane to the surface, and looks at the box around its middle.
 * step  of the points that are looked at, mm */
cwi_place_look cwi_look_at_place(const cwi_ray_target *target, cwi_text_place *place,
                                 const cwi_room_for_text *room, double step);

/* Makes the solid of the letters: the region between two sheets that follow the surface.
 * below, above  of the surface, mm along the normal; below may be negative
 * tool     its origin is that of the mesh; free it with cw_mesh_free()
 * Returns  CW_ERR_CHECK when the surface has a step or an end in the region; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_make_letters(const cwi_ray_target *target,
                                        const cwi_text_place *place,
                                        const cwi_stroke_region *region, double below,
                                        double above, double reach, cw_mesh *tool,
                                        cw_error *err);

#endif
