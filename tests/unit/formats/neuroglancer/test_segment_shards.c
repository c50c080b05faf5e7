/* Tests mesh folders of many segments: each stands in the shard that the hash of its number names, as
 * it would in files of its own. */
#include "core/base/memory.h"
#include "core/base/module.h"
#include "formats/precomputed/shard_hash.h"
#include "support/files/mesh_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 10001, EDGE = 22, FEW = 5 };

/* Cubes on a lattice, whose labels have gaps, and go beyond 32 bits. */
typedef struct many_cubes {
    cw_mesh cube;
    cw_mesh meshes[COUNT];
    cw_label labels[COUNT];
    cw_part parts[COUNT];
} many_cubes;

static uint64_t id_of(size_t n)
{
    return n % 3 ? 1024 * n + 1 : ((uint64_t)1 << 40) + n;
}

static many_cubes *make_cubes(void)
{
    many_cubes *m = calloc(1, sizeof *m);
    assert_non_null(m);
    test_make_cube(&m->cube);
    for (size_t n = 0; n < COUNT; n++) {
        const uint64_t id = id_of(n);
        m->meshes[n] = m->cube; /* with its arrays */
        m->meshes[n].origin[0] = 5.0 * (double)(n % EDGE);
        m->meshes[n].origin[1] = 5.0 * (double)(n / EDGE % EDGE);
        m->meshes[n].origin[2] = 5.0 * (double)(n / EDGE / EDGE);
        m->labels[n] = (cw_label){.value = id > UINT32_MAX ? 0 : (uint32_t)id,
                                  .id = id > UINT32_MAX ? id : 0};
        m->parts[n] = (cw_part){.mesh = &m->meshes[n], .name = "cube", .label = &m->labels[n]};
    }
    return m;
}

static void free_cubes(many_cubes *m)
{
    cw_mesh_free(&m->cube);
    free(m);
}

static uint64_t get_word(const char *bytes)
{
    uint64_t word = 0;
    for (int n = 7; n >= 0; n--)
        word = word << 8 | (unsigned char)bytes[n];
    return word;
}

static unsigned find_bits(const char *info, const char *key)
{
    const char *at = strstr(info, key);
    assert_non_null(at);
    return (unsigned)atoi(at + strlen(key));
}

/* Finds the manifest of a segment in its shard, as the format's document says. */
static char *find_manifest(const char *folder, uint64_t id, size_t *offset, size_t *size)
{
    char path[256];
    size_t info_size, shard_size;
    snprintf(path, sizeof path, "%s/info", folder);
    char *info = test_file_read(test_path(path), &info_size);
    assert_non_null(strstr(info, "\"hash\": \"murmurhash3_x86_128\""));
    const unsigned minishard_bits = find_bits(info, "\"minishard_bits\":");
    const unsigned shard_bits = find_bits(info, "\"shard_bits\":");
    const uint64_t hash = cwi_murmur_hash(id);
    const uint64_t minishard = hash % (1U << minishard_bits);
    const uint64_t shard = (hash >> minishard_bits) % (1U << shard_bits);
    assert_true(shard_bits >= 1 && shard_bits <= 4); /* one digit */
    snprintf(path, sizeof path, "%s/%llx.shard", folder, (unsigned long long)shard);
    char *bytes = test_file_read(test_path(path), &shard_size);
    const size_t base = (size_t)16 << minishard_bits;
    const size_t first = base + get_word(bytes + 16 * minishard);
    const size_t end = base + get_word(bytes + 16 * minishard + 8);
    assert_true(end <= shard_size && first < end && (end - first) % 24 == 0);
    const size_t count = (end - first) / 24;
    uint64_t number = 0, at = base;
    for (size_t n = 0; n < count; n++) {
        const uint64_t bytes_there = get_word(bytes + first + 8 * (2 * count + n));
        number += get_word(bytes + first + 8 * n);
        at += get_word(bytes + first + 8 * (count + n));
        if (number == id) {
            *offset = at;
            *size = bytes_there;
            assert_true(at + bytes_there <= shard_size);
            free(info);
            return bytes;
        }
        at += bytes_there;
    }
    fail_msg("segment %llu is not in its shard", (unsigned long long)id);
    return NULL;
}

/* Compares a segment in shards with the files that a folder of few segments has of it: the fragments
 * stand in front of the manifest. */
static void compare_segment(uint64_t id)
{
    char path[256];
    size_t offset = 0, size = 0, manifest_size, fragment_size;
    char *shard = find_manifest("many", id, &offset, &size);
    snprintf(path, sizeof path, "few/%llu.index", (unsigned long long)id);
    char *manifest = test_file_read(test_path(path), &manifest_size);
    snprintf(path, sizeof path, "few/%llu", (unsigned long long)id);
    char *fragments = test_file_read(test_path(path), &fragment_size);
    assert_int_equal(size, manifest_size);
    assert_memory_equal(shard + offset, manifest, size);
    assert_true(fragment_size > 0 && fragment_size <= offset);
    assert_memory_equal(shard + offset - fragment_size, fragments, fragment_size);
    free(shard);
    free(manifest);
    free(fragments);
}

static void many_segments_stand_in_shards(void **state)
{
    (void)state;
    static const size_t chosen[FEW] = {0, 1, COUNT / 2, EDGE * EDGE - 1, COUNT - 1};
    const cw_write_desc desc = {.format = "neuroglancer"};
    cw_part few[FEW];
    cw_error err = {0};
    if (!cwi_module_present("draco"))
        skip();
    many_cubes *m = make_cubes();
    assert_ok(cw_parts_write(test_path("many"), m->parts, COUNT, &desc, &err), err);
    for (size_t n = 0; n < FEW; n++) /* the first and last ones span the same box */
        few[n] = m->parts[chosen[n]];
    assert_ok(cw_parts_write(test_path("few"), few, FEW, &desc, &err), err);
    for (size_t n = 0; n < FEW; n++)
        compare_segment(id_of(chosen[n]));
    for (size_t n = 0; n < COUNT; n += 500) {
        size_t offset, size;
        free(find_manifest("many", id_of(n), &offset, &size));
    }
    /* a folder of shards may be replaced by one of files */
    assert_ok(cw_parts_write(test_path("many"), few, FEW, &desc, &err), err);
    size_t size;
    free(test_file_read(test_path("many/1025"), &size));
    char *info = test_file_read(test_path("many/info"), &size);
    assert_null(strstr(info, "sharding"));
    free(info);
    free_cubes(m);
}

static void a_starved_write_leaves_nothing(void **state)
{
    (void)state;
    const cw_write_desc desc = {.format = "neuroglancer"};
    bool failed = true;
    if (!cwi_module_present("draco"))
        skip();
    many_cubes *m = make_cubes();
    for (long n = 1; failed; n = 3 * n + 1) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_parts_write(test_path("many"), m->parts, COUNT, &desc, &err);
        failed = cwi_alloc_fail_after(-1);
        if (st != (failed ? CW_ERR_NO_MEMORY : CW_OK))
            fail_msg("allocation %ld: %s", n, err.message);
        FILE *info = fopen(test_path("many/info"), "rb");
        assert_int_equal(info == NULL, failed);
        if (info)
            fclose(info);
    }
    free_cubes(m);
}

int main(void)
{
#define FRESH(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        FRESH(many_segments_stand_in_shards),
        FRESH(a_starved_write_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
