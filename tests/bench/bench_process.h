/* Runs steps of a bench in processes of their own, and passes meshes between them. */
#ifndef BENCH_BENCH_PROCESS_H
#define BENCH_BENCH_PROCESS_H

#include <cubewright/mesh.h>

/* Returns memory that a child's answers can be read from. Ends the program without memory. */
void *bench_shared_new(size_t bytes);

/* Runs work in a child. Returns true if it came to its end, and said so. */
bool bench_in_child(bool (*work)(void *task), void *task);

/* Writes a mesh without attributes into a file without a name. */
bool bench_put_mesh(int file, const cw_mesh *mesh);

/* A mesh that stands in such a file. */
typedef struct bench_seen_mesh {
    cw_mesh mesh;
    void *map; /* NULL: not mapped */
    size_t bytes;
} bench_seen_mesh;

bench_seen_mesh bench_see_mesh(int file);
void bench_unsee_mesh(bench_seen_mesh *m);

#endif
