/* Puts vertices of triangles that cross back, and looks again around them; then lets other vertices
 * make up for the volumes. */
#include "extract/labels/label_untangle.h"

#include "core/base/memory.h"

#include <string.h>

/* How often volumes are made up for, and in how many rounds each time. */
enum { REPAIRS = 4, REPAIR_ROUNDS = 4 };

/* The fraction of its volume that a label may lack when all is done, or nothing more can be. The
 * promise is more than that; less would move many vertices for little. */
static const double MAX_DEFICIT = 4.5e-3;

/* Places a vertex in the world. */
static void place_vertex(const cwi_label_crossings *c, cw_mesh *mesh, size_t v,
                         const float *places)
{
    double index[3], point[3];
    for (int a = 0; a < 3; a++)
        index[a] = (double)places[3 * v + (size_t)a];
    c->to_point(c->context, index, point);
    for (int a = 0; a < 3; a++)
        mesh->positions[3 * v + (size_t)a] = (float)point[a];
}

/* Puts the vertices that were hit back to their positions before smoothing. Returns false if there
 * are none. */
static bool put_back(const cwi_label_crossings *c, cw_mesh *mesh, cwi_label_moves *moves)
{
    bool is_any = false;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        cwi_label_trim(v);
        if (!c->hits[v])
            continue;
        place_vertex(c, mesh, v, c->originals);
        if (moves) {
            memcpy(moves->places + 3 * v, c->originals + 3 * v, 3 * sizeof *moves->places);
            cwi_label_moves_mark(moves, v);
        }
        c->net->kinds[v] |= CWI_NET_BACK;
        is_any = true;
    }
    return is_any;
}

static cw_status untangle_queue(cwi_label_crossings *c, cw_mesh *mesh, cwi_label_moves *moves,
                                const cw_labels_desc *desc, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && c->queued > 0) {
        st = cwi_label_crossings_find(c, desc, err);
        if (st != CW_OK || !put_back(c, mesh, moves))
            break;
        cwi_label_crossings_renew(c);
    }
    return st;
}

/* Makes up for volumes, by vertices that are marked as hits, and queues the polygons around them. */
static cw_status repair_volumes(cwi_label_crossings *c, cw_mesh *mesh, cwi_label_pressures *p,
                                bool restores, bool *is_kept, const cw_labels_desc *desc,
                                cw_error *err)
{
    p->moves.moved = c->hits;
    cw_status st =
        cwi_label_pressures_keep(p, MAX_DEFICIT, 0, REPAIR_ROUNDS, is_kept, desc, err);
    if (st != CW_OK || *is_kept)
        return st;
    if (restores)
        cwi_label_pressures_restore_small(p, MAX_DEFICIT);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        if (c->hits[v])
            place_vertex(c, mesh, v, p->moves.places);
        cwi_label_trim(v);
    }
    cwi_label_crossings_renew(c);
    *is_kept = c->queued == 0 && restores;
    return CW_OK;
}

cw_status cwi_labels_untangle(cwi_label_crossings *crossings, cw_mesh *mesh,
                              cwi_label_pressures *pressures, const cw_labels_desc *desc,
                              cw_error *err)
{
    cwi_label_moves *moves = pressures ? &pressures->moves : NULL;
    bool is_kept = !pressures;
    cw_status st = cwi_label_crossings_init(crossings, desc, err);
    for (size_t n = 0; moves && n < moves->surfaces->patch_count; n++)
        moves->patches[n].is_changed = true; /* as diagonals are */
    if (st == CW_OK)
        st = untangle_queue(crossings, mesh, moves, desc, err);
    for (int n = 0; n < REPAIRS && st == CW_OK && !is_kept; n++) {
        st = repair_volumes(crossings, mesh, pressures, n == 1, &is_kept, desc, err);
        if (st == CW_OK && !is_kept)
            st = untangle_queue(crossings, mesh, moves, desc, err);
    }
    return st;
}
