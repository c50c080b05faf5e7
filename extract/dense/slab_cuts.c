/* Cuts a surface into slabs of whole layers, and marks the seams between them. */
#include "extract/dense/slab_cuts.h"

#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "extract/dense/edge_crossing.h"

#include <math.h>
#include <string.h>

enum { MIN_LAYERS = 16 };

size_t cwi_vertices_before(const cwi_layer_sums *s, size_t layer)
{
    return layer < s->count ? s->layers[layer].vertices : s->vertices;
}

static size_t triangles_between(const cwi_layer_sums *s, size_t begin, size_t end)
{
    return s->layers[end].triangles - s->layers[begin].triangles;
}

size_t cwi_end_of_slab(const cwi_layer_sums *s, size_t begin, size_t triangles)
{
    const size_t last = s->count - 1;
    size_t end = begin + MIN_LAYERS;
    while (end < last && triangles_between(s, begin, end) < triangles)
        end++;
    return end >= last || s->triangles - s->layers[end].triangles < triangles / 2 ? last : end;
}

cw_extract_counts cwi_largest_slab(const cwi_layer_sums *s, size_t triangles)
{
    cw_extract_counts max = {0};
    for (size_t k = 0, end; k + 1 < s->count; k = end) {
        end = cwi_end_of_slab(s, k, triangles);
        const size_t v = cwi_vertices_before(s, end + 1) - cwi_vertices_before(s, k),
                     t = triangles_between(s, k, end);
        max.vertices = v > max.vertices ? v : max.vertices;
        max.triangles = t > max.triangles ? t : max.triangles;
    }
    return max;
}

/* The last row of a layer is padding: it has no vertices, and the row after it may not be
 * known. */
void cwi_mark_seam(const cwi_row *row, size_t rows, size_t first, uint8_t mark, uint8_t *seam)
{
    for (size_t j = 0; j + 1 < rows; j++)
        memset(seam + (row[j].first[0] - first), mark, row[j].first[2] - row[j].first[0]);
}

void cwi_clear_beyond_seam(const cwi_row *row, size_t rows, size_t first, float *positions)
{
    for (size_t j = 0; j + 1 < rows; j++)
        memset(positions + 3 * (row[j].first[2] - first), 0,
               (size_t)(row[j + 1].first[0] - row[j].first[2]) * 3 * sizeof *positions);
}

/* Returns the height, from the origin, of a fraction of the way from a layer of samples to the
 * next. */
static double height_of(const cw_volume *grid, const double centre[3], size_t layer,
                        double fraction)
{
    return cwi_grid_coordinate(grid, 2, (ptrdiff_t)layer - 1, fraction) - centre[2];
}

/* Vertices are kept CWI_NUDGE away from planes; half of that allows for rounding. */
void cwi_set_slab_planes(const cw_volume *grid, const double centre[3], size_t begin,
                         size_t end, cw_slab *slab)
{
    double cofactor[3][3];
    const double *affine = grid->affine[0], determinant = cwi_affine_determinant(affine);
    cwi_affine_cofactor(affine, cofactor);
    for (int a = 0; a < 3; a++)
        slab->along[a] = cofactor[a][2] / determinant;
    slab->low = begin ? height_of(grid, centre, begin, CWI_NUDGE / 2) : -INFINITY;
    slab->high = slab->last ? INFINITY : height_of(grid, centre, end - 1, 1 - CWI_NUDGE / 2);
}
