/* Helpers that the fuzz targets of the mesh readers share. */
#ifndef TESTS_FUZZ_MESH_H
#define TESTS_FUZZ_MESH_H

#include <cubewright/formats.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Adds up what a reader made of the bytes, so that every array is looked at from end to end. */
static inline double touch_mesh(const cw_mesh *m)
{
    cw_error err;
    double sum = 0;
    if (cw_mesh_check(m, &err) != CW_OK)
        __builtin_trap(); /* what was read must be usable */
    for (size_t i = 0; i < 3 * m->vertex_count; i++) {
        if (m->normals && !(m->normals[i] - m->normals[i] == 0))
            __builtin_trap(); /* normals are finite, if there are any */
        sum += m->normals ? (double)m->normals[i] : 0;
    }
    for (size_t v = 0; v < m->vertex_count; v++) {
        sum += m->scalars ? (double)m->scalars[v] : 0;
        sum += m->labels ? (double)m->labels[v] : 0;
        sum += m->colors ? (double)m->colors[4 * v + 3] : 0;
    }
    return sum;
}

/* Takes the file apart, too; what its parts have is part of the whole. */
static inline void fuzz_parts(const cw_mesh_read_desc *desc, const cw_mesh *all)
{
    cw_part *parts;
    size_t count, triangles = 0;
    cw_error err;
    if (cw_parts_read(NULL, desc, &parts, &count, NULL, &err) != CW_OK)
        return; /* over the limit of memory */
    for (size_t i = 0; i < count; i++) {
        volatile double sum = touch_mesh(parts[i].mesh);
        (void)sum;
        triangles += parts[i].mesh->triangle_count;
    }
    if (triangles != all->triangle_count)
        __builtin_trap();
    cw_parts_free(parts, count);
}

/* Reads the bytes as a file in memory, by a reader that is named. */
static inline int fuzz_mesh(const char *reader, const uint8_t *bytes, size_t size)
{
    cw_stored_file *stored;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err;
    cw_mesh_read_desc desc = {
        .reader = reader, .max_bytes = (uint64_t)64 << 20, .no_sandbox = true};
    const cw_byte_source source = {.bytes = bytes, .size = size};
    if (cw_stored_file_open(&source, &stored, &err) != CW_OK)
        return 0;
    desc.stored = stored;
    if (cw_mesh_read(NULL, &desc, &mesh, &file, &err) == CW_OK) {
        volatile double sum = touch_mesh(&mesh);
        (void)sum;
        fuzz_parts(&desc, &mesh);
        cw_mesh_free(&mesh);
    }
    cw_stored_file_close(stored);
    return 0;
}

#endif
