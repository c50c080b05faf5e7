/* Attributes of vertices, measured as lengths. */
#ifndef SIMPLIFY_ATTRIBUTE_WEIGHTS_H
#define SIMPLIFY_ATTRIBUTE_WEIGHTS_H

#include <cubewright/simplify.h>

/* How many numbers of a vertex have a weight: at most CWI_MAX_ATTRIBUTES. */
size_t cwi_attributes_count(const cw_simplify_desc *desc);

/* Fails for weights that are no weights, or of what the mesh has not. */
CW_NODISCARD cw_status cwi_attributes_check(const cw_mesh *mesh, const cw_simplify_desc *desc,
                                            cw_error *err);

/* Fills in vertices x count: the numbers, such that differences compare with lengths. */
void cwi_attributes_weigh(const cw_mesh *mesh, const cw_simplify_desc *desc, float *values);

#endif
