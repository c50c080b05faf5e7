/* Surfaces that were read in pieces: their seams are closed. */
#ifndef FORMATS_MESH_JOIN_PIECES_H
#define FORMATS_MESH_JOIN_PIECES_H

#include "formats/mesh/mesh_reader.h"

/* The pieces of a mesh. Everything in it is borrowed. */
typedef struct cwi_mesh_pieces {
    const size_t
        *first; /* first vertex of each piece, and behind them the number of vertices */
    const uint32_t *group; /* of each piece: pieces of one group are joined */
    size_t count;
    const int64_t
        *ids; /* one per vertex: from 0 on what all pieces call it, else it has none; NULL: no
                           vertex has one */
} cwi_mesh_pieces;

/* Merges vertices of different pieces of a group that are at the same place to the bit: those with the
 * same id, or without ids those at open edges of their piece. Vertices of a piece that
 * has two at the place are left alone. The first one's attributes stay. Then leaves out vertices that no triangle names.
 *
 * in       counts memory that is used temporarily
 * mesh     in place
 * merged   set to the number of vertices that are one with another
 * Returns  CW_ERR_NO_MEMORY, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_join_pieces(cwi_mesh_input *in, const cwi_mesh_pieces *pieces,
                                       cw_mesh *mesh, size_t *merged, cw_error *err);

#endif
