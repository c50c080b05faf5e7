/* Levels of detail of one mesh: a file each and, in formats that hold levels, a file with all. */
#ifndef CLI_RESULTS_DETAIL_LEVELS_H
#define CLI_RESULTS_DETAIL_LEVELS_H

#include "cli/assets/texture_options.h"
#include "cli/results/mesh_parts.h"
#include "cli/results/output_names.h"

/* The levels of --lod on their way from a mesh to files, and the steps of the command that makes
 * them. Zero it, and set the first fields. Free it with cli_free_detail_levels(). */
typedef struct cli_detail_levels {
    const cli_counts *lod;    /* those that `make` makes: it may leave some out */
    const char *name;         /* of the object inside the file of all; NULL: that file's */
    const cli_outputs *files; /* as cli_name_detail_levels() names them */
    cli_report *report;       /* with room for a mesh more than levels */
    const cli_pieces *pieces; /* the mesh is the only piece, at the latest after `make` */
    bool keeps_border;        /* the border of the mesh stays as it is */
    bool is_budget;           /* more triangles than asked for are an error, no warning */
    const cli_maps *maps;     /* of all levels, made with them; NULL: none */
    /* Makes the meshes of all levels, when the report has begun that of the first. */
    cw_status (*make)(void *user, cw_mesh *levels, cw_error *err);
    /* Checks, measures and shades a level. */
    cw_status (*finish)(void *user, cli_made *made, cw_mesh *level, cw_error *err);
    /* Writes a file: a level, or all where `file` is the number of levels. A level without a path has
     * no file of its own, but a line. */
    cw_status (*deliver)(void *user, size_t file, const cw_part *parts, size_t count,
                         cw_error *err);
    void *user;
    cw_mesh mesh[CLI_MAX_COUNTS];
    bool is_unordered; /* it was told that meshoptimizer is not there */
} cli_detail_levels;

/* Names the files of levels, as cli_name_lod_outputs() does: formats that hold levels get both
 * kinds, or with `together` one file with all. format: of --format, or NULL. Free them with
 * cli_free_outputs(). */
CW_NODISCARD cw_status cli_name_detail_levels(cli_outputs *files, const char *output,
                                              const char *format, const char *input,
                                              const cli_counts *lod, bool together,
                                              cw_error *err);

/* Makes, finishes and delivers the levels, each in the order that is fast to draw. The report
 * gets a mesh a level, lod0, lod1 and so on, and `all` for the file of all. */
CW_NODISCARD cw_status cli_make_detail_levels(cli_detail_levels *d, cw_error *err);

/* Harmless on zeroed ones. */
void cli_free_detail_levels(cli_detail_levels *d);

/* Says that a mesh had no more triangles than it should get, or warns that more are left. */
void cli_report_missed(cli_report *report, const cli_pieces *pieces, size_t target,
                       size_t triangles, bool keeps_border);

/* The handles of a surface; 0: none, or not known. closed_mm: as of cli_pieces */
typedef struct cli_handles_left {
    size_t count;
    double closed_mm;
} cli_handles_left;

/* Warns that more triangles are left than requested, and says what would let fewer do. */
void cli_report_left(cli_report *report, size_t target, size_t triangles,
                     cli_handles_left handles, bool keeps_border);

/* Writes the key `lod`: the triangles asked for. */
void cli_json_lod(cli_json *j, const cli_counts *lod);

#endif
