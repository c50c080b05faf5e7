/* Keeps the pictures of a mesh file, and reads those that lie beside it. */
#include "formats/mesh/picture_store.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>
#include <unistd.h>

/* Files of pictures that no mesh has more of. */
enum { MAX_PICTURES = 4096 };

/* Bytes of a picture's file. */
static const uint64_t MAX_BYTES = (uint64_t)1 << 30;

const cw_texture *cwi_picture_find(const cwi_pictures *p, const char *name)
{
    for (size_t n = 0; n < p->count; n++)
        if (strcmp(p->items[n].name, name) == 0)
            return &p->items[n].file;
    return NULL;
}

cw_status cwi_picture_add(cwi_mesh_input *in, const char *name, uint8_t *bytes, size_t size,
                          cw_texture *picture, cw_error *err)
{
    cwi_pictures *p = &in->pictures;
    char *copy = cwi_strdup(name);
    cw_status st = copy ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && p->count >= MAX_PICTURES)
        st = cwi_fail(err, CW_ERR_LIMIT, "more than %d pictures", MAX_PICTURES);
    if (st == CW_OK)
        st = cwi_mesh_take_bytes(in, size, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(in, &p->items, &p->capacity, p->count + 1, sizeof *p->items, err);
    if (st != CW_OK) {
        cwi_free(copy);
        cwi_free(bytes);
        return st;
    }
    *picture = (cw_texture){bytes, size};
    p->items[p->count++] = (cwi_picture){copy, *picture};
    return CW_OK;
}

/* Reads a whole file that was opened. */
static cw_status read_whole(int fd, uint64_t size, uint8_t **bytes, cw_error *err)
{
    size_t got = 0;
    *bytes = cwi_alloc_array((size_t)size, 1);
    if (!*bytes)
        return cwi_fail_memory(err);
    cw_status st = cwi_input_read_at(fd, 0, *bytes, (size_t)size, &got, err);
    if (st == CW_OK && got < size)
        st = cwi_fail(err, CW_ERR_IO, "a picture became shorter while it was read");
    if (st != CW_OK) {
        cwi_free(*bytes);
        *bytes = NULL;
    }
    return st;
}

cw_status cwi_picture_read(cwi_mesh_input *in, const char *name, cw_texture *picture,
                           cw_error *err)
{
    const cw_texture *known = cwi_picture_find(&in->pictures, name);
    cw_error why = {0};
    uint64_t size = 0;
    uint8_t *bytes = NULL;
    int fd = -1;
    if (known) {
        *picture = *known;
        return CW_OK;
    }
    cw_status st = cwi_input_open_side(&in->file, name, &fd, &size, &why);
    if (st == CW_OK && size > 0 && size <= MAX_BYTES)
        st = read_whole(fd, size, &bytes, &why);
    if (fd >= 0)
        close(fd);
    if (bytes)
        return cwi_picture_add(in, name, bytes, (size_t)size, picture, err);
    in->pictures.is_missing = true;
    return st == CW_ERR_NO_MEMORY ? cwi_fail_memory(err) : CW_OK;
}

bool cwi_textures_any(const cw_textures *set)
{
    return set->normal.bytes || set->color.bytes || set->metallic_roughness.bytes ||
           set->occlusion.bytes || set->emissive.bytes;
}

cw_status cwi_textures_add(cwi_mesh_input *in, const cw_textures *set, uint32_t *number,
                           cw_error *err)
{
    cwi_pictures *p = &in->pictures;
    *number = 0;
    if (!cwi_textures_any(set))
        return CW_OK;
    cw_status st =
        cwi_mesh_grow(in, &p->sets, &p->set_capacity, p->set_count + 1, sizeof *p->sets, err);
    if (st != CW_OK)
        return st;
    p->sets[p->set_count++] = *set;
    *number = (uint32_t)p->set_count;
    return CW_OK;
}

void cwi_pictures_free(cwi_pictures *p)
{
    for (size_t n = 0; n < p->count; n++) {
        cwi_free(p->items[n].name);
        cwi_free((void *)(uintptr_t)p->items[n].file.bytes);
    }
    cwi_free(p->items);
    cwi_free(p->sets);
    *p = (cwi_pictures){0};
}
