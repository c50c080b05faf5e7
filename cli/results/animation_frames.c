/* Collects the surfaces of the steps of an animation, with their times, and counts their
 * bytes. */
#include "cli/results/animation_frames.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>

cw_status cli_frames_reserve(cli_frames *f, size_t count, cw_error *err)
{
    f->frames = calloc(count, sizeof *f->frames);
    f->parts = calloc(count, sizeof *f->parts);
    f->capacity = count;
    return f->frames && f->parts ? CW_OK : cwi_fail_memory(err);
}

void cli_frames_free(cli_frames *f)
{
    for (size_t n = 0; n < f->count; n++)
        cw_mesh_free(&f->frames[n].mesh);
    free(f->frames);
    free(f->parts);
    *f = (cli_frames){0};
}

/* Of positions, normals and triangles, which is what extraction makes. */
static size_t bytes_of(const cw_mesh *mesh)
{
    return mesh->vertex_count * (mesh->normals ? 24 : 12) + mesh->triangle_count * 12;
}

void cli_frames_add(cli_frames *f, cw_mesh *mesh, const cli_moment *moment,
                    double steps_a_second)
{
    const size_t n = f->count++;
    struct cli_frame *frame = &f->frames[n];
    frame->mesh = *mesh;
    *mesh = (cw_mesh){0};
    f->empty += frame->mesh.triangle_count == 0;
    f->bytes += bytes_of(&frame->mesh);
    snprintf(frame->name, sizeof frame->name, "step %zu", moment->number);
    f->parts[n] =
        (cw_part){.mesh = &frame->mesh,
                  .name = frame->name,
                  .time_s = steps_a_second > 0 ? (double)n / steps_a_second : moment->time_s};
}
