/* Runs steps of a bench in processes of their own, and passes meshes between them by files without
 * names. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "bench_process.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

void *bench_shared_new(size_t bytes)
{
    void *p = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) {
        perror("bench");
        exit(1);
    }
    return p;
}

bool bench_in_child(bool (*work)(void *task), void *task)
{
    int status = 1;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const bool done = work(task);
        fflush(NULL);
        _exit(done ? 0 : 1);
    }
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

/* Begins a file with a mesh; positions and triangles follow. */
typedef struct mesh_head {
    double origin[3];
    uint64_t vertices, triangles;
} mesh_head;

static bool put(int file, const void *data, size_t bytes)
{
    for (const char *p = data; bytes > 0;) {
        const ssize_t n = write(file, p, bytes);
        if (n <= 0)
            return false;
        p += n;
        bytes -= (size_t)n;
    }
    return true;
}

bool bench_put_mesh(int file, const cw_mesh *mesh)
{
    mesh_head head = {.vertices = mesh->vertex_count, .triangles = mesh->triangle_count};
    memcpy(head.origin, mesh->origin, sizeof head.origin);
    return put(file, &head, sizeof head) &&
           put(file, mesh->positions, 12 * mesh->vertex_count) &&
           put(file, mesh->triangles, 12 * mesh->triangle_count);
}

bench_seen_mesh bench_see_mesh(int file)
{
    struct stat st;
    bench_seen_mesh m = {0};
    if (fstat(file, &st) != 0 || (size_t)st.st_size < sizeof(mesh_head))
        return m;
    m.bytes = (size_t)st.st_size;
    m.map = mmap(NULL, m.bytes, PROT_READ, MAP_SHARED, file, 0);
    if (m.map == MAP_FAILED)
        return (bench_seen_mesh){0};
    const mesh_head *head = m.map;
    memcpy(m.mesh.origin, head->origin, sizeof head->origin);
    m.mesh.vertex_count = head->vertices;
    m.mesh.triangle_count = head->triangles;
    m.mesh.positions = (float *)(head + 1);
    m.mesh.triangles = (uint32_t *)(m.mesh.positions + 3 * head->vertices);
    return m;
}

void bench_unsee_mesh(bench_seen_mesh *m)
{
    if (m->map)
        munmap(m->map, m->bytes);
    *m = (bench_seen_mesh){0};
}
