/* Comparison of meshes with the meshes that they were made of. */
#ifndef CLI_RESULTS_MESH_COMPARISON_H
#define CLI_RESULTS_MESH_COMPARISON_H

#include "cli/results/run_report.h"

/* Measures a mesh and the one it was made of, both ways, and adds that to what was measured of
 * other parts. Errors do not name a file.
 * tolerance_mm  as in cw_mesh_distance_desc */
CW_NODISCARD cw_status cli_compare(const cw_mesh *mesh, const cw_mesh *input,
                                   double tolerance_mm, int threads, cli_comparison *sum,
                                   cw_error *err);

/* Measures how far a mesh is from the surface of a volume's field; of several the farthest is
 * kept. Errors do not name a file. */
CW_NODISCARD cw_status cli_compare_with_field(const cw_mesh *mesh, const cli_volume *volume,
                                              double iso, bool inside_is_low, int threads,
                                              cli_comparison *c, cw_error *err);

/* Fails when the volume's box and that of the mesh have nothing in common. */
CW_NODISCARD cw_status cli_check_overlap(const cli_volume *volume, const cw_mesh *mesh,
                                         cw_error *err);

#endif
