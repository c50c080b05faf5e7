/* From a volume that was read to its surface: runs the library's pipeline within --memory. */
#ifndef CLI_INPUTS_EXTRACT_SURFACE_H
#define CLI_INPUTS_EXTRACT_SURFACE_H

#include "cli/inputs/volume_input.h"

#include <cubewright/pipeline.h>

/* Settings of a surface, and what they point to. */
typedef struct cli_surface_settings {
    cw_pipeline_desc desc;
    cw_close_handles_desc handles;
    cw_smooth_desc smooth;
    cw_cut_desc cut;
    cw_engrave_desc engrave;
    char text[4 * CW_ENGRAVE_CHARACTERS + 2]; /* of engrave; longer ones are refused by it */
    cw_simplify_desc simplify;
    cw_atlas_desc atlas;
    cw_bake_desc bake;
} cli_surface_settings;

/* Returns the settings of the same surface as it is before simplification, culling and colours. */
cw_pipeline_desc cli_describe_full(const cli_surface_settings *settings);

/* Memory beside the slices and the program so far, when a surface is made slice by slice: the
 * writer of a file, threads, buffers. */
enum { CLI_BESIDE_SLICES = 10 << 20 };

/* Returns the bytes that checking and writing a surface take for a triangle. */
size_t cli_check_bytes(void);

/* A volume whose surface is to be made slice by slice. */
typedef struct cli_slices {
    const char *path;
    size_t limit; /* of --memory */
    bool turned;  /* its voxels were read first, and freed: their peak does not count */
} cli_slices;

/* Returns the memory that a program which makes the surface slice by slice needs at least.
 * taken: by the program so far */
size_t cli_slices_bytes(const cw_volume *shape, const cw_stream_desc *desc, size_t taken);

/* Limits the memory of a description to that which is left of --memory.
 * Returns CW_ERR_LIMIT when that is not enough */
CW_NODISCARD cw_status cli_limit_slices(const cli_slices *slices, const cw_volume *shape,
                                        cw_stream_desc *desc, cw_error *err);

enum { CLI_STAGE_BYTES = 64 };

/* Writes the option of a stage: "--min-volume" of "min_volume". */
void cli_name_stage(cw_stage stage, char name[CLI_STAGE_BYTES]);

/* Puts a file's name in front of an error of the pipeline, and calls stages by their options. Returns
 * the status. */
cw_status cli_explain_stages(const char *path, cw_status st, cw_error *err);

/* Returns the progress of a stage: for a watch without other needs. user: unused */
cw_progress cli_stage_progress(void *user, cw_stage stage, size_t count, const char *unit);

/* Runs cw_pipeline_run() with progress, within the memory that is left. Errors name the file.
 * extractor  of volume->view, for another surface of it; NULL: this one by itself */
CW_NODISCARD cw_status cli_run_pipeline(const cli_volume *volume, cw_extractor *extractor,
                                        const cw_pipeline_desc *desc, cw_pipeline_sink sink,
                                        cw_pipeline_facts *facts, cw_error *err);

/* Returns the sink that moves a surface into a mesh; the mesh is emptied before. */
cw_pipeline_sink cli_mesh_sink(cw_mesh *mesh);

/* Does the same for one surface. facts: may be NULL */
CW_NODISCARD cw_status cli_make_surface(const cli_volume *volume, cw_extractor *extractor,
                                        const cw_pipeline_desc *desc, cw_mesh *mesh,
                                        cw_pipeline_facts *facts, cw_error *err);

/* Makes the surface as it is extracted. counts: may be NULL */
CW_NODISCARD cw_status cli_extract_surface(const cli_volume *volume,
                                           const cw_extract_desc *desc, cw_mesh *mesh,
                                           cw_extract_counts *counts, cw_error *err);

#endif
