/* Helpers that the tests of the mesh readers share. */
#ifndef TESTS_MESHES_H
#define TESTS_MESHES_H

#include "core/base/memory.h"
#include "support/support.h"

#include <stdlib.h>
#include <string.h>

/* Writes the bytes to a file of the test's folder and reads it as a mesh. */
static inline cw_status read_bytes(const char *name, const void *bytes, size_t size,
                                   cw_mesh *mesh, cw_mesh_file *file, cw_error *err)
{
    test_file_write(test_path(name), bytes, size);
    return cw_mesh_read(test_path(name), NULL, mesh, file, err);
}

static inline cw_status read_text(const char *name, const char *text, cw_mesh *mesh,
                                  cw_mesh_file *file, cw_error *err)
{
    return read_bytes(name, text, strlen(text), mesh, file, err);
}

/* A mesh that is read is one that the rest of the library may rely on. */
#define assert_usable(mesh)                                                                    \
    do {                                                                                       \
        cw_error usable = {0};                                                                 \
        assert_ok(cw_mesh_check((mesh), &usable), usable);                                     \
    } while (0)

static inline void check_triangles(const cw_mesh *mesh, size_t count, const uint32_t *expected)
{
    assert_int_equal(mesh->triangle_count, count);
    for (size_t i = 0; i < 3 * count; i++)
        if (mesh->triangles[i] != expected[i])
            fail_msg("corner %zu is vertex %u, not %u", i, mesh->triangles[i], expected[i]);
}

/* Positions to the bit. */
static inline void check_positions(const cw_mesh *mesh, size_t count, const float *expected)
{
    assert_int_equal(mesh->vertex_count, count);
    for (size_t i = 0; i < 3 * count; i++)
        if (mesh->positions[i] != expected[i])
            fail_msg("coordinate %zu is %.9g, not %.9g", i, (double)mesh->positions[i],
                     (double)expected[i]);
}

/* A row of a table of files that must be refused. */
typedef struct refused {
    const char *text, *words;
} refused;

static inline void check_refused(const char *name, const refused *rows, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        const cw_status st = read_text(name, rows[i].text, &mesh, NULL, &err);
        if (st != CW_ERR_FORMAT)
            fail_msg("row %zu gives status %d (%s); not: %s", i, (int)st, err.message,
                     rows[i].words);
        if (!strstr(err.message, rows[i].words))
            fail_msg("row %zu says: %s; not: %s", i, err.message, rows[i].words);
        assert_true(!mesh.positions && !mesh.triangles && !mesh.normals);
    }
}

/* Whatever allocation fails, the reader says so and leaves nothing behind. In this process: of
 * what fails in another one, nobody would be told here. */
static inline void check_starved_mesh_reads(const char *name)
{
    const cw_mesh_read_desc here = {.no_sandbox = true};
    for (long n = 0;; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_read(test_path(name), &here, &mesh, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_mesh_free(&mesh);
            assert_true(n > 0);
            return;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_null(mesh.positions);
    }
}

#endif
