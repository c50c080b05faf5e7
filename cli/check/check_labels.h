/* Checks files of several solids that share their interfaces, such as labels: each by itself, and how they
 * meet. */
#ifndef CLI_CHECK_CHECK_LABELS_H
#define CLI_CHECK_CHECK_LABELS_H

#include "cli/check/check_run.h"

/* One solid of a file. */
typedef struct cli_part_check {
    cw_mesh mesh;   /* owned unless it is borrowed */
    cw_label label; /* name and number; a file without labels has neither layer nor colour */
    char name[128];
    bool has_label;
    cw_quality quality;
    size_t voxels;    /* of the source's label; 0: not known */
    double voxel_mm3; /* volume of those */
    double max_mm;    /* from the source's label; NAN: not measured */
} cli_part_check;

/* The solids of a file. Zeroed: it is one mesh. Free with cli_free_part_checks(). */
typedef struct cli_part_checks {
    size_t count;
    cli_part_check *items;
    cli_mesh parts; /* that items borrow; or zeroed */
    bool of_labels; /* all have labels */
    cw_contacts contacts;
    cw_crossings crossings; /* between solids */
    bool has_crossings;
} cli_part_checks;

/* Finds the solids of the file that was read: by labels, or the parts that share triangles.
 * Returns CW_ERR_NO_MEMORY; as cw_parts_read() */
CW_NODISCARD cw_status cli_find_part_checks(cli_check_run *run, cli_part_checks *solids,
                                            cw_error *err);
void cli_free_part_checks(cli_part_checks *solids);

/* Measures each solid, and how they meet; the run gets the verdicts of all, and sums.
 * Returns as cli_check_measure() */
CW_NODISCARD cw_status cli_check_parts(cli_check_run *run, cli_part_checks *solids,
                                       cw_error *err);

/* Adds "solids" to the report: each with its measurements. */
void cli_json_part_checks(cli_json *j, const cli_part_checks *solids);

#endif
