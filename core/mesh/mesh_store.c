/* Moves the arrays of meshes to blocks, one behind the other. */
#include "core/mesh/mesh_store.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh_attributes.h"

#include <string.h>

enum { BLOCK = 32 << 20, ALIGNMENT = 64 }; /* bytes */

/* Finds array n of those that move: positions, normals, triangles and the attributes. Returns NULL behind
 * the last. */
static void **find_array(cw_mesh *mesh, size_t n, size_t *bytes)
{
    const size_t vertex = 3 * sizeof(float), triangle = 3 * sizeof(uint32_t);
    void **fixed[] = {(void **)&mesh->positions, (void **)&mesh->normals,
                      (void **)&mesh->triangles};
    *bytes = n == 2 ? mesh->triangle_count * triangle : mesh->vertex_count * vertex;
    if (n < 3)
        return fixed[n];
    if (n - 3 >= mesh->attribute_count)
        return NULL;
    cw_attribute *a = &mesh->attributes[n - 3];
    *bytes = cwi_attribute_elements(mesh, a->on) * cwi_attribute_bytes(a);
    return &a->data;
}

static size_t round_up(size_t bytes)
{
    return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Reserves bytes in the last block, or a new one. Returns false when memory is out. */
static bool reserve_bytes(cwi_mesh_store *s, size_t bytes)
{
    if (bytes <= s->room)
        return true;
    const size_t size = bytes > BLOCK ? bytes : BLOCK;
    char **longer = cwi_grow_array(s->blocks, s->count, &s->capacity, sizeof *s->blocks);
    s->blocks = longer ? longer : s->blocks;
    char *block = longer ? cwi_alloc_large(size, 1) : NULL;
    if (!block)
        return false;
    s->blocks[s->count++] = s->next = block;
    s->room = size;
    return true;
}

cw_status cwi_mesh_store_keep(cwi_mesh_store *s, cw_mesh *from, cw_mesh *kept, cw_error *err)
{
    size_t bytes, total = 0;
    void **array;
    for (size_t n = 0; s->is_used && (array = find_array(from, n, &bytes)); n++)
        total += *array ? round_up(bytes) : 0;
    if (!reserve_bytes(s, total))
        return cwi_fail_memory(err);
    for (size_t n = 0; s->is_used && (array = find_array(from, n, &bytes)); n++) {
        if (!*array)
            continue;
        memcpy(s->next, *array, bytes);
        cwi_free(*array);
        *array = s->next;
        s->next += round_up(bytes);
        s->room -= round_up(bytes);
    }
    *kept = *from;
    *from = (cw_mesh){0};
    cwi_memory_trim();
    return CW_OK;
}

void cwi_mesh_store_release(const cwi_mesh_store *s, cw_mesh *kept)
{
    size_t bytes;
    void **array;
    for (size_t n = 0; s->is_used && (array = find_array(kept, n, &bytes)); n++)
        *array = NULL;
    cw_mesh_free(kept);
}

void cwi_mesh_store_free(cwi_mesh_store *s)
{
    for (size_t n = 0; n < s->count; n++)
        cwi_free(s->blocks[n]);
    cwi_free(s->blocks);
    *s = (cwi_mesh_store){0};
}
