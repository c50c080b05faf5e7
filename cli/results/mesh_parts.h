/* A mesh that is made smaller part by part, so that parts stay apart: what goes in, what comes
 * out, and what one has to do with the other. Errors name the file. */
#ifndef CLI_RESULTS_MESH_PARTS_H
#define CLI_RESULTS_MESH_PARTS_H

#include "cli/inputs/mesh_input.h"
#include "cli/results/run_report.h"

typedef struct cli_piece {
    cw_mesh input; /* its arrays are those of the cli_mesh, welded, unless owns_input */
    bool owns_input;
    const char *name;
    const cw_label *label;       /* that of the part; borrowed */
    const cw_textures *textures; /* the same */
    cw_quality before;           /* of the input */
    cw_mesh out;                 /* owned */
} cli_piece;

typedef struct cli_pieces {
    const char *path; /* of the file */
    cli_piece *piece;
    size_t count, triangles;     /* these of all, before */
    size_t merged, dropped;      /* vertices; components */
    double diagonal_mm;          /* of the box of all, as they were read */
    const cw_textures *textures; /* of all in place of their own, borrowed; NULL: none */
    double closed_mm;            /* handles with loops up to this were closed; 0: none were */
} cli_pieces;

/* Makes a piece of each part that has triangles, vertices at equal positions one, and says so.
 * Free it, also after failure, with cli_free_pieces().
 * Returns  CW_ERR_EMPTY when there are no triangles */
CW_NODISCARD cw_status cli_weld_pieces(cli_pieces *p, const cli_mesh *mesh, cw_error *err);

/* Makes a piece of each part that has triangles, as it is. Free it, also after failure, with
 * cli_free_pieces().
 * Returns  CW_ERR_EMPTY when there are no triangles */
CW_NODISCARD cw_status cli_take_pieces(cli_pieces *p, const cli_mesh *mesh, cw_error *err);

/* Makes one piece of a surface, as it is. The piece borrows its arrays, and `path`. Free it, also
 * after failure, with cli_free_pieces(). CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_take_surface(cli_pieces *p, const char *path, const cw_mesh *mesh,
                                        cw_error *err);

/* Leaves out components whose box has a shorter diagonal, and says how many.
 * Returns  CW_ERR_EMPTY when nothing is left */
CW_NODISCARD cw_status cli_drop_from_pieces(cli_pieces *p, double diagonal_mm, cw_error *err);

/* Closes small handles of what goes in, and says how many.
 * length_mm  of the longest loop; 0: CW_HANDLE_FRACTION of the diagonal of all
 * facts      of all pieces together */
CW_NODISCARD cw_status cli_close_handles(cli_pieces *p, double length_mm, int threads,
                                         cw_close_handles_facts *facts, cw_error *err);

/* Returns the handles of what goes in, once it was looked at. */
size_t cli_count_handles(const cli_pieces *p);

/* Looks at what goes in, for cli_hold_pieces(). */
CW_NODISCARD cw_status cli_measure_pieces(cli_pieces *p, int threads, cw_error *err);

/* Fails when what came out has another topology. */
CW_NODISCARD cw_status cli_hold_pieces(const cli_pieces *p, int threads, cw_error *err);

/* Measures how far what came out is from what went in, and the way back.
 * Returns  CW_ERR_CHECK when that is more than c->promised_mm */
CW_NODISCARD cw_status cli_compare_pieces(const cli_pieces *p, int threads, cli_comparison *c,
                                          cw_error *err);

/* Finds a length in mm, 0 where none is given. Shares are of the diagonal of all; voxels are those from
 * which the first piece came, by their mean side.
 * option   is named in the error
 * Returns  CW_ERR_ARGUMENT for voxels that the file does not tell */
CW_NODISCARD cw_status cli_find_length(const cli_pieces *p, const char *option,
                                       const cli_length *length, double *mm, cw_error *err);

/* Lists what came out as parts to write; free the list with free(). */
CW_NODISCARD cw_status cli_list_parts(const cli_pieces *p, cw_part **parts, cw_error *err);

/* Harmless on zeroed ones. */
void cli_free_pieces(cli_pieces *p);

#endif
