/* Surfaces that a team shares: threads stand for its processes, and together write the bytes that one
 * writes alone. */
#define _GNU_SOURCE /* mkdtemp, pthread_barrier_t */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/sandbox.h"

#include <cubewright/formats.h>

#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_RANKS = 9, MAX_BYTES = 4096 };

static char folder[] = "/tmp/cubewright-team-XXXXXX";

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static void name_path(const char *name, char path[256])
{
    snprintf(path, 256, "%s/%s", folder, name);
}

/* --- a team of threads ---------------------------------------------------------------------- */

/* Memory that the threads of a team share. */
typedef struct table {
    int size;
    pthread_barrier_t gate;
    unsigned char bytes[MAX_RANKS][MAX_BYTES];
} table;

typedef struct seat {
    table *table;
    int rank;
} seat;

static cw_status gather_bytes(void *user, const void *mine, size_t bytes, void *all,
                              cw_error *err)
{
    (void)err;
    const seat *s = user;
    if (bytes > MAX_BYTES)
        abort();
    memcpy(s->table->bytes[s->rank], mine, bytes);
    pthread_barrier_wait(&s->table->gate);
    for (int r = 0; r < s->table->size; r++)
        memcpy((char *)all + (size_t)r * bytes, s->table->bytes[r], bytes);
    pthread_barrier_wait(&s->table->gate);
    return CW_OK;
}

static cw_status broadcast_bytes(void *user, int from, void *bytes, size_t size, cw_error *err)
{
    (void)err;
    const seat *s = user;
    if (size > MAX_BYTES)
        abort();
    if (s->rank == from)
        memcpy(s->table->bytes[from], bytes, size);
    pthread_barrier_wait(&s->table->gate);
    memcpy(bytes, s->table->bytes[from], size);
    pthread_barrier_wait(&s->table->gate);
    return CW_OK;
}

/* The work of a rank, and what came of it. */
typedef struct member {
    seat seat;
    cw_team team;
    cw_status (*work)(struct member *, cw_error *);
    const void *job;
    cw_status status;
    cw_error err;
} member;

static void *run_member(void *p)
{
    member *m = p;
    m->status = m->work(m, &m->err);
    return NULL;
}

/* Runs a work on every rank. */
static void run_team(int size, cw_status (*work)(member *, cw_error *), const void *job,
                     member members[MAX_RANKS])
{
    table shared = {.size = size};
    pthread_t threads[MAX_RANKS];
    assert_int_equal(pthread_barrier_init(&shared.gate, NULL, (unsigned)size), 0);
    for (int r = 0; r < size; r++) {
        members[r] = (member){.seat = {&shared, r}, .work = work, .job = job};
        members[r].team = (cw_team){.rank = r,
                                    .size = size,
                                    .gather = gather_bytes,
                                    .broadcast = broadcast_bytes,
                                    .user = &members[r].seat};
    }
    for (int r = 0; r < size; r++)
        assert_int_equal(pthread_create(threads + r, NULL, run_member, members + r), 0);
    for (int r = 0; r < size; r++)
        pthread_join(threads[r], NULL);
    pthread_barrier_destroy(&shared.gate);
}

/* --- a job ---------------------------------------------------------------------------------- */

typedef struct job {
    const cw_volume *volume;
    cw_stream_desc desc;
    const char *path;
    cw_write_desc write;
    int stranger;    /* rank whose spool is in another folder; -1: none */
    long fail_after; /* allocations of rank 1; -1: none fails */
} job;

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    (void)err;
    const cw_volume *v = user;
    const size_t slice = v->dim[0] * v->dim[1] * sizeof(float);
    memcpy(to, (const char *)v->data + first * slice, count * slice);
    return CW_OK;
}

static cw_status write_together(member *m, cw_error *err)
{
    const job *j = m->job;
    cw_slice_source source = {.shape = *j->volume, .read = read_slices};
    cw_mesh_spool *spool = NULL;
    source.shape.data = NULL;
    source.user = (void *)j->volume;
    cw_status st =
        cw_mesh_spool_new(m->team.rank == j->stranger ? "/tmp/any" : j->path, &spool, err);
    if (st == CW_OK)
        st = cw_extract_stream_part(&source, &j->desc, (size_t)m->team.rank,
                                    (size_t)m->team.size, cw_mesh_spool_sink(spool), NULL, err);
    if (m->team.rank == 1)
        cwi_alloc_fail_after(j->fail_after);
    st = cw_team_agree(&m->team, st, err);
    if (st == CW_OK)
        st = cw_mesh_spool_share(spool, &m->team, err);
    if (st == CW_OK)
        st = cw_parts_write(j->path,
                            &(cw_part){.mesh = cw_mesh_spool_frame(spool), .spool = spool}, 1,
                            &j->write, err);
    if (m->team.rank == 1)
        cwi_alloc_fail_after(-1);
    cw_mesh_spool_free(spool);
    return st;
}

static size_t count_entries(const char *path)
{
    DIR *d = opendir(path);
    size_t count = 0;
    while (readdir(d))
        count++;
    closedir(d);
    return count - 2;
}

static void assert_written_alike(const job *j, const char *bytes, size_t size)
{
    static const int sizes[] = {1, 2, 3, 5, 9};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        member members[MAX_RANKS];
        size_t got_size;
        run_team(sizes[n], write_together, j, members);
        for (int r = 0; r < sizes[n]; r++)
            assert_ok(members[r].status, members[r].err);
        char *got = test_file_read(j->path, &got_size);
        assert_int_equal(got_size, size);
        assert_memory_equal(got, bytes, size);
        free(got);
        assert_int_equal(count_entries(folder), 1);
        unlink(j->path);
    }
}

