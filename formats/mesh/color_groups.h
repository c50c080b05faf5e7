/* Colours of triangles for formats whose vertices or materials alone have colours. */
#ifndef FORMATS_MESH_COLOR_GROUPS_H
#define FORMATS_MESH_COLOR_GROUPS_H

#include "formats/mesh/mesh_writer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* More groups would be too many draw calls. */
enum { CWI_MAX_COLOR_GROUPS = 128 };

/* Triangles of one colour, sRGB and opacity. */
typedef struct cwi_color_group {
    uint8_t color[4];
    size_t first, count; /* in the order of groups */
} cwi_color_group;

/* Groups in the order in which their colours are first met. Zeroed: none; free it with cwi_color_groups_free(). */
typedef struct cwi_color_groups {
    cwi_color_group *items;
    size_t count;
    uint32_t *order; /* numbers of the part's triangles, sorted by group */
} cwi_color_groups;

/* Counts the colours of a part's triangles; CWI_MAX_COLOR_GROUPS + 1 stands for more. It has face_colors
 * here and below. */
size_t cwi_count_face_colors(const cwi_part *part);

/* Sorts the triangles of a part by their colours. Returns CW_ERR_LIMIT for too many colours,
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_group_faces(const cwi_part *part, cwi_color_groups *groups,
                                       cw_error *err);
void cwi_color_groups_free(cwi_color_groups *groups);

/* Makes a mesh whose vertices have the colours of the triangles around them: a vertex of several is there
 * once for each. The first copy keeps its number. Triangles keep their order; normals and the
 * texture coordinates of vertices are copied.
 * split    zeroed; free it with cw_mesh_free(), also on failure
 * Returns  CW_ERR_LIMIT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_split_by_color(const cwi_part *part, cw_mesh *split, cw_error *err);

/* Counts the vertices that cwi_split_by_color() adds. */
CW_NODISCARD cw_status cwi_count_split(const cwi_part *part, size_t *added, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
