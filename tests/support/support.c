/* Implements the asserts, files and small meshes that all tests share. */
#define _GNU_SOURCE /* mkdtemp, nftw */
#include "support/support.h"

#include "core/base/sandbox.h"

#include <dirent.h>
#include <ftw.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[64];

/* Keeps freed memory in the process: in virtual machines giving it back is slow, and tests that
 * read a thousand small files do so thousands of times. */
__attribute__((constructor)) static void keep_memory(void)
{
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
    mallopt(M_TOP_PAD, 1 << 20);
}

void test_assert_fails(cw_status got, cw_status expected, const char *words,
                       const cw_error *err, const char *call, const char *file, int line)
{
    if (got == expected && strstr(err->message, words))
        return;
    print_error("%s\n  gave %s: %s\n  not  %s: ...%s...\n", call, cw_status_name(got),
                got == CW_OK ? "" : err->message, cw_status_name(expected), words);
    _fail(file, line);
}

void test_assert_near(double value, double truth, double margin, const char *what,
                      const char *file, int line)
{
    if (fabs(value - truth) <= margin)
        return;
    print_error("%s is %.9g, not within %.3g of %.9g\n", what, value, margin, truth);
    _fail(file, line);
}

static int long_factor(void)
{
    const char *factor = getenv("CUBEWRIGHT_TEST_LONG");
    return factor ? atoi(factor) : 0;
}

bool test_is_short(void)
{
    return long_factor() < 1;
}

int test_some(int count)
{
    const int share = CWI_SANITIZED ? 32 : 8;
    return test_is_short() ? (count + share - 1) / share : count * long_factor();
}

unsigned test_limit_s(void)
{
    enum { LIMIT_S = 300 };
    const char *slow = getenv("CUBEWRIGHT_TEST_SLOW");
    const unsigned times = slow ? (unsigned)strtoul(slow, NULL, 10) : 1;
    return LIMIT_S * (times > 0 ? times : 1);
}

static unsigned added_seed(void)
{
    const char *added = getenv("CUBEWRIGHT_TEST_SEED");
    return added ? (unsigned)strtoul(added, NULL, 10) : 0;
}

unsigned test_seed(unsigned own)
{
    const unsigned seed = own + added_seed();
    print_message("random seed %u (CUBEWRIGHT_TEST_SEED=%u)\n", seed, added_seed());
    srand(seed);
    return seed;
}

bool test_seed_is_other(void)
{
    return added_seed() != 0;
}

int test_folder_make(void **state)
{
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/cubewright-test-XXXXXX", base ? base : "/tmp");
    assert_non_null(mkdtemp(folder));
    return 0;
}

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *ftw)
{
    (void)info, (void)kind, (void)ftw;
    return remove(path);
}

int test_folder_remove(void **state)
{
    (void)state;
    return nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

const char *test_path(const char *name)
{
    static char paths[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(paths[next], sizeof paths[next], "%s/%s", folder, name);
    return paths[next];
}

char *test_file_read(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = '\0';
    fclose(file);
    return bytes;
}

void test_file_write(const char *path, const void *bytes, size_t size)
{
    /* ext4 writes a file that is emptied and filled again to the disk, and waits. */
    remove(path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

size_t test_folder_entries(void)
{
    size_t count = 0;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (struct dirent *entry = readdir(dir); entry; entry = readdir(dir))
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(dir);
    return count;
}

/* Copies tables into a mesh of its own; normals point away from the centre. */
static void make_mesh(cw_mesh *mesh, const float (*points)[3], size_t vertices,
                      const uint32_t (*triangles)[3], size_t count, float centre)
{
    *mesh = (cw_mesh){.vertex_count = vertices, .triangle_count = count};
    mesh->positions = malloc(vertices * sizeof *points);
    mesh->normals = malloc(vertices * sizeof *points);
    mesh->triangles = malloc(count * sizeof *triangles);
    assert_true(mesh->positions && mesh->normals && mesh->triangles);
    memcpy(mesh->positions, points, vertices * sizeof *points);
    memcpy(mesh->triangles, triangles, count * sizeof *triangles);
    for (size_t v = 0; v < vertices; v++) {
        float d[3], length = 0;
        for (int a = 0; a < 3; a++) {
            d[a] = points[v][a] - centre;
            length += d[a] * d[a];
        }
        for (int a = 0; a < 3; a++)
            mesh->normals[3 * v + (size_t)a] = d[a] / sqrtf(length);
    }
}

void test_make_tetrahedron(cw_mesh *mesh)
{
    static const float points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    make_mesh(mesh, points, 4, triangles, 4, 0.25f);
}

void test_make_cube(cw_mesh *mesh)
{
    static const float points[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                       {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    static const uint32_t triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                              {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                              {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    make_mesh(mesh, points, 8, triangles, 12, 0.5f);
}

void test_make_far_sphere(cw_mesh *mesh)
{
    /* 64 cells span 80 mm: the field's radius of 30 mm is 24 voxels */
    const cw_field_desc desc = {.field = CW_FIELD_SPHERE, .dim = {65, 65, 65}, .type = CW_F32};
    const double spacing[3] = {0.1, 0.1, 5};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    for (int a = 0; a < 3; a++) {
        v.affine[a][a] = spacing[a];
        v.affine[a][3] = 1e6;
    }
    *mesh = (cw_mesh){0};
    assert_ok(cw_extract(&v, NULL, mesh, NULL, &err), err);
    cw_volume_free(&v);
}

bool test_stop_after(void *polls, const char *step, double done)
{
    (void)step, (void)done;
    return (*(int *)polls)-- > 0;
}
