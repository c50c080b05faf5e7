/* Where a surface is cut into slabs, and the facts about a slab's ends: the same for a volume in
 * memory and for one that comes slice by slice. */
#ifndef EXTRACT_DENSE_SLAB_CUTS_H
#define EXTRACT_DENSE_SLAB_CUTS_H

#include "extract/dense/dense_plan.h"

/* Counts of a surface up to each layer of samples, which slabs are cut by. */
typedef struct cwi_layer_sums {
    const cwi_layer *layers;    /* vertices and triangles before each layer */
    size_t count;               /* layers of samples, padding included */
    size_t vertices, triangles; /* of the whole surface */
} cwi_layer_sums;

/* Returns the number of vertices before a layer; `layer` may be one past the last. */
size_t cwi_vertices_before(const cwi_layer_sums *sums, size_t layer);

/* Returns the layer where the slab that begins with a layer ends. The rest behind it is a slab
 * of at least half the size. triangles: minimum of a slab */
size_t cwi_end_of_slab(const cwi_layer_sums *sums, size_t begin, size_t triangles);

/* Counts the vertices and triangles of the largest slab. */
cw_extract_counts cwi_largest_slab(const cwi_layer_sums *sums, size_t triangles);

/* Marks the crossings of edges that lie in the plane of a layer of samples.
 * row    the layer's first row, of `rows`
 * first  number of the slab's first vertex, as the rows count */
void cwi_mark_seam(const cwi_row *row, size_t rows, size_t first, uint8_t mark, uint8_t *seam);

/* Clears the vertices in a slab's last layer that belong to the next slab: they were written in
 * part. Arguments as above. */
void cwi_clear_beyond_seam(const cwi_row *row, size_t rows, size_t first, float *positions);

/* Sets the planes between which the slab of layers begin to end lies.
 * grid    the whole volume
 * centre  its middle, as in cwi_vertex_sink */
void cwi_set_slab_planes(const cw_volume *grid, const double centre[3], size_t begin,
                         size_t end, cw_slab *slab);

#endif
