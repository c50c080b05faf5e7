/* Reads and writes files in memory, by the readers and writers of files. */
#include <cubewright/formats.h>

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

cw_status cw_volume_read_memory(const cw_byte_source *source, const cw_read_desc *desc,
                                cw_volume *volume, const char **format, cw_error *err)
{
    CWI_REQUIRE(err, source, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    cw_stored_file *file;
    memset(volume, 0, sizeof *volume);
    cw_status st = cw_stored_file_open(source, &file, err);
    d.stored = file;
    if (st == CW_OK)
        st = cw_volume_read(NULL, &d, volume, format, err);
    cw_stored_file_close(file);
    return st;
}

cw_status cw_mesh_read_memory(const cw_byte_source *source, const cw_mesh_read_desc *desc,
                              cw_mesh *mesh, cw_mesh_file *file, cw_error *err)
{
    CWI_REQUIRE(err, source, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_mesh_read_desc d = desc ? *desc : (cw_mesh_read_desc){0};
    cw_stored_file *stored;
    memset(mesh, 0, sizeof *mesh);
    cw_status st = cw_stored_file_open(source, &stored, err);
    d.stored = stored;
    if (st == CW_OK)
        st = cw_mesh_read(NULL, &d, mesh, file, err);
    cw_stored_file_close(stored);
    return st;
}

/* The bytes of a file as they come. */
typedef struct buffer {
    uint8_t *bytes;
    size_t size, used;
} buffer;

static cw_status reserve_bytes(void *user, uint64_t size, cw_error *err)
{
    buffer *b = user;
    b->bytes = size <= SIZE_MAX ? cwi_alloc_large((size_t)size, 1) : NULL;
    b->size = (size_t)size;
    return b->bytes ? CW_OK : cwi_fail_memory(err);
}

static cw_status append_bytes(void *user, const void *bytes, size_t size, cw_error *err)
{
    buffer *b = user;
    (void)err;
    memcpy(b->bytes + b->used, bytes, size);
    b->used += size;
    return CW_OK;
}

/* Gives the bytes to the caller, or frees them after a failure. */
static cw_status hand_over(cw_status st, buffer *b, uint8_t **bytes, size_t *size)
{
    if (st != CW_OK) {
        cwi_free(b->bytes);
        *b = (buffer){0};
    }
    *bytes = b->bytes;
    *size = b->size;
    return st;
}

cw_status cw_mesh_write_memory(const char *name, const cw_mesh *mesh, const cw_write_desc *desc,
                               uint8_t **bytes, size_t *size, cw_error *err)
{
    CWI_REQUIRE(err, mesh, bytes, size);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    buffer b = {0};
    d.sink = &(cw_byte_sink){.begin = reserve_bytes, .write = append_bytes, .user = &b};
    return hand_over(cw_mesh_write(name, mesh, &d, err), &b, bytes, size);
}

cw_status cw_volume_write_memory(const char *name, const cw_volume *volume,
                                 const cw_write_desc *desc, uint8_t **bytes, size_t *size,
                                 cw_error *err)
{
    CWI_REQUIRE(err, volume, bytes, size);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    buffer b = {0};
    d.sink = &(cw_byte_sink){.begin = reserve_bytes, .write = append_bytes, .user = &b};
    return hand_over(cw_volume_write(name, volume, &d, err), &b, bytes, size);
}
