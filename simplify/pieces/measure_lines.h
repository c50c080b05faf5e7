/* Solids measured along lines: where which of them are. */
#ifndef SIMPLIFY_PIECES_MEASURE_LINES_H
#define SIMPLIFY_PIECES_MEASURE_LINES_H

#include <cubewright/pieces.h>

/* Adds the volumes of a whole and of its pieces to the facts: a third of each for each axis.
 * meshes   count; the whole comes first. All have one origin
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_measure_lines(const cw_mesh *meshes, size_t count, int axis,
                                         cw_assembled *facts, cw_error *err);

#endif
