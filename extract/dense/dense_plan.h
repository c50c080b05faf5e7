/* State of an extraction between counting and writing. */
#ifndef EXTRACT_DENSE_DENSE_PLAN_H
#define EXTRACT_DENSE_DENSE_PLAN_H

#include "extract/dense/isa_dispatch.h"

/* Kept by an extractor from one extraction to the next. */
typedef struct cwi_plan {
    const cwi_engine *engine;
    cwi_bit_grid grid;
    cwi_octree tree; /* no levels: no tree is wanted */
    cwi_row *rows;   /* and one after the last, with the totals */
    cw_extract_counts counts;
    cw_mesh spare; /* arrays for the next mesh */
} cwi_plan;

/* Counts the rows of a classified grid, and assigns their first numbers. */
CW_NODISCARD cw_status cwi_plan_count(cwi_plan *plan, int threads, const cw_progress *progress,
                                      cw_error *err);
void cwi_plan_free(cwi_plan *plan);

/* Makes the sink for vertices of a volume: the mesh's arrays, relative to an origin in the
 * middle of the volume, which the mesh gets. invert, simple: as in cwi_bit_grid */
cwi_vertex_sink cwi_make_sink(const cw_volume *volume, bool invert, cw_mesh *mesh);
cwi_emission cwi_make_emission(const cw_volume *volume, bool simple);

/* A range of layers of cells from begin to end, and the layer of samples that ends them. */
typedef struct cwi_writing {
    const cwi_plan *plan;
    size_t begin, end;
    size_t large; /* the number of large chunks, which come first */
    cwi_emission emission;
    cwi_vertex_sink sink;
    uint32_t *triangles;
} cwi_writing;

/* Writes these layers: their triangles, and the vertices that belong to them. */
CW_NODISCARD cw_status cwi_write_dense_layers(cwi_writing *writing, const cw_extract_desc *desc,
                                              cw_error *err);

#endif
