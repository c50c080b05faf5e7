/* A label map: the surface of each label, measured and drawn. */
#ifndef CLI_STUDY_LABEL_STUDY_H
#define CLI_STUDY_LABEL_STUDY_H

#include "cli/inputs/label_scene.h"
#include "cli/study/study.h"

/* Maximum of pictures, of the labels with the most voxels; and of labels in the view of three
 * dimensions. */
enum { CLI_LABEL_PICTURES = 48, CLI_LABEL_COLORS = 256 };

typedef struct cli_label_row {
    const cw_label *label; /* borrowed from the scene */
    size_t voxels;
    double voxels_mm3; /* the volume of those */
    size_t triangles, components;
    bool closed;
    double mesh_mm3, area_mm2; /* that the surface encloses; of the surface */
    cli_png drawn;
} cli_label_row;

typedef struct cli_label_study {
    cli_study study; /* of the volume */
    const cli_input *input;
    size_t step; /* of the volume */
    cli_label_scene scene;
    cli_label_row *rows; /* of the scene's labels, in their order; owned */
    size_t layers;       /* components that have labels */
    size_t triangles;    /* of all interfaces, each counted once */
    double extract_seconds;
    cli_png all;       /* all labels in one picture */
    cli_packed packed; /* the same to be turned; its bytes are numbers of rows */
} cli_label_study;

/* Extracts, measures and draws the labels of study.volume. Free with cli_free_label_study(),
 * also after failure.
 * Returns  as cli_find_shown_labels() and cw_extract_labels() */
CW_NODISCARD cw_status cli_study_labels(cli_label_study *study, const cli_label_look *look,
                                        cli_volume *volume, cw_error *err);
void cli_free_label_study(cli_label_study *study);

void cli_put_label_json(FILE *out, const void *study);

#endif
