/* Pieces for a printer: a solid cut by planes, pegs or dowels between the pieces, and pieces laid on plates. */
#ifndef CUBEWRIGHT_PIECES_H
#define CUBEWRIGHT_PIECES_H

#include <cubewright/cut.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maximum of planes. */
#define CW_MAX_CUT_PLANES 256

/* The attribute of a piece that tells its flat sections: CW_ON_TRIANGLES, CW_U32, the number of the plane
 * from 1; 0 elsewhere. */
#define CW_SECTION_ATTRIBUTE "section"

/* How a solid is cut to pieces. Zero-initialise the struct and set what you need; a zero field means the
 * default named beside it. */
typedef struct cw_pieces_desc {
    uint32_t version; /* 0: the first version of this struct */
    size_t pegs;      /* for each region of each section; default: none */
    bool dowels;      /* default: pegs of one piece go into holes of its neighbour. Else both
                                have holes, and dowels are pieces of their own */
    double
        peg_diameter_mm;  /* default: 8, or less where the widest region has no room for them */
    double peg_length_mm; /* beyond the section; of a dowel as a whole. Default: 1.5 diameters,
                                of a dowel 3 */
    double
        clearance_mm; /* between a peg and the side of its hole, and its bottom; default: 0.2 */
    double wall_mm;   /* minimum of material around holes; default: a quarter of the diameter */
    double max_automatic_mm; /* maximum of the default diameter; default: 8 */
    int threads;             /* default: one per processor; the pieces do not depend on it */
    cw_progress progress;    /* default: none */
} cw_pieces_desc;

/* A piece, or a dowel. */
typedef struct cw_piece {
    cw_mesh mesh;       /* closed, with CW_SECTION_ATTRIBUTE if planes cut it */
    char name[32];      /* piece-1, piece-2 and so on; then dowel-1 ... */
    bool is_dowel;      /* else it is material of the whole */
    double volume_mm3;  /* that it encloses */
    size_t pegs, holes; /* of this piece */
    double
        placed[12]; /* 3 x 4, row by row: the map from its place in the whole to the one that it
                           has now; at first the identity */
    size_t plate;   /* on which cw_pieces_lay() put it, from 1; 0: it is not laid */
    double foot_mm2; /* area on that plate */
} cw_piece;

/* The section between two neighbouring pieces. */
typedef struct cw_piece_section {
    size_t plane;    /* from 0 */
    size_t below;    /* number of the piece on the other side */
    size_t above;    /* number of the pieces, from 0; the plane's normal points to `above` */
    double area_mm2; /* of all regions */
    size_t regions;  /* that are not connected */
    size_t pegs;     /* that were placed, of regions x pegs that were requested */
    double
        widest_mm; /* the largest diameter of a peg that its regions have room for; 0 or less:
                         none, as the clearance takes all of it */
} cw_piece_section;

/* A peg or dowel, where it is in the whole. */
typedef struct cw_peg {
    size_t section;      /* from 0 */
    double center[3];    /* in the section, world, mm */
    double direction[3]; /* of length 1, from the piece below to the one above */
    double diameter_mm;  /* of the peg; its hole is wider by twice the clearance */
    double length_mm;    /* may be shorter than requested, where the material ends */
} cw_peg;

/* The pieces of a solid. A zeroed struct is valid and empty. */
typedef struct cw_pieces {
    uint32_t version;           /* 0: the first version of this struct */
    size_t count;               /* number of pieces */
    cw_piece *pieces;           /* those of the whole first, then dowels */
    size_t section_count;       /* number of sections */
    cw_piece_section *sections; /* where two pieces meet */
    size_t peg_count;           /* number of pegs or dowels */
    cw_peg *pegs;               /* those that had room */
    cw_pieces_desc settings;    /* with the defaults that were used; progress is none */
    double whole_mm3;           /* what the solid enclosed, overlaps once */
    double pieces_mm3;          /* the sum of all, dowels included */
    double gaps_mm3;  /* clearance around pegs: what the holes have more than the pegs */
    size_t shortened; /* pegs that are shorter than requested */
    size_t missing;   /* pegs that had no room */
} cw_pieces;

