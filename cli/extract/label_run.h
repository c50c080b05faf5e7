/* Declares the state and the steps of `extract --labels`. */
#ifndef CLI_EXTRACT_LABEL_RUN_H
#define CLI_EXTRACT_LABEL_RUN_H

#include "cli/extract/extract_run.h"
#include "cli/inputs/label_choice.h"
#include "cli/label_inputs/label_inputs.h"
#include "core/mesh/mesh_store.h"

#include <cubewright/labels.h>

/* The interfaces of a component of the volume; segments that overlap are in several. */
typedef struct cli_label_layer {
    uint32_t number;
    cw_label_surfaces surfaces;
    cw_label_change *changes; /* of cleaning, by label; or NULL */
    size_t change_count;
} cli_label_layer;

/* A label with its surface. */
typedef struct cli_label_item {
    cw_label label; /* complete; the name is the next field */
    char name[CLI_LABEL_NAME];
    const cli_label_layer *layer;
    size_t voxels;
    double volume_error; /* of its surface before simplification, as a fraction of its voxels'
                            volume; NAN: unknown, as it is open or voxels differ in size */
    cw_mesh mesh;        /* closed, unless open; empty where only interfaces are written */
    cw_pipeline_facts facts;
    double max_error_mm,
        rms_error_mm; /* measured from the surface before --simplify N, --lod; NAN: not */
} cli_label_item;

typedef struct cli_label_run {
    const cli_extract_args *args;
    cli_volume volume;       /* the input, or the first of several */
    cli_label_fields fields; /* of --probabilities; else empty */
    cw_volume grid;          /* of the voxels that --resample made, without them; else zeroed */
    cli_label_names names;
    cli_label_choice choice;
    double max_move; /* of smoothing, in voxels; 0: off */
    cli_label_layer *layers;
    size_t layer_count;
    cli_label_item *items; /* in rising order of layers and labels */
    size_t item_count;
    double error_mm;  /* of --simplify; 0: none */
    size_t target;    /* triangles of --simplify, or of the level of --lod at hand; 0: none */
    size_t triangles; /* of all interfaces */
    size_t extracted; /* of those before they were simplified; 0: they are not */
    cw_mesh *levels;  /* of --lod: item_count meshes a level */
    double (*level_errors)[2]; /* their largest and rms errors, mm */
    size_t level_count;
    cwi_mesh_store store; /* of the meshes of items, levels and interfaces */
    cli_outputs files;
    cli_report report;
    double start;
} cli_label_run;

/* Returns true if options clean the voxels of labels. */
bool cli_cleans_labels(const cli_extract_args *args);

/* Cleans the labels of a component, and extracts them. Returns as cw_labels_clean(), cw_extract_labels() */
CW_NODISCARD cw_status cli_clean_and_extract(const cli_label_run *run, const cw_volume *view,
                                             const cw_labels_desc *desc, cli_label_layer *layer,
                                             cw_error *err);

/* Says what cleaning changed, and which labels it removed. */
void cli_tell_cleaning(const cli_label_run *run);

/* Samples the labels of a component at other distances, says how, and which labels are lost by it.
 * desc     the labels to be extracted
 * sampled  filled on success; free it with cw_volume_free()
 * Returns  as cw_labels_resample() */
CW_NODISCARD cw_status cli_resample_labels(cli_label_run *run, const cw_volume *view,
                                           uint32_t layer, const cw_labels_desc *desc,
                                           cw_volume *sampled, cw_error *err);

/* Adds the number and the name of a label to a list; without room for them it ends with "...". */
enum { CLI_LABEL_LIST = 200 };
void cli_list_label(const cli_label_run *run, uint32_t layer, uint32_t value,
                    char list[CLI_LABEL_LIST]);

/* Names the fields that are the largest at no voxel, if all labels are to be extracted. */
void cli_tell_absent_fields(const cli_label_run *run);

/* Returns the voxels that are extracted: of the file, or those of --resample. */
const cw_volume *cli_label_grid(const cli_label_run *run);

/* Finds what cleaning changed of an item; NULL: nothing was cleaned. */
const cw_label_change *cli_find_label_change(const cli_label_item *item);
void cli_free_label_layer(cli_label_layer *layer);

/* Returns true for an output that has a file a label: it holds {label} or {name}. */
bool cli_has_file_a_label(const char *output);

/* Checks what can be refused before the input is read. */
CW_NODISCARD cw_status cli_check_label_args(const cli_extract_args *args, cw_error *err);

/* Names the output if all labels go into one file, and checks that it can be written. */
CW_NODISCARD cw_status cli_name_label_file(cli_label_run *run, cw_error *err);

/* Writes the meshes as level n of --lod, unless all levels are in one file. Then they belong to
 * the levels, which it keeps for that file. */
CW_NODISCARD cw_status cli_write_label_level(cli_label_run *run, size_t n, cw_error *err);

/* Writes the file of all levels of --lod, which glTF and neuroglancer have. */
CW_NODISCARD cw_status cli_write_label_levels(cli_label_run *run, cw_error *err);

/* Writes the meshes, or with --shared-faces the interfaces, and tells of them. */
CW_NODISCARD cw_status cli_write_labels(cli_label_run *run, cw_error *err);

/* Measures the surfaces of labels against the volumes of their voxels. */
CW_NODISCARD cw_status cli_measure_label_volumes(cli_label_run *run, cw_error *err);

/* Names the labels whose volume smoothing does not keep to 0.5 %. */
CW_NODISCARD cw_status cli_tell_label_volumes(const cli_label_run *run, cw_error *err);

/* Writes the table of labels that --table asks for. */
CW_NODISCARD cw_status cli_write_label_table(const cli_label_run *run, cw_error *err);

/* Of the report: the settings, and the labels. p is the run. */
void cli_put_label_params(cli_json *j, const void *p, const cli_made *made);
void cli_put_labels(cli_json *j, const void *p);

/* Runs the command with --labels. */
CW_NODISCARD cw_status cli_extract_labels(const cli_extract_args *args, cw_error *err);

#endif
