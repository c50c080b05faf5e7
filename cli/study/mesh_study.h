/* One mesh held against the volume that it is said to be of: where it comes from, how far it is
 * from the surface, and its checks. */
#ifndef CLI_STUDY_MESH_STUDY_H
#define CLI_STUDY_MESH_STUDY_H

#include "cli/inputs/mesh_input.h"
#include "cli/looks/looks_input.h"
#include "cli/study/study.h"

typedef struct cli_mesh_study {
    cli_study
        study;     /* of the volume and the level. Its only point is the mesh; study.full is */
    cli_mesh mesh; /* its file; the triangles are in study.full */
    const cli_input *input; /* it was read with these settings, */
    const char *reader;     /* and by this reader; NULL: by its content */
    size_t file_bytes;
    bool is_fitted;                /* the level is the median of the field at vertices: */
    size_t fit_count, fit_outside; /* vertices looked at; of those outside the volume */
    double fit_low, fit_high;      /* a quarter of the values is below, a quarter above */
    bool is_unsure;                /* these are too far apart for a surface of this volume */
    bool is_open; /* it has open edges, so the surface is left open where the volume ends */
    cw_quality quality;
    cw_distance to_field, from_field;
    cw_appearance looks, bare_looks; /* beside the surface of the volume: with maps, without */
    bool has_maps;
    cli_png drawn_source, drawn, drawn_bare; /* from the worst view: the surface of the volume,
                                                the mesh with its maps, and without */
    cw_findings findings;                    /* points into this */
    cw_verdict verdicts[CW_MAX_VERDICTS];
    size_t verdict_count;
} cli_mesh_study;

/* Finds the level whose surface is nearest to the vertices of study.full: the median of the
 * field's values there, rounded as printed. Warns if the values differ: then filters of the voxels
 * or of the mesh made another surface.
 * Returns  CW_ERR_ARGUMENT  fewer than half of the vertices are in the volume;
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_fit_level(cli_mesh_study *study, cw_error *err);

/* Measures the mesh, and draws it. Free with cli_free_mesh_study(), also after failure.
 * Returns  as the measurements; CW_ERR_EMPTY  the mesh has no triangles, or the volume has no
 *          surface at the level; CW_ERR_ARGUMENT  the mesh lies beside the volume */
CW_NODISCARD cw_status cli_study_mesh(cli_mesh_study *study, cw_error *err);
void cli_free_mesh_study(cli_mesh_study *study);

/* The command that checks the same; free(). NULL: no memory. */
char *cli_check_command(const cli_mesh_study *study);

void cli_put_mesh_json(FILE *out, const void *study);

#endif