/* Cuts a solid by planes and keeps all pieces.
 *
 * A piece is all material in one cell between the planes, also where it is not connected; a cell without
 * material gives none. Pieces are closed manifolds that do not cross themselves, as those of
 * cw_mesh_boolean(): overlaps of the solid are united. The order is that of the planes: below the first
 * one comes first, and among these below the second, and so on. Below is against the normal. Neighbours
 * have the same triangles in the section between them. Normals and texture coordinates are left out.
 *
 * With `pegs`, each connected region of each section gets that many, far from its border and from each
 * other. The piece below has the peg, which tapers at its tip, and the piece above the hole. Every hole keeps
 * wall_mm to all other surface; where the material is too thin, the peg moves, or becomes shorter, down to a
 * third, or is left out and counted.
 *
 * mesh     borrowed; closed
 * planes   count of them, borrowed; leave_open and progress are not used
 * count    0 to CW_MAX_CUT_PLANES; 0 gives the whole as one piece
 * desc     borrowed; NULL means all defaults
 * out      zeroed before; filled on success, emptied on failure; free it with cw_pieces_free()
 *
 * Returns  CW_ERR_ARGUMENT  a plane does not meet the mesh (the message has the range that does), has no
 *                           normal or is not finite; a length is negative or not finite; or as
 *                           cw_mesh_check()
 *          CW_ERR_EMPTY     the mesh encloses nothing
 *          CW_ERR_CHECK     pegs were requested, and none has room: the message has the largest that has;
 *                           the mesh is open; or as cw_mesh_boolean()
 *          CW_ERR_LIMIT; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     a boolean for each piece that a plane cuts, and two for each piece with pegs
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   distances to the border [Felzenszwalb2012] */
CW_NODISCARD CW_API cw_status cw_pieces_cut(const cw_mesh *mesh, const cw_cut_desc *planes,
                                            size_t count, const cw_pieces_desc *desc,
                                            cw_pieces *out, cw_error *err);

/* Frees all that the pieces hold and zeroes the struct. Harmless on zeroed ones. */
CW_API void cw_pieces_free(cw_pieces *pieces);

/* A plate that pieces have to fit. Zero fields mean the default named beside them. */
typedef struct cw_plate_desc {
    uint32_t version;   /* 0: the first version of this struct */
    double plate_mm[3]; /* width, depth and height, along x, y and z; required */
    double reserve_mm;  /* length of a peg that stands out of a piece; default: none does */
} cw_plate_desc;

/* Plans cuts across the axes, so that all pieces fit on a plate: equal parts along each axis along which
 * the mesh is longer.
 *
 * mesh     borrowed
 * desc     borrowed
 * planes   set to an array, first across x, then y and z, from low to high; free it with
 *          cw_planes_free(). NULL if nothing is to cut
 * count    set to their number
 * Returns  CW_ERR_ARGUMENT  a side of the plate is not above 0 or not above the reserve, or as
 *                           cw_mesh_check()
 *          CW_ERR_LIMIT     more than CW_MAX_CUT_PLANES; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_plate_planes(const cw_mesh *mesh, const cw_plate_desc *desc,
                                              cw_cut_desc **planes, size_t *count,
                                              cw_error *err);

/* Frees an array of planes. NULL is allowed. */
CW_API void cw_planes_free(cw_cut_desc *planes);

/* How pieces are laid. Zero fields mean the default named beside them. */
typedef struct cw_lay_desc {
    uint32_t version;   /* 0: the first version of this struct */
    double plate_mm[3]; /* default: one plate, as large as needed */
    double
        gap_mm; /* between pieces; default: 5, or a tenth of the plate's shorter side if that is
                           less; without a plate a twentieth of the largest piece */
} cw_lay_desc;

/* Lays pieces on plates: each is turned so that its largest section without pegs lies on z = 0, or else its
 * largest flat side, as far as it then fits; and put beside the others, deep ones first. Plates stand in a row
 * along x, a gap apart; the first begins at x = y = 0. Places are rounded to floats, and pieces are sound after that.
 *
 * pieces   in place: meshes, placed, plate and foot_mm2
 * desc     borrowed; NULL means all defaults
 * plates   set to their number; may be NULL
 * Returns  CW_ERR_ARGUMENT  a length is negative or not finite, or some sides of a plate are 0
 *          CW_ERR_CHECK     a piece is larger than the plate: the message names it; or as
 *                           cw_mesh_boolean()
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_pieces_lay(cw_pieces *pieces, const cw_lay_desc *desc,
                                            size_t *plates, cw_error *err);

/* Facts on pieces that are put together again. Volumes are sampled: along 3 x 400 x 400 lines at most. */
typedef struct cw_assembled {
    uint32_t version;     /* 0: the first version of this struct */
    double whole_mm3;     /* inside of the whole */
    double assembled_mm3; /* inside of at least one piece */
    double overlap_mm3;   /* inside of more than one: what would not go together */
    double missing_mm3;   /* inside of the whole and of no piece: the clearance around pegs */
    double beyond_mm3;    /* inside of a piece and not of the whole */
    double
        farthest_mm; /* the largest distance from the whole's surface to that of the pieces */
    size_t lines;    /* that meet the whole */
} cw_assembled;

/* Puts pieces together again, each at its place in the whole, and measures them beside the whole: along lines
 * in three directions, and from the surface of the whole.
 *
 * pieces    borrowed
 * whole     borrowed; the mesh that was cut
 * threads   0: one per processor
 * progress  NULL: none
 * out       zeroed before; filled on success
 * Returns  as cw_mesh_boolean() and cw_distance_to_mesh()
 * Cost     in proportion to the triangles, and to the lines that they meet */
CW_NODISCARD CW_API cw_status cw_pieces_assemble(const cw_pieces *pieces, const cw_mesh *whole,
                                                 int threads, const cw_progress *progress,
                                                 cw_assembled *out, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
