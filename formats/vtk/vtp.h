/* The elements of VTK's XML PolyData, shared by the file that finds them and those that read their
 * numbers. */
#ifndef FORMATS_VTK_VTP_H
#define FORMATS_VTK_VTP_H

#include "formats/mesh/mesh_reader.h"
#include "formats/vtk/vtk_sides.h"
#include "formats/vtk/vtk_xml.h"

/* The arrays that are read. */
typedef enum cwi_vtp_role {
    CWI_VTP_POINTS,
    CWI_VTP_POLYGONS,     /* corners of polygons, one after another */
    CWI_VTP_POLYGON_ENDS, /* and the end of each polygon among them */
    CWI_VTP_STRIPS,
    CWI_VTP_STRIP_ENDS,
    CWI_VTP_NORMALS,
    CWI_VTP_COLORS,
    CWI_VTP_SCALARS,
    CWI_VTP_LABELS,
    CWI_VTP_IDS,         /* numbers that points have in all pieces together */
    CWI_VTP_CELL_COLORS, /* of CellData: vertices, lines, polygons, strips */
    CWI_VTP_CELL_MARKS,  /* vtkGhostType, or vtkGhostLevels of older files */
    CWI_VTP_ROLE_COUNT
} cwi_vtp_role;

/* A Piece. */
typedef struct cwi_vtp_piece {
    cwi_vtk_xml file; /* of the file that holds it */
    size_t side;      /* number of that file in a list */
    uint32_t group;   /* pieces of one group are joined */
    cwi_vtk_array arrays[CWI_VTP_ROLE_COUNT];
    bool has[CWI_VTP_ROLE_COUNT];
    int64_t points, polygons, strips, skipped;             /* skipped: vertices and lines */
    char normals[CWI_WORD_BYTES], scalars[CWI_WORD_BYTES]; /* names stated by PointData */
    char ids[CWI_WORD_BYTES];
    char cell_scalars[CWI_WORD_BYTES]; /* name stated by CellData */
    bool marks_are_levels;             /* they are vtkGhostLevels */
    double origin[3];                  /* of a local file that our writer made */
} cwi_vtp_piece;

/* The pieces of a file, or of those that it lists. Zeroed, it has none. */
typedef struct cwi_vtp {
    cwi_vtp_piece *pieces;
    size_t count, capacity;
    bool is_list;       /* the file lists others: */
    cwi_names names;    /* of those */
    cw_mesh_file facts; /* of all files: what comments of our writer say */

    /* The file that is parsed. */
    cwi_vtk_xml file;
    bool is_side, ours;
    cw_mesh frame;       /* its origin */
    cwi_vtk_array *open; /* the next tag ends its text; NULL: none */
} cwi_vtp;

/* Parses a file, and adds its pieces; side and group are theirs. A side is no list.
 * Returns  CW_ERR_FORMAT, also when it states another unit or frame than the ones before */
CW_NODISCARD cw_status cwi_vtp_parse(cwi_vtp *v, const cwi_input *in, size_t side,
                                     uint32_t group, cw_error *err);
void cwi_vtp_free(cwi_vtp *v);

/* Reads the meshes of all pieces, and joins those of a group.
 * sides   the files of a list; NULL: there is one file
 * bytes   of all files
 * names   of groups, which become parts; NULL: they have none */
CW_NODISCARD cw_status cwi_vtp_load(const cwi_vtp *v, cwi_vtk_sides *sides, uint64_t bytes,
                                    const cwi_names *names, cwi_mesh_input *in, cw_mesh *mesh,
                                    cw_mesh_file *metadata, cw_error *err);

#endif
