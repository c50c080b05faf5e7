/* Takes levels of detail from a pipeline. */
#include "cli/assets/taken_levels.h"

#include "cli/inputs/place_options.h"

/* Keeps a level, unless it is the one before again. */
static void keep_level(cli_taken_levels *t, size_t asked, cw_mesh *mesh,
                       const cw_pipeline_facts *facts)
{
    const size_t n = t->count;
    if (n && t->drops_equal && t->levels[n - 1].triangle_count == mesh->triangle_count)
        return;
    t->lod.n[n] = asked;
    t->facts[n] = *facts;
    t->levels[n] = *mesh;
    t->triangles += mesh->triangle_count;
    t->count++;
    *mesh = (cw_mesh){0};
}

static cw_status take_level(void *user, cw_pipeline_surface *surface,
                            const cw_pipeline_facts *facts, cw_error *err)
{
    cli_taken_levels *t = user;
    cw_status st = surface->maps && surface->level == 0
                       ? cli_encode_maps(surface->maps, &t->maps, err)
                       : CW_OK;
    if (st != CW_OK)
        return st;
    keep_level(t, t->lod.n[surface->level], surface->mesh, facts);
    if (surface->level + 1 < t->lod.count)
        return CW_OK;
    t->lod.count = t->count;
    t->full = *surface->full;
    *surface->full = (cw_mesh){0};
    return CW_OK;
}

cw_pipeline_sink cli_level_sink(cli_taken_levels *taken)
{
    return (cw_pipeline_sink){take_level, taken};
}

cw_status cli_move_taken(cli_taken_levels *t, int pivot, double moved[3], cw_error *err)
{
    cw_status st = cli_move_to_pivot(pivot, t->levels, 1, moved, err);
    const double map[12] = {1, 0, 0, moved[0], 0, 1, 0, moved[1], 0, 0, 1, moved[2]};
    for (size_t n = 1; n < t->count && st == CW_OK; n++)
        st = cw_mesh_transform(&t->levels[n], map, err);
    return st == CW_OK ? cw_mesh_transform(&t->full, map, err) : st;
}

void cli_free_taken(cli_taken_levels *t)
{
    cw_mesh_free(&t->full);
    cli_free_maps(&t->maps);
}