/* Its writer is a forked process, in which the sanitizers' allocator can wait forever for a lock that
 * another thread held. */
static bool is_glb_written(void)
{
    return cwi_module_present("gltf") && !CWI_SANITIZED;
}

static void every_team_writes_the_bytes_of_one(void **state)
{
    (void)state;
    static const char *const names[] = {"a.ply", "a.stl", "a.glb", "a.vtp", "a.obj"};
    cw_volume v = test_sample(CW_FIELD_GYROID, 14, CW_F32);
    char path[256];
    for (int normals = 0; normals < 2; normals++) {
        cw_stream_desc desc = {.extract = {.no_normals = !normals, .threads = 1}};
        cw_mesh mesh = test_extract(&v, &desc.extract, NULL);
        for (size_t f = 0; f < sizeof names / sizeof *names; f++) {
            cw_error err = {0};
            size_t size;
            if (strcmp(names[f], "a.glb") == 0 && !is_glb_written())
                continue;
            job j = {.volume = &v, .desc = desc, .path = path, .stranger = -1};
            j.fail_after = -1;
            j.write.text = f == 0 && !normals;
            name_path(names[f], path);
            assert_ok(cw_mesh_write(path, &mesh, &j.write, &err), err);
            char *bytes = test_file_read(path, &size);
            unlink(path);
            assert_written_alike(&j, bytes, size);
            free(bytes);
        }
        cw_mesh_free(&mesh);
    }
    cw_volume_free(&v);
}

static void a_failure_of_one_is_that_of_all(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 12, CW_F32);
    member members[MAX_RANKS];
    char path[256];
    name_path("a.stl", path);
    job j = {.volume = &v, .path = path, .stranger = 2, .fail_after = -1};
    run_team(3, write_together, &j, members);
    for (int r = 0; r < 3; r++) {
        assert_int_equal(members[r].status, CW_ERR_IO);
        assert_non_null(strstr(members[r].err.message, "need the same folder"));
    }
    j.stranger = -1;
    fclose(fopen(path, "w"));
    j.write.no_clobber = true;
    run_team(3, write_together, &j, members);
    for (int r = 0; r < 3; r++) {
        assert_int_equal(members[r].status, CW_ERR_OUTPUT);
        assert_non_null(strstr(members[r].err.message, "it exists"));
    }
    unlink(path);
    assert_int_equal(count_entries(folder), 0);
    cw_volume_free(&v);
}

static void memory_that_runs_out_in_one_ends_all(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 8, CW_F32);
    cw_status st = CW_ERR_NO_MEMORY;
    char path[256];
    name_path("a.stl", path);
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        member members[MAX_RANKS];
        const job j = {.volume = &v, .path = path, .stranger = -1, .fail_after = n};
        run_team(3, write_together, &j, members);
        st = members[0].status;
        for (int r = 1; r < 3; r++)
            assert_int_equal(members[r].status, st);
        assert_true(st == CW_OK || st == CW_ERR_NO_MEMORY);
        assert_int_equal(count_entries(folder), st == CW_OK);
        assert_in_range(n, 0, 200);
    }
    unlink(path);
    cw_volume_free(&v);
}

static cw_status fail_by_rank(member *m, cw_error *err)
{
    cw_status st = m->team.rank == 1 ? CW_ERR_IO : m->team.rank == 2 ? CW_ERR_FORMAT : CW_OK;
    snprintf(err->message, sizeof err->message, "of %d", m->team.rank);
    st = cw_team_agree(&m->team, st, err);
    return cw_team_agree(&m->team, st, err); /* an agreed failure stays as it is */
}

static void the_lowest_rank_that_failed_is_told(void **state)
{
    (void)state;
    member members[MAX_RANKS];
    cw_error err = {0};
    run_team(4, fail_by_rank, NULL, members);
    for (int r = 0; r < 4; r++) {
        assert_int_equal(members[r].status, CW_ERR_IO);
        assert_string_equal(members[r].err.message, "rank 1: of 1");
    }
    assert_int_equal(cw_team_agree(&(cw_team){0}, CW_ERR_LIMIT, &err), CW_ERR_LIMIT);
    uint32_t mine = 7, all = 0;
    assert_ok(cw_team_gather(&(cw_team){0}, &mine, sizeof mine, &all, &err), err);
    assert_int_equal(all, 7);
}

static cw_status append_late(member *m, cw_error *err)
{
    cw_mesh_spool *spool;
    cw_status st = cw_mesh_spool_new(m->job, &spool, err);
    if (st == CW_OK)
        st = cw_mesh_spool_share(spool, &m->team, err);
    const cw_chunk_sink sink = cw_mesh_spool_sink(spool);
    if (st == CW_OK && sink.take(sink.user, &(cw_mesh_chunk){0}, err) != CW_ERR_ARGUMENT)
        st = CW_ERR_CHECK;
    if (st == CW_OK && cw_mesh_spool_share(spool, &m->team, err) != CW_ERR_ARGUMENT)
        st = CW_ERR_CHECK;
    cw_mesh_spool_free(spool);
    return st;
}

static void a_shared_spool_takes_no_more(void **state)
{
    (void)state;
    member members[MAX_RANKS];
    char path[256];
    name_path("a.ply", path);
    run_team(2, append_late, path, members);
    for (int r = 0; r < 2; r++)
        assert_ok(members[r].status, members[r].err);
    assert_int_equal(count_entries(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_team_writes_the_bytes_of_one),
        cmocka_unit_test(a_failure_of_one_is_that_of_all),
        cmocka_unit_test(memory_that_runs_out_in_one_ends_all),
        cmocka_unit_test(the_lowest_rank_that_failed_is_told),
        cmocka_unit_test(a_shared_spool_takes_no_more),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
