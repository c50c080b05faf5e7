/* Predictions of the command info: what `extract` makes of a volume at an isovalue, and what that
 * takes. */
#ifndef CLI_INFO_INFO_PREDICT_H
#define CLI_INFO_INFO_PREDICT_H

#include "cli/inputs/volume_input.h"

enum { CLI_STEM_TEXT = 256 };

/* The surface of `extract --iso V -o FILE` without further options, which is capped, has normals and
 * is checked. */
typedef struct cli_prediction {
    double iso;
    size_t vertices, triangles;  /* exact */
    char stem[CLI_STEM_TEXT];    /* of the output whose size is ply_bytes: a PLY holds it */
    size_t ply_bytes, stl_bytes; /* exact */
    size_t glb_bytes;            /* about; 0: more than the format allows, or no module */
    size_t memory_bytes, slices_bytes; /* of the program: all in memory; slice by slice */
    const char *needs_all;             /* option that keeps it from slices; NULL: none */
    bool is_streamed;                  /* --memory is too low for the first */
    double seconds;                    /* about; without waiting for the disk to write */
} cli_prediction;

typedef struct cli_predictions {
    cli_prediction items[CLI_MAX_NUMBERS];
    size_t count;
} cli_predictions;

/* Facts about a run of info that has read its volume. */
typedef struct cli_predict_desc {
    const cli_numbers *iso;
    const cli_input *input;
    size_t program_bytes; /* peak of the process before it read the volume */
    double read_seconds;  /* time that reading took */
} cli_predict_desc;

/* Returns the size of an STL file. */
size_t cli_stl_bytes(size_t triangles);

/* Predicts the surfaces at some isovalues. They are counted in memory if info has read all voxels and
 * --memory allows that, and slice by slice if not.
 *
 * volume   as info read it. If that is only a part of it, or too large, its voxels are freed, and
 *          all are read; as a whole only where slices are not read by themselves
 * Returns  CW_ERR_UNSUPPORTED for a sparse or an irregular grid. CW_ERR_LIMIT: --memory is too low
 *          to extract slice by slice, too */
CW_NODISCARD cw_status cli_predict(const cli_predict_desc *desc, cli_volume *volume,
                                   cli_predictions *out, cw_error *err);

/* Returns CW_ERR_EMPTY if there is no surface at one of the isovalues. */
CW_NODISCARD cw_status cli_expect_surfaces(const cli_volume *volume, const cli_predictions *p,
                                           cw_error *err);

void cli_print_predictions(const cli_predictions *p);
void cli_json_predictions(cli_json *j, const cli_predictions *p);

#endif
