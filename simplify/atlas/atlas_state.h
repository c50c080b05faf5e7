/* Charts of a surface on their way into an atlas. */
#ifndef SIMPLIFY_ATLAS_ATLAS_STATE_H
#define SIMPLIFY_ATLAS_ATLAS_STATE_H

#include <cubewright/atlas.h>

/* A surface whose triangles are joined along edges that two triangles pass in opposite directions. */
typedef struct cwi_sheet {
    const cw_mesh *mesh;
    uint32_t
        *twin; /* corners: the side that passes the same edge the other way, or CWI_NO_CORNER */
    double (*normal)[3]; /* triangles: of the length of the area, mm2 */
    double area;         /* of all, mm2 */
} cwi_sheet;

CW_NODISCARD cw_status cwi_sheet_init(cwi_sheet *sheet, const cw_mesh *mesh, cw_error *err);
void cwi_sheet_free(cwi_sheet *sheet);

/* Sets of triangles merged two by two. Node t is triangle t; node triangles + n is the n-th merger. A
 * child has a smaller number. */
typedef struct cwi_chart_tree {
    size_t triangles, mergers;
    uint32_t (*children)[2]; /* of mergers */
    bool *is_root;           /* nodes */
    uint32_t *order; /* all triangles: those of node n are order[begin[n]] and the next */
    uint32_t *begin, *size; /* nodes */
} cwi_chart_tree;

/* Merges neighbours while what they are together faces one way well enough. Those that differ least in
 * direction, are small and have compact outlines come first.
 * Source  [Garland2001], with the sums of normals of [Cohen2004] */
CW_NODISCARD cw_status cwi_chart_tree_build(cwi_chart_tree *tree, const cwi_sheet *sheet,
                                            cw_error *err);
void cwi_chart_tree_free(cwi_chart_tree *tree);

/* A chart: triangles with vertices of their own, and their places in the plane. */
typedef struct cwi_chart {
    size_t triangles, vertices;
    uint32_t *triangle; /* of the mesh */
    uint32_t *corners;  /* triangles x 3: vertices of the chart */
    double (*uv)[2];    /* vertices, mm */
    double (*rest)[4];  /* triangles: inverse of the matrix of its sides in its own plane */
    double *area;       /* triangles, mm2; those without area have 0, and count nowhere */
    double surface;     /* sum of the areas */
    uint32_t *border;   /* border_count x 2: vertices of each side at the outline */
    size_t border_count;
    double turn[2],
        box[2];     /* cosine and sine of the turn after which its box is smallest, and that
                               box's sides, mm */
    double stretch; /* L2 [Sander2001]; 1: none */
} cwi_chart;

/* Makes a chart of triangles, joined along their common edges.
 * index  triangles of the mesh: set for those of the chart; charts of several threads share it
 * Returns false when memory is out */
bool cwi_chart_init(cwi_chart *chart, const cwi_sheet *sheet, const uint32_t *triangles,
                    size_t count, uint32_t *index);
void cwi_chart_free(cwi_chart *chart);

/* Lays a chart into the plane, as large as it is in space, so that no triangle is turned over. Returns
 * false where that was not possible, or when memory is out, which sets *no_memory. */
bool cwi_chart_flatten(cwi_chart *chart, const cwi_sheet *sheet, bool *no_memory);

/* Returns true if a triangle is turned over, or hardly has an area. */
bool cwi_chart_is_folded(const cwi_chart *chart);

/* Scales a chart to the area that it has in space, and measures its stretch. */
void cwi_chart_measure(cwi_chart *chart);

/* Moves the vertices of a flat chart until it is stretched as little as possible; no triangle turns over.
 * Returns false when memory is out. */
bool cwi_chart_relax(cwi_chart *chart);

/* Finds the turn after which the box around a chart has the least area. */
void cwi_chart_find_box(cwi_chart *chart);

/* Returns true if parts of a chart without folds lie on each other: then its outline crosses itself, or has
 * more than one loop that goes around counter-clockwise. Sets *no_memory when that is out. */
bool cwi_chart_overlaps(const cwi_chart *chart, bool *no_memory);

/* Makes a chart of triangles and lays it flat. Returns false, and the chart is empty, if it would be folded,
 * lie on itself, be stretched more, or pack badly, or when memory is out, which sets *no_memory. One
 * triangle always makes a chart. */
bool cwi_chart_make(cwi_chart *chart, const cwi_sheet *sheet, const uint32_t *triangles,
                    size_t count, double max_stretch, uint32_t *index, bool *no_memory);

/* Merges charts beside each other where what they are together lies flat well enough: first those with the
 * longest seam for their outlines.
 * count  becomes less; the charts left keep their order */
CW_NODISCARD cw_status cwi_charts_merge(cwi_chart *charts, size_t *count,
                                        const cwi_sheet *sheet, double max_stretch,
                                        uint32_t *index, const cw_atlas_desc *desc,
                                        cw_error *err);

#endif
