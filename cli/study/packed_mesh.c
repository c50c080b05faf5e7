/* Packs a mesh into few bytes: positions of 16 bits as differences, corners relative to the
 * highest so far. Neighbours along the surface follow each other, so that most take one byte. */
#include "cli/study/packed_mesh.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES_OF_INTEGER = 5 };

static char *put_integer(char *at, uint32_t value)
{
    for (; value > 127; value >>= 7)
        *at++ = (char)(value | 128);
    *at++ = (char)value;
    return at;
}

static char *put_difference(char *at, int32_t value)
{
    return put_integer(at, value < 0 ? 2 * (uint32_t)(-(value + 1)) + 1 : 2 * (uint32_t)value);
}

/* Numbers vertices as corners name them: number[v] is that of v, order[n] the vertex with that.
 * Returns how many are named. */
static uint32_t number_vertices(const cw_mesh *mesh, uint32_t *number, uint32_t *order)
{
    uint32_t count = 0;
    memset(number, 0xff, mesh->vertex_count * sizeof *number);
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
        const uint32_t v = mesh->triangles[c];
        if (number[v] == UINT32_MAX) {
            order[count] = v;
            number[v] = count++;
        }
    }
    return count;
}

static int32_t quantise(const cw_mesh *mesh, uint32_t v, size_t axis, const cli_packed *p)
{
    const double extent = p->high[axis] - p->low[axis],
                 at = mesh->origin[axis] + (double)mesh->positions[3 * (size_t)v + axis] -
                      p->low[axis];
    return extent > 0 ? (int32_t)(at / extent * CLI_PACKED_STEPS + 0.5) : 0;
}

static char *put_positions(char *at, const cw_mesh *mesh, const uint32_t *order,
                           const cli_packed *p)
{
    int32_t before[3] = {0};
    for (size_t n = 0; n < p->vertices; n++)
        for (size_t axis = 0; axis < 3; axis++) {
            const int32_t here = quantise(mesh, order[n], axis, p);
            at = put_difference(at, here - before[axis]);
            before[axis] = here;
        }
    return at;
}

static char *put_corners(char *at, const cw_mesh *mesh, const uint32_t *number)
{
    uint32_t next = 0; /* the lowest number that no corner had so far */
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
        const uint32_t n = number[mesh->triangles[c]];
        at = put_integer(at, next - n);
        next += n == next;
    }
    return at;
}

cw_status cli_pack_mesh(const cw_mesh *mesh, const uint8_t *values, cli_packed *p,
                        cw_error *err)
{
    uint32_t *number = cwi_alloc_array(mesh->vertex_count, sizeof *number),
             *order = cwi_alloc_array(mesh->vertex_count, sizeof *order);
    const size_t capacity =
        (3 * mesh->vertex_count + 3 * mesh->triangle_count) * MAX_BYTES_OF_INTEGER +
        mesh->vertex_count + 1;
    *p = (cli_packed){.triangles = mesh->triangle_count,
                      .has_bytes = values,
                      .bytes = number && order ? malloc(capacity) : NULL};
    if (p->bytes) {
        char *at = p->bytes;
        cw_mesh_bounds(mesh, p->low, p->high);
        p->vertices = number_vertices(mesh, number, order);
        at = put_positions(at, mesh, order, p);
        for (size_t n = 0; n < p->vertices && values; n++)
            *at++ = (char)values[order[n]];
        at = put_corners(at, mesh, number);
        p->size = (size_t)(at - p->bytes);
    }
    cwi_free(number);
    cwi_free(order);
    if (!p->bytes)
        return cwi_fail_memory(err);
    char *fitting = realloc(p->bytes, p->size + 1);
    p->bytes = fitting ? fitting : p->bytes;
    return CW_OK;
}

void cli_free_packed(cli_packed *packed)
{
    free(packed->bytes);
    *packed = (cli_packed){0};
}
